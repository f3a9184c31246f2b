// Brush strokes and snapping.
#include <algorithm>
#include <cmath>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

constexpr double kKeptOutOfHead = 0.002;  // of the head's size: push_out's own

const std::vector<std::string>& brushNames() {
  static const std::vector<std::string> names = {"comb",    "grab",  "push",  "pull",
                                                 "inflate", "twist", "smooth"};
  return names;
}

/// 1 where a brush may move: not frozen, and selected where only the selection is meant.
Result<VertexWeights> brushMask(const Work& work, bool onlySelected) {
  VertexWeights mask(work.mesh.vertices().size(), onlySelected ? 0 : 1);
  if (onlySelected) {
    const auto chosen = selectedVertices(work.mesh, work.state.selection);
    if (chosen.empty()) return refuse("select what the brush may move first");
    for (std::uint32_t v : chosen) mask[v] = 1;
  }
  for (VertexId id : work.state.frozen) mask[work.mesh.indexOf(id)] = 0;
  return mask;
}

Status brushStroke(Work& work, const Arguments& arguments) {
  BrushStroke stroke;
  stroke.kind = BrushKind(std::ranges::find(brushNames(), arguments.text("kind")) - brushNames().begin());
  COIF_ASSIGN(stroke.path, pointsOf(arguments.numbers("path"), "path"));
  stroke.radius = arguments.number("radius");
  stroke.strength = arguments.number("strength");
  stroke.falloff = falloffOf(arguments);
  stroke.through = arguments.vector("through");
  stroke.roots = arguments.flag("roots");
  COIF_ASSIGN(VertexWeights mask, brushMask(work, arguments.flag("selected")));
  COIF_ASSIGN(HairMesh moved, work.cache.brush(work.revision, work.mesh, std::move(stroke), std::move(mask)));
  if (work.head != nullptr && arguments.flag("keep_out")) {
    std::vector<std::uint32_t> touched;
    for (std::uint32_t v = 0; v < moved.vertices().size(); ++v) {
      if (moved.position(v) != work.mesh.position(v)) touched.push_back(v);
    }
    work.cache.pushOut(moved, *work.head, touched, kKeptOutOfHead);
  }
  return work.adoptMoves(moved, {});
}

Status snap(Work& work, const Arguments& arguments) {
  const std::vector<std::uint32_t> chosen = selectedVertices(work.mesh, work.selection());
  if (chosen.empty()) return refuse("select vertices first");
  const std::string& to = arguments.text("to");
  const double step = arguments.number("step");
  if (to == "scalp" && work.head == nullptr) return refuse("the head has not been read");
  HairMesh moved = work.mesh;
  for (std::uint32_t v : chosen) {
    const Vec3& at = work.mesh.position(v);
    if (to == "grid") {
      moved.setPosition(v, step * Vec3((at / step).array().round().matrix()));
    } else if (to == "scalp") {
      moved.setPosition(v, work.head->nearest(at).position);
    } else {
      std::uint32_t nearest = kNone;
      for (std::uint32_t other = 0; other < work.mesh.vertices().size(); ++other) {
        if (std::ranges::binary_search(chosen, other)) continue;
        if (nearest == kNone ||
            (work.mesh.position(other) - at).norm() < (work.mesh.position(nearest) - at).norm())
          nearest = other;
      }
      if (nearest == kNone) return refuse("every vertex is selected, so there is none to snap to");
      moved.setPosition(v, work.mesh.position(nearest));
    }
  }
  return work.adoptMoves(moved, chosen);
}

}  // namespace

std::vector<Command> brushCommands() {
  std::vector<Command> list = {
      {{"brush",
        "Brush stroke",
        "Move",
        "",
        "Brushes hair along a line; all of it without a selection of its own.",
        {choice("kind", brushNames(), "What the brush does."),
         numbers("path", "Three numbers a point, scene units."),
         number("radius", 1, 1e-9, 1e12, "Scene units."), number("strength", 0.5, -1, 1, "From -1 to 1."),
         falloffArgument(),
         vector("through", Vec3::Zero(), "Unless zero: the brush reaches all along this direction."),
         flag("selected", false, "Only the selection is brushed."),
         flag("roots", false, "The root layer is brushed too."),
         flag("keep_out", true, "What is brushed stays out of the head.")}},
       brushStroke},
      {{"snap",
        "Snap",
        "Move",
        "Shift+N",
        "Moves each selected vertex to the grid, the scalp or the next vertex.",
        {choice("to", {"grid", "scalp", "vertex"}, "Where to."),
         number("step", 0.1, 1e-9, 1e12, "Of the grid, scene units.")}},
       snap},
  };
  for (Command& command : list) command.info.changesMesh = true;
  return list;
}

}  // namespace coif::editor
