// The commands behind Editor::run, and what they work on.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/hairmesh/edit.h"
#include "coif/hairmesh/operations.h"
#include "coif/scene/editor.h"
#include "scene/editor/attempt_cache.h"

namespace coif::editor {

/// A command's arguments, complete (defaults filled in) and of the right kinds.
class Arguments {
 public:
  explicit Arguments(CommandArguments values) : values_(std::move(values)) {}
  template <class T>
  const T& get(const std::string& name) const {
    return std::get<T>(values_.at(name));
  }
  double number(const std::string& name) const { return get<double>(name); }
  bool flag(const std::string& name) const { return get<bool>(name); }
  const std::string& text(const std::string& name) const { return get<std::string>(name); }
  const Vec3& vector(const std::string& name) const { return get<Vec3>(name); }
  const std::vector<double>& numbers(const std::string& name) const { return get<std::vector<double>>(name); }

 private:
  CommandArguments values_;
};

/// The mirror plane's partners while symmetric editing is on; null otherwise.
Result<std::unique_ptr<Mirror>> mirrorOf(const HairMesh& mesh, const EditState& state);

/// A copy of the document that a command may change; the editor takes it over when the command succeeds.
struct Work {
  HairMesh mesh;
  EditState state;
  const Surface* head = nullptr;
  const Context& context;
  AttemptCache& cache;
  std::uint64_t revision = 0;  ///< of the document that `mesh` was copied from
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;

  Selection& selection() { return state.selection; }
  Result<std::unique_ptr<Mirror>> mirror() const { return mirrorOf(mesh, state); }
  /// Moves vertices by displacements (one a vertex): frozen ones stay, partners follow when symmetric,
  /// internal vertices among `asked` are pinned, since placement would take them back.
  Status displace(std::vector<Vec3> displacements, std::span<const std::uint32_t> asked);
  /// The same for all vertices at once: what `moved` did to a copy of the mesh.
  Status adoptMoves(const HairMesh& moved, std::span<const std::uint32_t> asked);
};

struct Command {
  CommandInfo info;
  std::function<Status(Work&, const Arguments&)> run;
};

// One file each.
std::vector<Command> selectCommands();
std::vector<Command> meshCommands();
std::vector<Command> moveCommands();
std::vector<Command> brushCommands();
std::vector<Command> settingCommands();
std::vector<Command> styleCommands();
std::vector<Command> motionCommands();
std::vector<Command> fileCommands();

/// Undo and redo, then all of the above; undo and redo have no `run`.
const std::vector<Command>& commands();
const Command* find(std::string_view name);
/// Fills in defaults. Errors: InvalidArgument naming command and argument.
Result<Arguments> complete(const Command& command, const CommandArguments& given);

/// Points from a list of numbers, three each. Errors: InvalidArgument naming `what`.
Result<std::vector<Vec3>> pointsOf(const std::vector<double>& numbers, const char* what);

inline Error refuse(std::string why) {
  return makeError(ErrorCode::InvalidArgument, std::move(why));
}

/// Moves those of `vertices` that are above the root layer and inside the head, or nearer to it than `margin`
/// of its size, to that distance.
void pushOut(HairMesh& mesh, const Surface& head, std::span<const std::uint32_t> vertices, double margin);
/// The arguments of a soft selection, and its weights.
std::vector<CommandArgument> softArguments();
Result<VertexWeights> softWeights(Work& work, std::span<const std::uint32_t> chosen,
                                  const Arguments& arguments);
Falloff falloffOf(const Arguments& arguments);
CommandArgument falloffArgument();

// Short forms for the tables.
CommandArgument number(std::string name, double standard, double least, double most, std::string help);
CommandArgument integer(std::string name, double standard, double least, double most, std::string help);
CommandArgument flag(std::string name, bool standard, std::string help);
CommandArgument choice(std::string name, std::vector<std::string> choices, std::string help);
CommandArgument vector(std::string name, const Vec3& standard, std::string help);
CommandArgument text(std::string name, std::string standard, std::string help);
CommandArgument numbers(std::string name, std::string help);

}  // namespace coif::editor
