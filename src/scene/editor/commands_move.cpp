// Geometric moves as commands on the selection.
#include <algorithm>
#include <numbers>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

using Move = std::function<Status(HairMesh&, const VertexWeights&)>;

/// Lets `move` act on a copy and takes its displacements over, so that freezing, symmetry and pinning are the
/// same for all moves.
Status moveBy(Work& work, const Arguments& arguments, const Move& move) {
  const std::vector<std::uint32_t> chosen = selectedVertices(work.mesh, work.selection());
  if (chosen.empty()) return refuse("select something to move first");
  COIF_ASSIGN(const VertexWeights weights, softWeights(work, chosen, arguments));
  HairMesh moved = work.mesh;
  COIF_TRY(move(moved, weights));
  return work.adoptMoves(moved, chosen);
}

Vec3 middleOf(const Work& work) {
  const auto chosen = selectedVertices(work.mesh, work.state.selection);
  Vec3 sum = Vec3::Zero();
  for (std::uint32_t v : chosen) sum += work.mesh.position(v);
  return chosen.empty() ? sum : Vec3(sum / double(chosen.size()));
}

Vec3 pivotOf(const Work& work, const Arguments& arguments) {
  return arguments.flag("about_pivot") ? arguments.vector("pivot") : middleOf(work);
}

Status inflate(Work& work, const Arguments& arguments) {
  const double by = arguments.number("distance");
  return moveBy(work, arguments, [by](HairMesh& mesh, const VertexWeights& weights) -> Status {
    const std::vector<Vec3> normals = hullNormals(mesh);
    for (std::uint32_t v = 0; v < normals.size(); ++v) {
      mesh.setPosition(v, mesh.position(v) + weights[v] * by * normals[v]);
    }
    return {};
  });
}

/// Towards the straight line on along the column's first link, at the same distances from vertex to vertex.
Status straighten(Work& work, const Arguments& arguments) {
  const double strength = arguments.number("strength");
  return moveBy(work, arguments, [strength](HairMesh& mesh, const VertexWeights& weights) -> Status {
    const auto vertices = mesh.vertices();
    std::vector<Vec3> direction(vertices.size(), Vec3::Zero()), straight(vertices.size());
    std::vector<std::uint32_t> order(vertices.size());
    for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
    std::ranges::stable_sort(order, {}, [&](std::uint32_t v) { return vertices[v].layer; });
    std::vector<Vec3> target(vertices.size());
    for (std::uint32_t v : order) {
      const std::uint32_t parent = vertices[v].parent;
      if (parent == kNone) {
        target[v] = mesh.position(v);
        continue;
      }
      const Vec3 link = mesh.position(v) - mesh.position(parent);
      direction[v] =
          direction[parent].isZero(0) && link.norm() > 0 ? Vec3(link.normalized()) : direction[parent];
      target[v] = target[parent] + link.norm() * direction[v];
    }
    for (std::uint32_t v : order) {
      mesh.setPosition(v, mesh.position(v) + strength * weights[v] * (target[v] - mesh.position(v)));
    }
    return {};
  });
}

Status pushOutOfHead(Work& work, const Arguments& arguments) {
  if (work.head == nullptr) return refuse("the head has not been read, so nothing can be pushed out of it");
  std::vector<std::uint32_t> chosen = selectedVertices(work.mesh, work.selection());
  if (chosen.empty()) {
    for (std::uint32_t v = 0; v < work.mesh.vertices().size(); ++v) chosen.push_back(v);
  }
  HairMesh moved = work.mesh;
  pushOut(moved, *work.head, chosen, arguments.number("margin"));
  return work.adoptMoves(moved, {});
}

Status displaceGiven(Work& work, const Arguments& arguments) {
  const auto &ids = arguments.numbers("vertices"), &offsets = arguments.numbers("offsets");
  if (offsets.size() != 3 * ids.size()) return refuse("offsets must hold three numbers a vertex");
  std::vector<Vec3> displacements(work.mesh.vertices().size(), Vec3::Zero());
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool whole = ids[i] >= 0 && ids[i] < double(kNone) && ids[i] == double(std::uint32_t(ids[i]));
    const std::uint32_t v = whole ? work.mesh.indexOf(VertexId(std::uint32_t(ids[i]))) : kNone;
    if (v == kNone)
      return makeError(ErrorCode::NotFound, "there is no such vertex", "entry " + std::to_string(i));
    displacements[v] = Vec3(offsets[3 * i], offsets[3 * i + 1], offsets[3 * i + 2]);
    chosen.push_back(v);
  }
  return work.displace(std::move(displacements), chosen);
}

std::function<Status(Work&, const Arguments&)> pinning(bool pinned) {
  return [pinned](Work& work, const Arguments&) -> Status {
    const auto chosen = selectedVertices(work.mesh, work.selection());
    if (chosen.empty()) return refuse("select vertices first");
    for (std::uint32_t v : chosen) work.mesh.setPinned(v, pinned);
    return {};
  };
}

Status makeSymmetric(Work& work, const Arguments&) {
  if (!work.state.symmetric) return refuse("turn symmetry on first");
  COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
  COIF_ASSIGN(const std::size_t without, symmetrise(work.mesh, *mirror));
  (void)without;
  return {};
}

/// A command's own arguments and those of a soft selection.
std::vector<CommandArgument> soft(std::vector<CommandArgument> own) {
  for (CommandArgument& argument : softArguments()) own.push_back(std::move(argument));
  return own;
}

}  // namespace

