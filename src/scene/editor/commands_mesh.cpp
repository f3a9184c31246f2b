// The topological operations as commands on the selection.
#include <algorithm>
#include <optional>
#include <set>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

constexpr std::size_t kMostNewFaces = 1000000;

void selectCreated(Work& work, const Created& created) {
  work.selection() = {};
  if (!created.faces.empty()) {
    work.selection().faces = created.faces;
    return;
  }
  for (BundleId id : created.bundles) {
    const std::uint32_t bundle = work.mesh.indexOf(id);
    if (bundle != kNone) work.selection().faces.push_back({id, work.mesh.bundles()[bundle].height()});
  }
  if (created.bundles.empty()) work.selection().vertices = created.vertices;
}

Result<std::vector<BundleId>> bundlesOf(const Work& work) {
  std::vector<BundleId> ids = selectedBundles(work.mesh, work.state.selection);
  if (ids.empty()) return refuse("select faces first");
  COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
  if (mirror) return withMirrored(work.mesh, *mirror, ids);
  return ids;
}

/// The selected tips; a face below the tip is refused with a sentence.
Result<std::vector<BundleId>> tipsOf(const Work& work, const char* what) {
  for (const FaceRef& face : selectedFaces(work.mesh, work.state.selection)) {
    const Bundle& bundle = work.mesh.bundles()[work.mesh.indexOf(face.bundle)];
    const bool tipToo = std::ranges::binary_search(selectedFaces(work.mesh, work.state.selection),
                                                   FaceRef{face.bundle, bundle.height()});
    if (!tipToo) return refuse(std::string("only the last face of a bundle can be ") + what);
  }
  return bundlesOf(work);
}

Vec3 upOf(const Work& work) {
  return work.upAxis == UpAxis::Y ? Vec3::UnitY() : Vec3::UnitZ();
}

/// The path of a command that asks for more than one plain layer; empty otherwise.
Result<std::optional<ExtrudePath>> pathOf(const Work& work, const Arguments& arguments) {
  ExtrudePath path;
  path.layers = std::uint32_t(arguments.number("layers"));
  path.length = arguments.number("distance");
  path.bend = arguments.number("bend");
  path.towards = -upOf(work);
  const Vec3& direction = arguments.vector("direction");
  COIF_ASSIGN(path.curve, pointsOf(arguments.numbers("curve"), "curve"));
  if (path.curve.empty() && !direction.isZero(0)) path.curve = {Vec3::Zero(), direction};
  const bool plain = path.layers == 1 && path.bend == 0 && arguments.numbers("curve").empty();
  return plain ? std::nullopt : std::optional(path);
}

/// Tips on the side of the plane to which the curve leads follow it, the others its image.
CurveSides sidesOf(const HairMesh& mesh, const Mirror& mirror, std::span<const BundleId> tips,
                   const std::vector<Vec3>& curve) {
  const auto height = [&](const Vec3& p) { return (p - mirror.point).dot(mirror.normal); };
  CurveSides out{mirror.point, mirror.normal, {}};
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : curve) middle += p / double(curve.size());
  for (BundleId id : tips) {
    const std::uint32_t index = mesh.indexOf(id), partner = mirror.bundlePartner[index];
    double side = 0;
    for (std::uint32_t v : mesh.bundles()[index].face(mesh.bundles()[index].height()))
      side += height(mesh.position(v));
    out.of.push_back(partner == index                     ? CurveSides::Both
                     : partner == kNone                   ? CurveSides::Curve
                     : (side > 0) == (height(middle) > 0) ? CurveSides::Curve
                                                          : CurveSides::Image);
  }
  return out;
}

Status extrude(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const auto tips, tipsOf(work, "extruded"));
  COIF_ASSIGN(const auto path, pathOf(work, arguments));
  if (path) {
    if (path->layers * tips.size() > kMostNewFaces)
      return refuse("that would make more than a million faces");
    ExtrudePath both = *path;
    COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
    if (mirror && !both.curve.empty()) both.sides = sidesOf(work.mesh, *mirror, tips, both.curve);
    COIF_ASSIGN(const Created created, extrudeAlong(work.mesh, tips, both));
    selectCreated(work, created);
    return {};
  }
  ExtrudeOptions options;
  options.distance = arguments.number("distance");
  if (!arguments.vector("direction").isZero(0)) options.direction = arguments.vector("direction");
  COIF_ASSIGN(const Created created, extrudeFaces(work.mesh, tips, options));
  selectCreated(work, created);
  return {};
}

