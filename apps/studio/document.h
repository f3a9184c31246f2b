// The open document: its editor, its head, and what protects it from a crash.
#pragma once

#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "coif/scene/editor.h"
#include "coif/scene/evaluate.h"

namespace coif::studio {

/// Where settings, recent files and autosaves live: $XDG_STATE_HOME/coif, else ~/.local/state/coif.
std::filesystem::path stateFolder();

class Document {
 public:
  /// A .coif document, or a head: then its scalp is found, a cage laid, and `style` modelled on it ("" for
  /// bare roots). Errors: those of loading and modelling.
  static Result<std::unique_ptr<Document>> open(const std::filesystem::path& path, const std::string& style,
                                                const Context& context);

  /// The bob on the example head that came with the program, not saved yet; made anew where it did not.
  static Result<std::unique_ptr<Document>> openExample(const Context& context);

  Editor editor;
  std::shared_ptr<const Surface> head() const { return head_.surface; }  ///< null when it could not be read
  const LoadedHead& loadedHead() const { return head_; }
  const Box& headBox() const { return headBox_; }  ///< where there is a head
  std::string headProblem;                         ///< why there is none
  std::filesystem::path path;                      ///< of the .coif file; empty until saved

  std::string title() const;
  Status save(const std::filesystem::path& to);
  /// Writes a copy beside the settings when something changed since the last one.
  Status autosave();
  bool needsAutosave() const { return editor.modified() && editor.revision() != autosavedRevision_; }
  void forgetAutosave();

  /// Autosaves that a crash left behind, newest first.
  static std::vector<std::filesystem::path> leftBehind();
  /// Opens an autosave as what it was a copy of; it stays modified until saved.
  static Result<std::unique_ptr<Document>> recover(const std::filesystem::path& autosave,
                                                   const Context& context);

 private:
  explicit Document(Scene scene);
  /// `read`: the head, where it was read already. Errors: Cancelled.
  Status takeHead(LoadedHead read, const Context& context);
  std::filesystem::path autosavePath() const;

  LoadedHead head_;
  Box headBox_;
  std::string key_;  // names this document's autosave
  std::uint64_t autosavedRevision_ = 0;
};

}  // namespace coif::studio
