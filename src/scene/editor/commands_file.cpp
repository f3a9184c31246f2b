// Commands that take something from a file.
#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

Status useMesh(Work& work, const Arguments& arguments) {
  if (arguments.text("file").empty()) return refuse("name the .coif document whose hair mesh is wanted");
  COIF_ASSIGN(Scene other, loadScene(arguments.text("file")));
  work.mesh = std::move(other.hairMesh);
  work.state.selection = {};
  work.state.hidden.clear();
  work.state.frozen.clear();
  return {};
}

}  // namespace

std::vector<Command> fileCommands() {
  std::vector<Command> list = {
      {{"use_mesh",
        "Take a mesh ...",
        "File",
        "Ctrl+Shift+O",
        "Replaces the hair mesh by that of another document on the same head.",
        {text("file", "", "A .coif document.")}},
       useMesh},
  };
  list.front().info.changesMesh = true;
  return list;
}

}  // namespace coif::editor
