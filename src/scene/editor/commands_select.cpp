// Commands that choose what the others act on.
#include <algorithm>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

CommandArgument kindArgument() {
  return choice("kind", {"vertex", "edge", "face", "bundle", "layer", "group"},
                "What to select; the last three as faces.");
}

SelectKind kindOf(const Arguments& arguments) {
  const auto kinds = kindArgument().choices;
  return SelectKind(std::ranges::find(kinds, arguments.text("kind")) - kinds.begin());
}
CommandArgument modeArgument() {
  return choice("mode", {"set", "add", "remove", "toggle"}, "How it joins what is selected already.");
}

template <class T>
std::vector<T> combined(const std::vector<T>& old, const std::vector<T>& with, const std::string& mode) {
  std::vector<T> out;
  if (mode == "set") return with;
  if (mode == "add") std::ranges::set_union(old, with, std::back_inserter(out));
  if (mode == "remove") std::ranges::set_difference(old, with, std::back_inserter(out));
  if (mode == "toggle") std::ranges::set_symmetric_difference(old, with, std::back_inserter(out));
  return out;
}

void join(Work& work, Selection with, const std::string& mode) {
  with = keepValid(work.mesh, std::move(with));
  const Selection old = work.selection();
  work.selection() = {combined(old.vertices, with.vertices, mode), combined(old.edges, with.edges, mode),
                      combined(old.faces, with.faces, mode)};
}

/// Ids as they came from a script: whole and in range.
Result<std::uint32_t> idOf(double value) {
  if (value < 0 || value >= double(kNone) || value != double(std::uint32_t(value))) {
    return refuse("ids are whole numbers from 0");
  }
  return std::uint32_t(value);
}

Result<std::vector<std::uint32_t>> idsOf(const std::vector<double>& values, std::size_t perElement) {
  if (values.size() % perElement != 0) {
    return refuse("the list must hold " + std::to_string(perElement) + " numbers an element");
  }
  std::vector<std::uint32_t> ids;
  for (double value : values) {
    COIF_ASSIGN(const std::uint32_t id, idOf(value));
    ids.push_back(id);
  }
  return ids;
}

Status select(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const auto vertices, idsOf(arguments.numbers("vertices"), 1));
  COIF_ASSIGN(const auto edges, idsOf(arguments.numbers("edges"), 3));
  COIF_ASSIGN(const auto faces, idsOf(arguments.numbers("faces"), 2));
  Selection with;
  for (std::uint32_t v : vertices) with.vertices.push_back(VertexId(v));
  for (std::size_t i = 0; i < edges.size(); i += 3) {
    with.edges.push_back({BundleId(edges[i]), edges[i + 1], edges[i + 2]});
  }
  for (std::size_t i = 0; i < faces.size(); i += 2) with.faces.push_back({BundleId(faces[i]), faces[i + 1]});
  join(work, std::move(with), arguments.text("mode"));
  return {};
}

Status selectGroup(Work& work, const Arguments& arguments) {
  const auto names = work.mesh.groupNames();
  const auto found = std::ranges::find(names, arguments.text("name"));
  if (found == names.end()) return refuse("there is no group '" + arguments.text("name") + "'");
  Selection with;
  for (const Bundle& bundle : work.mesh.bundles()) {
    if (bundle.group != std::uint32_t(found - names.begin())) continue;
    with.faces.push_back({bundle.id, bundle.height()});
  }
  join(work, std::move(with), arguments.text("mode"));
  return {};
}

/// Faces with as many corners on bundles as high, or vertices of the same layer and kind.
Status selectSimilar(Work& work, const Arguments&) {
  const HairMesh& mesh = work.mesh;
  Selection with;
  const auto alike = [&](const Bundle& a, const Bundle& b) {
    return a.corners == b.corners && a.height() == b.height() && a.group == b.group;
  };
  for (const FaceRef& face : work.selection().faces) {
    const Bundle& like = mesh.bundles()[mesh.indexOf(face.bundle)];
    for (const Bundle& bundle : mesh.bundles()) {
      if (alike(bundle, like)) with.faces.push_back({bundle.id, face.layer});
    }
  }
  const auto external = externalVertices(mesh);
  for (VertexId id : work.selection().vertices) {
    const std::uint32_t like = mesh.indexOf(id);
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      if (mesh.vertices()[v].layer == mesh.vertices()[like].layer && external[v] == external[like])
        with.vertices.push_back(mesh.vertices()[v].id);
    }
  }
  if (with.empty()) return refuse("select vertices or faces first");
  join(work, std::move(with), "set");
  return {};
}

using EdgePath = std::vector<EdgeRef> (*)(const HairMesh&, EdgeRef);
Status along(Work& work, EdgePath path) {
  Selection with;
  for (const EdgeRef& edge : selectedEdges(work.mesh, work.selection())) {
    for (const EdgeRef& other : path(work.mesh, edge)) with.edges.push_back(other);
  }
  if (with.empty()) return refuse("select an edge first");
  join(work, std::move(with), "set");
  return {};
}

