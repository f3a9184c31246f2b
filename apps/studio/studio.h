// The program: a document, a view of it, panels and tools around it. Every change goes through Editor::run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actions.h"
#include "brush_tool.h"
#include "console.h"
#include "document.h"
#include "gizmo.h"
#include "job.h"
#include "modal_tool.h"
#include "motion_player.h"
#include "picture_worker.h"
#include "select_tool.h"
#include "settings.h"
#include "trace.h"
#include "viewport.h"
#include "window.h"

namespace coif::studio {

struct StudioOptions {
  std::filesystem::path open;    ///< a .coif document or a head; empty: the example
  std::string style = "bob";     ///< modelled on a head that is opened
  std::filesystem::path trace;   ///< Chrome trace, written at the end
  int channel = -1;              ///< a socket to the Python process that opened the studio; -1: none
  std::filesystem::path script;  ///< of Python, run once the document is open
  Trace::Time began = std::chrono::steady_clock::now();  ///< of the program, for the trace
  std::filesystem::path pythonLog;                       ///< each command that is done, as a line of Python
};

/// Seconds of a clock that only goes forward.
double secondsNow();

class Studio {
 public:
  Studio(Window& window, StudioOptions options);
  ~Studio();

  /// One frame; false: quit.
  bool frame();
  /// Asks to save first where something changed; true when the window may close now.
  bool mayClose();
  /// All that was on the GPU is gone, or will be: keeps the document, and asks for its picture anew.
  void contextLost();
  /// Writes what is to be kept. Call once, at the end.
  Status finish();
  /// Every command and action with menu and key, as JSON.
  std::string commandList() const;

 private:
  // Commands and files.
  /// `done` is told what is wrong, or nothing, when the command is done: at once or after a while.
  using Done = std::function<void(const std::string& problem)>;
  void run(const std::string& command, const CommandArguments& arguments = {}, const Done& done = {});
  void ran(const std::string& command, const CommandArguments& arguments, std::size_t stepsBefore);
  bool waitsForJob();
  void openExample();
  void recover(const std::filesystem::path& autosave);
  void openPath(const std::filesystem::path& path, const std::string& style);
  /// Does it now, or once the artist has said what becomes of changes that are not saved.
  void leaveDocument(std::function<void()> then);
  void adopt(std::unique_ptr<Document> document);
  void saveTo(const std::filesystem::path& path);
  void exportTo(const std::filesystem::path& path);
  void say(std::string message, bool problem = false);

  // Tools (interaction.cpp).
  /// Starts a command as a key or menu does: with its tool where it has one, else at once.
  void begin(const std::string& command);
  CommandArguments argumentsFor(const CommandInfo& info) const;
  /// What the command would do becomes the mesh that is shown.
  void show(const std::string& command, const CommandArguments& arguments);
  void forgetAttempt();
  const HairMesh& shownMesh() const;  ///< the tool's, the player's, else the document's
  void followTool();
  void followBrush();
  bool takeTools();  ///< true: this frame's keys were the tool's
  std::optional<Vec3> selectionMiddle() const;
  Gizmo gizmoAt(const Vec3& middle) const;
  void drawUnderView();
  void drawOverView();
  bool turnTable();  ///< true while the model turns by itself
  void drawNote();
  bool strandsInPicture() const;
  bool headInPicture() const;  ///< else the studio draws it itself, as lines or glass

  // Menus, palette and keys (actions.cpp, view_actions.cpp, menus.cpp).
  std::vector<Action> makeActions();
  std::vector<Action> fileActions();
  std::vector<Action> selectActions();
  std::vector<Action> toolActions();
  std::vector<Action> viewActions();
  std::vector<Action> motionActions();  // motion_panel.cpp
  std::vector<Action> pythonActions();  // scripting.cpp
  std::vector<Action> helpActions();
  std::vector<MenuEntry> entries() const;
  std::string keyOf(const std::string& name) const;
  std::string refusalOf(const MenuEntry& entry) const;
  void carryOut(const MenuEntry& entry);
  void drawEntry(const MenuEntry& entry);

  // A frame's parts.
  void takeKeys();
  void takePictures();
  void takeMotion();
  void askForPicture(bool moving);
  void autosave();
  std::uint64_t shownRevision() const;  ///< names the mesh that is shown: another number, another mesh
  PictureRequest pictureRequest(bool fine) const;

  // A turntable as pictures (turntable.cpp).
  struct TurntableRecord {
    std::filesystem::path path;
    int frame = 0;  // the next one
    Camera start;
  };
  void beginTurntable(const std::filesystem::path& path);
  void askTurntableFrame();
  void takeTurntableFrame(const PictureAnswer& answer);