void pushOut(HairMesh& mesh, const Surface& head, std::span<const std::uint32_t> vertices, double margin) {
  for (std::uint32_t v : vertices) {
    if (mesh.vertices()[v].layer == 0) continue;
    const Vec3 at = mesh.position(v);
    if (head.signedDistance(at) >= margin * head.size()) continue;
    const SurfacePoint foot = head.nearest(at);
    mesh.setPosition(v, foot.position + margin * head.size() * foot.normal);
  }
}

std::vector<CommandArgument> softArguments() {
  return {number("radius", 0, 0, 1e12, "Of the soft selection, scene units; 0: none."), falloffArgument(),
          choice("metric", {"space", "surface"}, "Its distance: through space, or along the mesh.")};
}

CommandArgument falloffArgument() {
  return choice("falloff", {"smooth", "linear", "sharp", "round", "constant"}, "From the middle to the rim.");
}

Falloff falloffOf(const Arguments& arguments) {
  const auto choices = falloffArgument().choices;
  return Falloff(std::ranges::find(choices, arguments.text("falloff")) - choices.begin());
}

Result<VertexWeights> softWeights(Work& work, std::span<const std::uint32_t> chosen,
                                  const Arguments& arguments) {
  return work.cache.soft(work.revision, work.mesh, chosen, arguments.number("radius"), falloffOf(arguments),
                         arguments.text("metric") == "surface" ? SoftDistance::Surface : SoftDistance::Space);
}

std::vector<Command> moveCommands() {
  const CommandArgument aboutPivot =
                            flag("about_pivot", false, "About the pivot, not the selection's middle."),
                        pivot = vector("pivot", Vec3::Zero(), "A point, scene units."),
                        strength = number("strength", 0.5, 0, 1, "How far, from 0 to 1.");
  std::vector<Command> list = {
      {{"translate", "Move", "Move", "G", "Moves the selection.",
        soft({vector("by", Vec3::Zero(), "Scene units.")})},
       [](Work& work, const Arguments& arguments) {
         return moveBy(work, arguments, [&](HairMesh& mesh, const VertexWeights& weights) {
           return translate(mesh, weights, arguments.vector("by"));
         });
       }},
      {{"rotate", "Rotate", "Move", "R", "Turns the selection.",
        soft({vector("axis", Vec3::UnitY(), "Of any length but zero."),
              number("angle", 0, -1e6, 1e6, "Degrees, right-handed."), aboutPivot, pivot})},
       [](Work& work, const Arguments& arguments) {
         const Vec3 about = pivotOf(work, arguments);
         return moveBy(work, arguments, [&](HairMesh& mesh, const VertexWeights& weights) {
           return rotate(mesh, weights, about, arguments.vector("axis"),
                         arguments.number("angle") * std::numbers::pi / 180);
         });
       }},
      {{"scale", "Scale", "Move", "S", "Scales the selection.",
        soft({vector("factors", Vec3::Ones(), "Along x, y and z, or along the axes."), aboutPivot, pivot,
              numbers("axes", "Three unit vectors at right angles, nine numbers; none: x, y and z.")})},
       [](Work& work, const Arguments& arguments) -> Status {
         const Vec3 about = pivotOf(work, arguments);
         COIF_ASSIGN(const auto given, pointsOf(arguments.numbers("axes"), "axes"));
         if (!given.empty() && given.size() != 3) return refuse("axes must hold nine numbers");
         Mat3 axes = Mat3::Identity();
         for (std::size_t i = 0; i < given.size(); ++i) axes.col(Eigen::Index(i)) = given[i];
         return moveBy(work, arguments, [&](HairMesh& mesh, const VertexWeights& weights) {
           return scale(mesh, weights, about, arguments.vector("factors"), axes);
         });
       }},
      {{"smooth", "Smooth", "Move", "Shift+R", "Relaxes the selection within its layers.",
        soft({strength, integer("steps", 1, 1, 1000, "How often.")})},
       [](Work& work, const Arguments& arguments) {
         return moveBy(work, arguments, [&](HairMesh& mesh, const VertexWeights& weights) {
           return smooth(mesh, weights, arguments.number("strength"), int(arguments.number("steps")));
         });
       }},
      {{"inflate", "Inflate", "Move", "Alt+S", "Moves the selection along the normals.",
        soft({number("distance", 0.05, -1e6, 1e6, "Scene units.")})},
       inflate},
      {{"straighten", "Straighten", "Move", "Alt+T", "Lays columns along their first link.",
        soft({strength})},
       straighten},
      {{"push_out",
        "Push out of the head",
        "Move",
        "P",
        "Moves what is inside the head out of it.",
        {number("margin", 0.002, 0, 1, "Distance kept, of the head's size.")}},
       pushOutOfHead},
      {{"displace",
        "Displace",
        "Move",
        "",
        "Moves vertices by an offset each, as a brush stroke does.",
        {numbers("vertices", "Vertex ids."), numbers("offsets", "Three numbers a vertex, scene units.")}},
       displaceGiven},
      {{"pin", "Pin", "Move", "Shift+P", "Keeps the selected vertices where they are put."}, pinning(true)},
      {{"unpin", "Unpin", "Move", "Alt+P", "Lets the selected inner vertices be placed."}, pinning(false)},
      {{"symmetrise", "Make symmetric", "Move", "Alt+M", "Copies the plane's far side over the near one."},
       makeSymmetric},
  };
  for (Command& command : list) command.info.changesMesh = true;
  return list;
}

}  // namespace coif::editor