Status deleteTips(Work& work, const Arguments&) {
  COIF_ASSIGN(const auto tips, tipsOf(work, "deleted"));
  COIF_ASSIGN(const Created created, deleteFaces(work.mesh, tips));
  (void)created;
  work.selection() = {};
  for (BundleId id : tips) {
    const std::uint32_t bundle = work.mesh.indexOf(id);
    if (bundle != kNone) work.selection().faces.push_back({id, work.mesh.bundles()[bundle].height()});
  }
  return {};
}

/// Runs a layer operation once for each connected part of each selected layer, from the tips down so that the
/// layers still to come keep their numbers.
template <class Operation>
Status onLayers(Work& work, const Operation& operation) {
  std::vector<FaceRef> faces = selectedFaces(work.mesh, work.selection());
  if (faces.empty()) return refuse("select a face of the layer first");
  COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
  if (mirror) {
    for (const FaceRef& face : std::vector<FaceRef>(faces)) {
      if (const auto other = mirrored(work.mesh, *mirror, face); other.ok()) faces.push_back(*other);
    }
  }
  std::ranges::sort(faces, std::greater(), &FaceRef::layer);
  std::set<FaceRef> done;
  std::vector<FaceRef> made;
  for (const FaceRef& face : faces) {
    if (done.contains(face)) continue;
    COIF_ASSIGN(const auto connected, connectedBundles(work.mesh, face.bundle, face.layer));
    for (std::uint32_t bundle : connected) done.insert({work.mesh.bundles()[bundle].id, face.layer});
    COIF_ASSIGN(const Created created, operation(work.mesh, face));
    made.insert(made.end(), created.faces.begin(), created.faces.end());
  }
  work.selection() = {};
  work.selection().faces = made;
  return {};
}

/// Runs an operation on every selected edge and, when symmetric, on its partner. An edge that an earlier one
/// took along is left out.
template <class Operation>
Status onEdges(Work& work, const Operation& operation) {
  const std::vector<EdgeRef> edges = selectedEdges(work.mesh, work.selection());
  if (edges.empty()) return refuse("select an edge first");
  std::vector<VertexId> made;
  for (const EdgeRef& edge : edges) {
    const auto record = [&](HairMesh& mesh, EdgeRef ref) -> Status {
      COIF_ASSIGN(const Created created, operation(mesh, ref));
      made.insert(made.end(), created.vertices.begin(), created.vertices.end());
      return {};
    };
    COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
    if (mirror && mirrored(work.mesh, *mirror, edge).ok()) {
      COIF_TRY(applySymmetrically(work.mesh, *mirror, edge, record));
    } else {
      COIF_TRY(record(work.mesh, edge));
    }
  }
  std::ranges::sort(made);
  work.selection() = {made, {}, {}};
  return {};
}

