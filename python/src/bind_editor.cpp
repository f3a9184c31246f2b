// The editor: commands by name on an open document, with undo.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "bind.h"
#include "bind_hairmesh.h"
#include "bind_style.h"
#include "coif/io/mesh_io.h"
#include "coif/scene/editor.h"

namespace coif::python {

using namespace nb::literals;

namespace {

/// An editor and the head that it looks at, read when a command first needs it.
struct EditorModel {
  explicit EditorModel(Scene scene) : editor(std::move(scene)) {}
  Editor editor;
  std::unique_ptr<Surface> head;
};

std::unique_ptr<EditorModel> openEditor(const std::filesystem::path& path, bool useHead) {
  auto model = std::make_unique<EditorModel>(take(loadScene(path)));
  if (useHead && !model->editor.scene().head.path.empty()) {
    model->head = std::make_unique<Surface>(take(loadPolygonMesh(model->editor.scene().headPath())));
    model->editor.setHead(model->head.get());
  }
  return model;
}

CommandValue valueOf(nb::handle given, const CommandArgument& argument) {
  switch (argument.kind) {
    case ArgumentKind::Flag:
      return nb::cast<bool>(given);
    case ArgumentKind::Number:
    case ArgumentKind::Integer:
      return nb::cast<double>(nb::float_(given));
    case ArgumentKind::Choice:
    case ArgumentKind::Text:
      return nb::cast<std::string>(given);
    case ArgumentKind::Vector:
      return toVec3(ArrayLike{nb::borrow(given)}, argument.name.c_str());
    case ArgumentKind::Numbers:
      break;
  }
  const auto array = toArray<double>(ArrayLike{nb::borrow(given)}, argument.name.c_str(), {-1});
  return std::vector<double>(array.data(), array.data() + array.size());
}

void run(EditorModel& model, const std::string& command, const nb::kwargs& given) {
  CommandArguments arguments;
  const CommandInfo* info = findCommand(command);
  for (const auto [key, value] : given) {
    const std::string name = nb::cast<std::string>(key);
    CommandArgument unknown;  // the editor itself refuses it by name
    const CommandArgument* argument = &unknown;
    if (info != nullptr) {
      for (const CommandArgument& a : info->arguments) {
        if (a.name == name) argument = &a;
      }
    }
    try {
      arguments[name] = argument == &unknown ? CommandValue(false) : valueOf(value, *argument);
    } catch (const nb::cast_error&) {
      throw nb::type_error((command + ": " + name + " is of the wrong kind").c_str());
    }
  }
  const auto status = [&] {
    const nb::gil_scoped_release unlocked;
    return model.editor.run(command, arguments);
  }();
  take(status);
}

nb::object commandNamed(nb::handle self, const std::string& name) {
  return nb::module_::import_("coif._commands").attr("method")(self, name);
}

nb::list commandList() {
  nb::list out;
  for (const CommandInfo& info : commandInfos()) {
    nb::dict entry;
    entry["name"] = info.name, entry["label"] = info.label, entry["menu"] = info.menu;
    entry["key"] = info.key, entry["help"] = info.help;
    nb::dict arguments;
    for (const CommandArgument& a : info.arguments) arguments[a.name.c_str()] = a.help;
    entry["arguments"] = arguments;
    out.append(entry);
  }
  return out;
}

template <class Id>
Array1<std::uint32_t> idArray(const std::vector<Id>& ids) {
  std::vector<std::uint32_t> out;
  for (Id id : ids) out.push_back(std::uint32_t(id));
  return own1<std::uint32_t>(std::move(out));
}

}  // namespace

void bindEditor(nb::module_& m) {
  m.def(
      "editor_commands", &commandList,
      "Every command of coif.Editor: a list of dicts with name, label, menu, key, help and arguments (name → "
      "help).");
  nb::class_<EditorModel>(
      m, "Editor",
      "An open .coif document with commands by name and unlimited undo: what the editor's "
      "menus call, and what its 'copy as Python' writes.\n\n"
      "A command is a method: editor.extrude(distance=0.5). One command is one undo step; "
      "internal vertices are placed after it. coif.editor_commands() lists them. A command "
      "that is refused raises coif.Error and changes nothing.")
      .def_static("open", &openEditor, "path"_a, "use_head"_a = true,
                  "Opens a .coif file. use_head=False leaves the head unread; push_out is then refused. "
                  "Raises coif.Error where the file or the head cannot be read.")
      .def("run", &run, "command"_a, "arguments"_a,
           "Runs a command by name with its arguments by keyword; see coif.editor_commands().")
      .def("__getattr__", &commandNamed, "name"_a)
      .def("__dir__", [](nb::handle self) { return nb::module_::import_("coif._commands").attr("listed")(self); })
      .def(
          "save",
          [](EditorModel& model, const std::filesystem::path& path) { take(model.editor.save(path)); },
          "path"_a, "Writes the document atomically.")
      .def_prop_ro(
          "mesh", [](const EditorModel& model) { return HairMeshModel(HairMesh(model.editor.mesh())); },
          "A copy of the hair mesh as it stands.")
      .def_prop_ro(
          "selected_vertices",
          [](const EditorModel& model) { return idArray(model.editor.state().selection.vertices); },
          nb::rv_policy::reference,
          "Ids of the selected vertices (N,), ascending; vertices of selected edges and faces are not "
          "listed.")
      .def_prop_ro(
          "selected_bundles",
          [](const EditorModel& model) {
            return idArray(selectedBundles(model.editor.mesh(), model.editor.state().selection));
          },
          nb::rv_policy::reference, "Ids of the bundles with a selected face (N,), ascending.")
      .def_prop_ro(
          "styles", [](const EditorModel& model) { return fromStyles(model.editor.state().styles); },
          "The style's operators, as Scene.styles gives them.")
      .def_prop_ro(
          "steps", [](const EditorModel& model) { return model.editor.stepLabels(); },
          "Labels of all steps, oldest first, undone ones included.")
      .def_prop_ro(
          "undo_count", [](const EditorModel& model) { return model.editor.undoCount(); },
          "How many steps are done.")
      .def_prop_ro(
          "modified", [](const EditorModel& model) { return model.editor.modified(); },
          "Whether something changed since opening or saving.")
      .def_prop_ro(
          "python_log", [](const EditorModel& model) { return model.editor.pythonLog(); },
          "The steps that are done as lines of Python.");
}

}  // namespace coif::python