using Change = Selection (*)(const HairMesh&, const Selection&);
std::function<Status(Work&, const Arguments&)> changeBy(Change change) {
  return [change](Work& work, const Arguments&) -> Status {
    work.selection() = change(work.mesh, work.selection());
    return {};
  };
}

/// Without what only hidden bundles have.
Selection shownOnly(const Work& work, const Selection& selection) {
  const auto hidden = [&](BundleId id) { return std::ranges::binary_search(work.state.hidden, id); };
  std::vector<std::uint8_t> shown(work.mesh.vertices().size(), 0);
  for (const Bundle& bundle : work.mesh.bundles()) {
    for (std::uint32_t v : bundle.vertices) shown[v] |= !hidden(bundle.id);
  }
  Selection out = selection;
  std::erase_if(out.vertices, [&](VertexId id) { return !shown[work.mesh.indexOf(id)]; });
  std::erase_if(out.faces, [&](const FaceRef& face) { return hidden(face.bundle); });
  std::erase_if(out.edges, [&](const EdgeRef& edge) {
    return std::ranges::any_of(selectedVertices(work.mesh, {{}, {edge}, {}}),
                               [&](auto v) { return !shown[v]; });
  });
  return out;
}

std::vector<Command> allSelectCommands();

}  // namespace

/// What is hidden is selected by its id alone.
std::vector<Command> selectCommands() {
  std::vector<Command> list = allSelectCommands();
  for (Command& command : list) {
    if (command.info.name == "select") continue;
    command.run = [inner = std::move(command.run)](Work& work, const Arguments& arguments) -> Status {
      COIF_TRY(inner(work, arguments));
      if (!work.state.hidden.empty()) work.selection() = shownOnly(work, work.selection());
      return {};
    };
  }
  return list;
}

namespace {

std::vector<Command> allSelectCommands() {
  const CommandArgument layer = integer("layer", 0, 0, 1e6, "The layer; 0 is the root.");
  return {
      {{"select",
        "Select",
        "Select",
        "",
        "Selects elements by id.",
        {numbers("vertices", "Vertex ids."),
         numbers("edges", "Three numbers an edge: bundle id, layer, side."),
         numbers("faces", "Two numbers a face: bundle id, layer."), modeArgument()}},
       select},
      {{"select_all", "All", "Select", "A", "Selects every element of a kind.", {kindArgument()}},
       [](Work& work, const Arguments& arguments) -> Status {
         work.selection() = allOf(work.mesh, kindOf(arguments));
         return {};
       }},
      {{"select_none", "None", "Select", "Alt+A", "Selects nothing."},
       [](Work& work, const Arguments&) -> Status {
         work.selection() = {};
         return {};
       }},
      {{"select_invert", "Invert", "Select", "Ctrl+I", "Selects what is not selected.", {kindArgument()}},
       [](Work& work, const Arguments& arguments) -> Status {
         work.selection() = inverted(work.mesh, work.selection(), kindOf(arguments));
         return {};
       }},
      {{"select_layer",
        "Layer",
        "Select",
        "Shift+L",
        "Selects a whole layer.",
        {layer, kindArgument(), modeArgument()}},
       [](Work& work, const Arguments& arguments) -> Status {
         join(work, allOf(work.mesh, kindOf(arguments), std::uint32_t(arguments.number("layer"))),
              arguments.text("mode"));
         return {};
       }},
      {{"select_group",
        "Group",
        "Select",
        "Shift+G",
        "Selects the tips of a group's bundles.",
        {text("name", "hair", "The group."), modeArgument()}},
       selectGroup},
      {{"select_more", "More", "Select", "Ctrl+NumpadAdd", "Grows the selection by one step."},
       changeBy(grown)},
      {{"select_less", "Less", "Select", "Ctrl+NumpadSubtract", "Shrinks the selection by one step."},
       changeBy(shrunk)},
      {{"select_linked", "Linked", "Select", "Ctrl+L", "Selects all that edges connect on the layer."},
       changeBy(linked)},
      {{"select_columns", "Columns", "Select", "Shift+C", "Selects the same elements on every layer."},
       changeBy(columns)},
      {{"select_loop", "Edge loop", "Select", "Alt+L", "Selects the edges that go on straight."},
       [](Work& work, const Arguments&) { return along(work, edgeLoop); }},
      {{"select_ring", "Edge ring", "Select", "Alt+R", "Selects the edges across, side by side."},
       [](Work& work, const Arguments&) { return along(work, edgeRing); }},
      {{"select_similar", "Similar", "Select", "Shift+S", "Selects what is like the selection."},
       selectSimilar},
  };
}

}  // namespace
}  // namespace coif::editor
