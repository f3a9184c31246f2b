// An open document: the scene, what is selected, unlimited undo, and commands by name.
//
// One command is one undo step: the operation itself, the placement of internal vertices after it and the
// selection it leaves. A refused command changes nothing.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/hairmesh/edit.h"
#include "coif/hairmesh/history.h"
#include "coif/scalp/surface.h"
#include "coif/scene/command.h"
#include "coif/scene/scene.h"
#include "coif/scene/selection.h"

namespace coif {
namespace editor {
class AttemptCache;
}

/// What a command would leave: made by prepare(), taken over by commit().
struct PreparedCommand;

/// What undo restores besides the mesh.
struct EditState {
  Selection selection;
  std::vector<BundleId> hidden;  ///< ascending
  std::vector<VertexId> frozen;  ///< ascending; moves and smoothing leave them
  bool symmetric = false;        ///< operations and moves happen on both sides of the mirror plane
  Vec3 mirrorPoint = Vec3::Zero(), mirrorNormal = Vec3::UnitX();
  StrandSettings strands;
  StyleStack styles;
  LookSettings look;
  DynamicsSettings dynamics;
  bool operator==(const EditState&) const;
};

class Editor {
 public:
  explicit Editor(Scene scene);
  ~Editor();
  Editor(Editor&&) noexcept;
  Editor& operator=(Editor&&) noexcept;

  /// The document as it stands. scene().strands, .styles, .look and .dynamics are those of state().
  const Scene& scene() const { return scene_; }
  const HairMesh& mesh() const { return scene_.hairMesh; }
  const EditState& state() const { return state_; }

  /// The head for commands that look at it (push_out); may be null, must outlive the editor.
  void setHead(const Surface* head);

  /// Runs a command. Errors: NotFound (no such command), InvalidArgument (an argument that is unknown, of
  /// the wrong kind or out of range; nothing suitable selected), and those of the operation. On an error
  /// nothing has changed. Cost: the operation's, and one placement when the mesh changed.
  Status run(std::string_view command, const CommandArguments& arguments = {}, const Context& context = {});
  /// run() in two halves, for a command that takes its time: the first may run on a thread of its own while
  /// nothing else changes the editor; the second is quick. Not for undo and redo. Errors: as run(); commit
  /// refuses what was prepared for another revision.
  Result<PreparedCommand> prepare(std::string_view command, const CommandArguments& arguments = {},
                                  const Context& context = {}) const;
  Status commit(PreparedCommand prepared);
  /// The mesh as the command would leave it, and nothing done: what a tool shows before it is confirmed.
  /// Errors and cost as run(); NotFound for undo and redo.
  Result<HairMesh> attempt(std::string_view command, const CommandArguments& arguments = {},
                           const Context& context = {}) const;
  /// Why the command cannot run now, in one sentence; empty when it can be tried.
  std::string refusal(std::string_view command) const;

  std::size_t undoCount() const { return done_; }
  std::size_t redoCount() const { return steps_.size() - done_; }
  /// Labels of all steps, oldest first; undoCount() of them are done.
  std::vector<std::string> stepLabels() const;
  /// The Python lines of the steps that are done.
  std::string pythonLog() const;
  std::size_t historyBytes() const;

  /// True from the first step after construction or save() on.
  bool modified() const { return done_ != savedAt_; }
  void markModified() { savedAt_ = std::size_t(-1); }  ///< as after a crash: what is on disk is older
  Status save(const std::filesystem::path& path);
  /// Counts undo, redo and steps: what a view compares to know that it is out of date.
  std::uint64_t revision() const { return revision_; }

  /// Bytes of everything that undo restores, in a fixed order.
  std::vector<std::byte> canonicalState() const;

 private:
  struct Step {
    std::string label, python;
    bool meshChanged = false;
    std::shared_ptr<const EditState> before, after;  // shared between neighbouring steps where equal
  };
  /// prepare() without the line of Python, which attempts do not need.
  Result<PreparedCommand> outcomeOf(std::string_view command, const CommandArguments& arguments,
                                    const Context& context) const;
  void record(const PreparedCommand& outcome);
  Status undo();
  Status redo();
  void adopt(const EditState& state);

  Scene scene_;
  EditState state_;
  const Surface* head_ = nullptr;
  History history_;
  std::vector<Step> steps_;
  std::size_t done_ = 0, savedAt_ = 0;
  std::uint64_t revision_ = 0;
  std::unique_ptr<editor::AttemptCache> cache_;
};

struct PreparedCommand {
  std::string label, python;
  std::uint64_t revision = 0;  ///< of the editor that it was prepared for
  HairMesh mesh;
  EditState state;
  bool meshChanged = false;
};

}  // namespace coif
