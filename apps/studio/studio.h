// The program: a document, a view of it, panels and tools around it. Every change goes through Editor::run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "document.h"
#include "picture_worker.h"
#include "settings.h"
#include "tools.h"
#include "trace.h"
#include "viewport.h"
#include "window.h"

namespace coif::studio {

struct StudioOptions {
  std::filesystem::path open;       ///< a .coif document or a head; empty: the example
  std::string style = "bob";        ///< modelled on a head that is opened
  std::filesystem::path trace;      ///< Chrome trace, written at the end
  std::filesystem::path pythonLog;  ///< each command that is done, as a line of Python
};

class Studio {
 public:
  Studio(Window& window, StudioOptions options);
  ~Studio();

  /// One frame; false: quit.
  bool frame();
  /// Asks to save first where something changed; true when the window may close now.
  bool mayClose();
  Status finish() const { return trace_.write(); }

 private:
  // Commands and files.
  void run(const std::string& command, const CommandArguments& arguments = {});
  void openPath(const std::filesystem::path& path, const std::string& style);
  void adopt(std::unique_ptr<Document> document);
  void saveTo(const std::filesystem::path& path);
  void exportTo(const std::filesystem::path& path);
  void say(std::string message, bool problem = false);

  // A frame's parts.
  void takeKeys();
  void takeTools();
  void takePictures();
  void askForPicture(bool moving);
  void autosave();

  // What is drawn (menus.cpp, panels.cpp, dialogs.cpp).
  void drawMenus();
  void drawFileMenu();
  void drawViewMenu();
  void drawPanels();
  void drawToolPanel();
  void drawStrandPanel();
  void drawLookPanel();
  void drawAdjustPanel();
  void drawHistoryPanel();
  void drawStagePanel();
  void drawPythonPanel();
  void drawStatusLine();
  void drawPalette();
  void drawPathDialog();
  void drawRecoveryDialog();
  void drawCloseDialog();
  void drawTour();
  bool drawArgument(const CommandArgument& argument, CommandArguments& values) const;

  enum class PathUse { None, Open, SaveAs, Export, Screenshot };
  void askPath(PathUse use);
  void usePath(const std::filesystem::path& path);

  Window& window_;
  StudioOptions options_;
  Settings settings_;
  Trace trace_;
  std::unique_ptr<Document> document_;
  std::future<Result<std::unique_ptr<Document>>> opening_;
  std::string openingName_;
  std::unique_ptr<PictureWorker> pictures_;
  Viewport view_;
  SelectTool select_;
  std::optional<ModalTool> tool_;
  std::optional<HairMesh> attempt_;  // what the tool would leave
  double softRadius_ = 0;

  std::string message_;
  bool messageIsProblem_ = false;
  std::string lastCommand_;
  CommandArguments lastArguments_;
  std::vector<StageReport> stages_;
  double pictureSeconds_ = 0;
  std::size_t strandsDrawn_ = 0;
  std::uint64_t askedKey_ = 0, loggedSteps_ = 0;
  bool fine_ = false;  // the shown picture is the fine one
  double lastChange_ = 0, lastAutosave_ = 0;
  int leftPanelPx_ = 190, rightPanelPx_ = 300;

  PathUse pathUse_ = PathUse::None;
  std::string pathText_;
  bool paletteOpen_ = false, closeAsked_ = false, quit_ = false, tourOpen_ = false;
  std::string paletteText_;
  std::vector<std::filesystem::path> leftBehind_;
};

}  // namespace coif::studio