  // What is drawn (menus.cpp, panels.cpp, dialogs.cpp).
  void drawMenus();
  void drawRecentMenu();
  void drawPanels();
  void drawToolPanel();  // tool_panel.cpp, with the next four
  void takeUp(HandTool hand, const std::string& brush);
  void drawHandTools();
  void drawHandSettings();
  void drawSelectionPanel();
  void drawStrandPanel();
  void drawStylePanel();  // style_panel.cpp, with the next ten
  struct StyleEdit;
  std::optional<StyleEdit> drawOperator(StyleOperator& op);
  void drawOperatorList();
  void drawMaskButtons(const StyleOperator& op);
  void addOperator(const std::string& kind);
  void chooseOperator(int by);
  void moveOperator(int by);
  std::string chosenOperator() const;  ///< its name; empty: the stack is
  const StyleStack& shownStyles() const;
  void followMask();
  CommandArguments maskArguments(const BrushWork& work) const;
  std::vector<double> shownMask() const;  ///< of the chosen operator, by vertex
  std::vector<Action> styleActions();
  void drawLookPanel();  // look_panel.cpp, with the next two
  /// Runs a panel's command once its widgets are let go; until then only the picture shows it.
  void settle(const std::string& command, const CommandArguments& arguments, bool changed);
  LookSettings shownLook() const;
  void drawAdjustPanel();
  void drawHistoryPanel();
  void drawStagePanel();
  void drawPythonPanel();
  void drawStatusLine();
  void dragEdge(const char* name, const ImVec2& at, float height, float& width, float sign, float room);
  /// Of a panel; open or not as in the last run, or from now on.
  bool header(const char* label, bool opens = false);
  void drawProgress();
  std::string title() const;

  // Python (scripting.cpp, console_panel.cpp).
  struct Request {
    nlohmann::json message;
    std::function<void(const nlohmann::json&)> answer;
  };
  void takeScripts();
  void answer(const Request& request);
  nlohmann::json stateFor(const std::string& what) const;
  void runScript(const std::filesystem::path& path);
  float drawConsole(const ImVec2& at, const ImVec2& size);  ///< at the bottom of this box; its height

  // Hair in motion (motion_panel.cpp).
  void drawMotionPanel();
  MotionInput motionInput() const;
  void playMotion();
  void keepMotion();
  void bakeMotion(const std::filesystem::path& path);
  void drawPalette();
  void drawSelectDialog();  // select_dialog.cpp
  /// False, and says why, for what is no list of ids.
  bool selectById(const std::string& text);
  void drawPathDialog();
  void drawRecoveryDialog();
  void drawCloseDialog();
  void drawTour();  // tour.cpp
  void followTour(const std::string& command);
  void drawKeyMap();  // key_map.cpp
  void takeNewKey();
  void drawExportDialog();  // export_dialog.cpp
  void drawGroupPanel();    // group_panel.cpp
  bool drawArgument(const CommandArgument& argument, CommandArguments& values) const;

  enum class PathUse { None, Open, SaveAs, Export, Screenshot, Turntable, BakeMotion, RunScript, TakeMesh };
  void askPath(PathUse use);
  void usePath(const std::filesystem::path& path);

  Window& window_;
  StudioOptions options_;
  Settings settings_;
  std::vector<Action> actions_;
  Trace trace_;
  std::unique_ptr<Document> document_;
  Job job_{&Window::wake};
  MotionPlayer player_{&Window::wake};
  HeadMoveSettings headMove_;
  double bakeSeconds_ = 4;
  std::optional<MotionFrame> played_;  // what the player shows
  std::optional<HairMesh> playedMesh_;
  std::unique_ptr<PictureWorker> pictures_;
  Viewport view_;
  Console console_{&Window::wake};
  std::string typed_;
  std::vector<std::string> typedBefore_;
  static constexpr int kTyping = -1, kNextLine = -2;  // no line of before; the next one takes the keyboard
  int typedAt_ = kTyping;
  std::unique_ptr<Channel> channel_;  // to the process that opened the studio
  std::vector<Request> requests_;
  int restedFrames_ = 0;
  SelectTool select_;
  BrushTool brush_;
  ToolSettings tools_;
  std::unique_ptr<ModalTool> tool_;
  std::optional<HairMesh> attempt_;  // what the tool would leave
  std::uint64_t attemptNumber_ = 0;
  std::uint64_t documentNumber_ = 0;  // how many were opened: each counts its revisions from 0
  std::string attemptLine_, refusal_;  // of the tool that runs
  std::string note_;                   // why something was refused, beside the mouse
  double noteUntil_ = 0;
  double turnedAt_ = 0;
  std::optional<TurntableRecord> turntable_;

  std::string pendingCommand_;  // what a panel's widget that is being dragged will ask for
  CommandArguments pendingArguments_;
  std::optional<LookSettings> pendingLook_;
  std::optional<StyleStack> pendingStyles_;
  std::uint64_t pendingStylesNumber_ = 0;
  std::string chosenOperator_;
  bool nameAsked_ = false;
  std::optional<StyleMask> paintedMask_;  // of the stroke that goes on

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

  PathUse pathUse_ = PathUse::None;
  std::string pathText_;
  int pathsAsked_ = 0;
  bool paletteOpen_ = false, quit_ = false, tourOpen_ = false;
  std::function<void()> leaving_;  // what waits for an answer; none: nothing
  std::string paletteText_, keyMapText_, keyAskedFor_, groupText_;
  bool keyMapOpen_ = false, exportOpen_ = false;
  int exportFormat_ = 0, tourStep_ = 0;
  StrandMesh exportMesh_ = StrandMesh::Cards;
  Vec3 tourEye_ = Vec3::Zero();
  bool idsAsked_ = false;
  std::string idsText_;
  std::vector<std::filesystem::path> leftBehind_;
};

}  // namespace coif::studio
