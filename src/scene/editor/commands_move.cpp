// Geometric moves as commands on the selection.
#include <algorithm>
#include <numbers>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

using Move = std::function<Status(HairMesh&, const VertexWeights&)>;

/// Lets `move` act on a copy and takes its displacements over, so that freezing, symmetry and pinning are the
/// same for all moves.
Status moveBy(Work& work, double radius, const Move& move) {
  const std::vector<std::uint32_t> chosen = selectedVertices(work.mesh, work.selection());
  if (chosen.empty()) return refuse("select something to move first");
  COIF_ASSIGN(const VertexWeights weights, softSelection(work.mesh, chosen, radius));
  HairMesh moved = work.mesh;
  COIF_TRY(move(moved, weights));
  std::vector<Vec3> displacements(moved.vertices().size());
  for (std::uint32_t v = 0; v < displacements.size(); ++v) {
    displacements[v] = moved.position(v) - work.mesh.position(v);
  }
  return work.displace(std::move(displacements), chosen);
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

/// Away from the head: along the edge from the parent, or the mean normal of the root faces.
std::vector<Vec3> outwards(const HairMesh& mesh) {
  std::vector<Vec3> out(mesh.vertices().size(), Vec3::Zero());
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer);
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const Vec3 &at = mesh.position(face[i]), &next = mesh.position(face[(i + 1) % bundle.corners]),
                   &last = mesh.position(face[(i + bundle.corners - 1) % bundle.corners]);
        out[face[i]] += (next - at).cross(last - at);
      }
    }
  }
  for (Vec3& normal : out) normal = normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::Zero());
  return out;
}

Status inflate(Work& work, const Arguments& arguments) {
  const double by = arguments.number("distance");
  return moveBy(work, arguments.number("radius"),
                [by](HairMesh& mesh, const VertexWeights& weights) -> Status {
                  const std::vector<Vec3> normals = outwards(mesh);
                  for (std::uint32_t v = 0; v < normals.size(); ++v) {
                    mesh.setPosition(v, mesh.position(v) + weights[v] * by * normals[v]);
                  }
                  return {};
                });
}

/// Towards the straight line on along the column's first link, at the same distances from vertex to vertex.
Status straighten(Work& work, const Arguments& arguments) {
  const double strength = arguments.number("strength");
  return moveBy(work, 0, [strength](HairMesh& mesh, const VertexWeights& weights) -> Status {
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
  const double margin = arguments.number("margin") * work.head->size();
  std::vector<std::uint32_t> chosen = selectedVertices(work.mesh, work.selection());
  if (chosen.empty()) {
    for (std::uint32_t v = 0; v < work.mesh.vertices().size(); ++v) chosen.push_back(v);
  }
  std::vector<Vec3> displacements(work.mesh.vertices().size(), Vec3::Zero());
  for (std::uint32_t v : chosen) {
    if (work.mesh.vertices()[v].layer == 0) continue;
    const Vec3& at = work.mesh.position(v);
    const double distance = work.head->signedDistance(at);
    if (distance >= margin) continue;
    const SurfacePoint foot = work.head->nearest(at);
    displacements[v] = foot.position + margin * foot.normal - at;
  }
  return work.displace(std::move(displacements), {});
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

}  // namespace

std::vector<Command> moveCommands() {
  const CommandArgument radius = number("radius", 0, 0, 1e12, "Of the soft selection, scene units; 0: none."),
                        aboutPivot =
                            flag("about_pivot", false, "About the pivot, not the selection's middle."),
                        pivot = vector("pivot", Vec3::Zero(), "A point, scene units."),
                        strength = number("strength", 0.5, 0, 1, "How far, from 0 to 1.");
  std::vector<Command> list = {
      {{"translate",
        "Move",
        "Move",
        "G",
        "Moves the selection.",
        {vector("by", Vec3::Zero(), "Scene units."), radius}},
       [](Work& work, const Arguments& arguments) {
         return moveBy(work, arguments.number("radius"), [&](HairMesh& mesh, const VertexWeights& weights) {
           return translate(mesh, weights, arguments.vector("by"));
         });
       }},
      {{"rotate",
        "Rotate",
        "Move",
        "R",
        "Turns the selection.",
        {vector("axis", Vec3::UnitY(), "Of any length but zero."),
         number("angle", 0, -1e6, 1e6, "Degrees, right-handed."), aboutPivot, pivot, radius}},
       [](Work& work, const Arguments& arguments) {
         const Vec3 about = pivotOf(work, arguments);
         return moveBy(work, arguments.number("radius"), [&](HairMesh& mesh, const VertexWeights& weights) {
           return rotate(mesh, weights, about, arguments.vector("axis"),
                         arguments.number("angle") * std::numbers::pi / 180);
         });
       }},
      {{"scale",
        "Scale",
        "Move",
        "S",
        "Scales the selection.",
        {vector("factors", Vec3::Ones(), "Along x, y and z."), aboutPivot, pivot, radius}},
       [](Work& work, const Arguments& arguments) {
         const Vec3 about = pivotOf(work, arguments);
         return moveBy(work, arguments.number("radius"), [&](HairMesh& mesh, const VertexWeights& weights) {
           return scale(mesh, weights, about, arguments.vector("factors"));
         });
       }},
      {{"smooth",
        "Smooth",
        "Move",
        "Shift+R",
        "Relaxes the selection within its layers.",
        {strength, integer("steps", 1, 1, 1000, "How often."), radius}},
       [](Work& work, const Arguments& arguments) {
         return moveBy(work, arguments.number("radius"), [&](HairMesh& mesh, const VertexWeights& weights) {
           return smooth(mesh, weights, arguments.number("strength"), int(arguments.number("steps")));
         });
       }},
      {{"inflate",
        "Inflate",
        "Move",
        "Alt+S",
        "Moves the selection along the normals.",
        {number("distance", 0.05, -1e6, 1e6, "Scene units."), radius}},
       inflate},
      {{"straighten", "Straighten", "Move", "Alt+T", "Lays columns along their first link.", {strength}},
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
      {{"symmetrise", "Make symmetric", "Move", "", "Copies the plane's far side over the near one."},
       makeSymmetric},
  };
  for (Command& command : list) command.info.changesMesh = true;
  return list;
}

}  // namespace coif::editor