/// The vertices and, while symmetric, their partners, ascending.
Result<std::vector<VertexId>> withPartners(const Work& work, std::vector<VertexId> ids) {
  COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
  for (std::size_t i = 0, count = ids.size(); mirror && i < count; ++i) {
    const std::uint32_t partner = mirror->vertexPartner[work.mesh.indexOf(ids[i])];
    if (partner != kNone) ids.push_back(work.mesh.vertices()[partner].id);
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// A pair of things and, while symmetric, the pair on the other side; once where that is the same pair.
template <class T, class PartnerOf>
Result<std::vector<std::pair<T, T>>> pairsOf(const Work& work, T a, T b, const PartnerOf& partnerOf) {
  std::vector<std::pair<T, T>> pairs{{a, b}};
  COIF_ASSIGN(const std::unique_ptr<Mirror> mirror, work.mirror());
  if (!mirror) return pairs;
  const std::optional<T> otherA = partnerOf(*mirror, a), otherB = partnerOf(*mirror, b);
  if (otherA && otherB && std::minmax(*otherA, *otherB) != std::minmax(a, b))
    pairs.push_back({*otherA, *otherB});
  return pairs;
}

Result<std::vector<std::pair<VertexId, VertexId>>> vertexPairs(const Work& work, VertexId a, VertexId b) {
  return pairsOf(work, a, b, [&](const Mirror& mirror, VertexId id) -> std::optional<VertexId> {
    const std::uint32_t partner = mirror.vertexPartner[work.mesh.indexOf(id)];
    if (partner == kNone) return std::nullopt;
    return work.mesh.vertices()[partner].id;
  });
}

Status separateVertices(Work& work, const Arguments&) {
  if (work.selection().vertices.empty()) return refuse("select vertices first");
  COIF_ASSIGN(const auto ids, withPartners(work, work.selection().vertices));
  std::vector<VertexId> made;
  for (VertexId id : ids) {
    COIF_ASSIGN(const Created created, separateVertex(work.mesh, id));
    made.insert(made.end(), created.vertices.begin(), created.vertices.end());
  }
  std::ranges::sort(made);
  work.selection() = {made, {}, {}};
  return {};
}

WeldPosition weldPositionOf(const Arguments& arguments) {
  return arguments.text("where") == "first" ? WeldPosition::First : WeldPosition::Average;
}

/// Selects the vertices that welding kept.
Status keepWelded(Work& work, const std::vector<VertexId>& kept) {
  work.selection() = keepValid(work.mesh, {kept, {}, {}});
  return {};
}

Status weldSelectedEdges(Work& work, const Arguments& arguments) {
  const std::vector<EdgeRef> edges = work.selection().edges;
  if (edges.size() != 2) return refuse("select the two edges to weld");
  COIF_ASSIGN(const auto pairs, pairsOf(work, edges[0], edges[1],
                                        [&](const Mirror& mirror, EdgeRef edge) -> std::optional<EdgeRef> {
                                          const auto other = mirrored(work.mesh, mirror, edge);
                                          return other.ok() ? std::optional(*other) : std::nullopt;
                                        }));
  std::vector<VertexId> all;
  for (const auto& [a, b] : pairs) {
    COIF_ASSIGN(const Created kept, weldEdges(work.mesh, a, b, weldPositionOf(arguments)));
    all.insert(all.end(), kept.vertices.begin(), kept.vertices.end());
  }
  return keepWelded(work, all);
}

Status weldSelectedVertices(Work& work, const Arguments& arguments) {
  const std::vector<VertexId> ids = work.selection().vertices;
  if (ids.size() != 2) return refuse("select the two vertices to weld");
  COIF_ASSIGN(const auto pairs, vertexPairs(work, ids[0], ids[1]));
  std::vector<VertexId> all;
  for (const auto& [a, b] : pairs) {
    // What the first weld took along needs no second one.
    if (work.mesh.indexOf(a) == kNone || work.mesh.indexOf(b) == kNone) continue;
    COIF_ASSIGN(const Created kept, weldVertices(work.mesh, a, b, weldPositionOf(arguments)));
    all.insert(all.end(), kept.vertices.begin(), kept.vertices.end());
  }
  return keepWelded(work, all);
}

Result<Created> divideBetween(HairMesh& mesh, VertexId first, VertexId second) {
  const std::uint32_t a = mesh.indexOf(first), b = mesh.indexOf(second);
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer);
      const auto cornerA = std::ranges::find(face, a), cornerB = std::ranges::find(face, b);
      if (cornerA == face.end() || cornerB == face.end()) continue;
      return divideFace(mesh, bundle.id, std::uint32_t(cornerA - face.begin()),
                        std::uint32_t(cornerB - face.begin()));
    }
  }
  return refuse("the two vertices have no face in common");
}

Status divideSelectedFace(Work& work, const Arguments&) {
  const std::vector<VertexId> ids = work.selection().vertices;
  if (ids.size() != 2) return refuse("select two vertices of the face to divide");
  COIF_ASSIGN(const auto pairs, vertexPairs(work, ids[0], ids[1]));
  Created all;
  for (const auto& [a, b] : pairs) {
    COIF_ASSIGN(const Created created, divideBetween(work.mesh, a, b));
    all.bundles.insert(all.bundles.end(), created.bundles.begin(), created.bundles.end());
  }
  selectCreated(work, all);
  return {};
}

Status dissolveSelectedVertices(Work& work, const Arguments&) {
  if (work.selection().vertices.empty()) return refuse("select root vertices first");
  COIF_ASSIGN(const auto ids, withPartners(work, work.selection().vertices));
  for (VertexId id : ids) {
    COIF_ASSIGN(const Created created, dissolveVertex(work.mesh, id));
    (void)created;
  }
  work.selection() = {};
  return {};
}

Status subdivideSelected(Work& work, const Arguments& arguments) {
  std::vector<BundleId> ids;
  if (!work.selection().empty()) {
    COIF_ASSIGN(ids, bundlesOf(work));
  }
  const bool loop = arguments.text("scheme") == "loop";
  COIF_ASSIGN(const Created created,
              subdivide(work.mesh, ids, loop ? SubdivisionScheme::Loop : SubdivisionScheme::CatmullClark));
  selectCreated(work, created);
  return {};
}

Status setGroup(Work& work, const Arguments& arguments) {
  const std::string& name = arguments.text("name");
  if (name.empty()) return refuse("a group needs a name");
  COIF_ASSIGN(const auto ids, bundlesOf(work));
  const std::uint32_t group = work.mesh.addGroup(name);
  for (BundleId id : ids) work.mesh.setGroup(work.mesh.indexOf(id), group);
  return {};
}

}  // namespace

std::vector<Command> meshCommands() {
  const CommandArgument where = choice("where", {"average", "first"}, "Where the welded vertices go.");
  const CommandArgument along = number("t", 0.5, 1e-6, 1 - 1e-6, "Where between the two ends.");
  std::vector<Command> list = {
      {{"extrude",
        "Extrude",
        "Mesh",
        "E",
        "A new layer on each selected tip.",
        {number("distance", 0.1, -1e6, 1e6, "Along the normal, scene units."),
         vector("direction", Vec3::Zero(), "Instead, unless zero: the displacement, scene units."),
         integer("layers", 1, 1, 1000, "How many layers share the way."),
         number("bend", 0, 0, 1, "By what part each layer turns down, as gravity does."),
         numbers("curve", "Instead, unless empty: a line to follow, three numbers a point.")}},
       extrude},
      {{"delete", "Delete", "Mesh", "X", "Removes the selected tips."}, deleteTips},
      {{"insert_layer", "Insert layer", "Mesh", "I", "A layer before the selected faces' own.", {along}},
       [](Work& work, const Arguments& arguments) {
         const double t = arguments.number("t");
         return onLayers(work, [t](HairMesh& mesh, FaceRef face) { return insertLayer(mesh, face, t); });
       }},
      {{"remove_layer", "Remove layer", "Mesh", "Ctrl+X", "Removes the selected faces' layer."},
       [](Work& work, const Arguments&) {
         return onLayers(work, [](HairMesh& mesh, FaceRef face) { return removeLayer(mesh, face); });
       }},
      {{"separate_edges", "Separate edges", "Mesh", "Y", "Parts the selected edges there and above."},
       [](Work& work, const Arguments&) {
         return onEdges(work, [](HairMesh& mesh, EdgeRef edge) { return separateEdge(mesh, edge); });
       }},
      {{"separate_vertices", "Separate vertices", "Mesh", "V", "Parts all faces at the selected vertices."},
       separateVertices},
      {{"weld_edges", "Weld edges", "Mesh", "Ctrl+Y", "Joins two parted edges there and below.", {where}},
       weldSelectedEdges},
      {{"weld_vertices",
        "Weld vertices",
        "Mesh",
        "M",
        "Joins two vertices of one root there and below.",
        {where}},
       weldSelectedVertices},
      {{"divide_face", "Divide face", "Mesh", "J", "Splits a face between two of its corners."},
       divideSelectedFace},
      {{"divide_edges", "Divide edges", "Mesh", "Ctrl+E", "A vertex on the selected edges.", {along}},
       [](Work& work, const Arguments& arguments) {
         const double t = arguments.number("t");
         return onEdges(work, [t](HairMesh& mesh, EdgeRef edge) { return divideEdge(mesh, edge, t); });
       }},
      {{"dissolve_edges", "Dissolve edges", "Mesh", "Ctrl+D", "Merges the bundles beside the edges."},
       [](Work& work, const Arguments&) {
         return onEdges(work, [](HairMesh& mesh, EdgeRef edge) { return dissolveEdge(mesh, edge); });
       }},
      {{"dissolve_vertices", "Dissolve vertices", "Mesh", "Shift+X", "Removes vertices between two edges."},
       dissolveSelectedVertices},
      {{"subdivide",
        "Subdivide",
        "Mesh",
        "Ctrl+R",
        "Refines the selected bundles, or all.",
        {choice("scheme", {"catmull-clark", "loop"}, "How new vertices are placed.")}},
       subdivideSelected},
      {{"set_group",
        "Put in group",
        "Mesh",
        "Ctrl+G",
        "Puts the selected bundles into a group.",
        {text("name", "hair", "The group; made if new.")}},
       setGroup},
  };
  for (Command& command : list) command.info.changesMesh = true;
  return list;
}

}  // namespace coif::editor
