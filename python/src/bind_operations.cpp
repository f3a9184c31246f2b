// The operations of the hair mesh as methods of coif.HairMesh: each one step of its history.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind_hairmesh.h"
#include "coif/hairmesh/operations.h"

namespace coif::python {

using namespace nb::literals;

namespace {

using Model = HairMeshModel;
using PyFace = std::tuple<std::uint32_t, std::uint32_t>;                 // bundle, layer
using PyEdge = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // bundle, layer, side
using PyFaces = std::vector<std::variant<std::uint32_t, PyFace>>;        // a bundle alone means its tip face

FaceRef faceRef(const PyFace& f) {
  return {BundleId{std::get<0>(f)}, std::get<1>(f)};
}
EdgeRef edgeRef(const PyEdge& e) {
  return {BundleId{std::get<0>(e)}, std::get<1>(e), std::get<2>(e)};
}

std::vector<BundleId> bundleIds(const std::vector<std::uint32_t>& ids) {
  std::vector<BundleId> out;
  for (const std::uint32_t id : ids) out.push_back(BundleId{id});
  return out;
}

std::vector<FaceRef> tipFaces(const Model& model, const PyFaces& faces) {
  std::vector<FaceRef> out;
  for (const auto& face : faces) {
    if (const auto* pair = std::get_if<PyFace>(&face)) {
      out.push_back(faceRef(*pair));
    } else {
      const std::uint32_t id = std::get<std::uint32_t>(face);
      out.push_back({BundleId{id}, model.mesh().bundles()[model.bundleIndex(id)].height()});
    }
  }
  return out;
}

void bindExtrude(nb::class_<Model>& c) {
  c.def(
       "extrude_faces",
       [](Model& model, const PyFaces& faces, double distance, std::optional<ArrayLike> direction,
          std::optional<ArrayLike> offsets) {
         ExtrudeOptions options;
         options.distance = distance;
         if (direction) options.direction = toVec3(*direction, "direction");
         if (offsets) options.offsets = toPoints(*offsets, "offsets");
         const auto tips = tipFaces(model, faces);
         return model.apply("extrude faces", [&](HairMesh& m) { return extrudeFaces(m, tips, options); });
       },
       "faces"_a, "distance"_a = 0.0, nb::kw_only(), "direction"_a.none() = nb::none(),
       "offsets"_a.none() = nb::none(),
       "Grows a new layer face and prism on tip faces: bundle ids or (bundle, layer) pairs.\n\n"
       "Faces extruded together from one layer share new vertices. New vertices go `distance` along the "
       "area-weighted\n"
       "normal, or by the vector `direction`, or by `offsets` (V×3, one a vertex of the mesh). Returns what "
       "was made.\n"
       "Raises Error for a face that is no tip, an empty or repeating selection, or values not finite.")
      .def(
          "delete_faces",
          [](Model& model, const PyFaces& faces) {
            const auto tips = tipFaces(model, faces);
            return model.apply("delete faces", [&](HairMesh& m) { return deleteFaces(m, tips); });
          },
          "faces"_a,
          "Removes the tip face and last prism of each bundle (ids or (bundle, layer) pairs); a bundle of "
          "height 0 goes\n"
          "with its root face. Raises Error for a face that is no tip.");
}

void bindLayers(nb::class_<Model>& c) {
  c.def(
       "insert_layer",
       [](Model& model, const PyFace& face, double t) {
         return model.apply("insert layer", [&](HairMesh& m) { return insertLayer(m, faceRef(face), t); });
       },
       "face"_a, "t"_a = 0.5,
       "A new layer before the layer of `face` (>= 1), for every bundle connected to it there. New vertices "
       "lie on the\n"
       "parent–child lines at t in (0, 1), 0 being the layer below. Raises Error for layer 0 or t out of "
       "range.")
      .def(
          "remove_layer",
          [](Model& model, const PyFace& face) {
            return model.apply("remove layer", [&](HairMesh& m) { return removeLayer(m, faceRef(face)); });
          },
          "face"_a,
          "Removes the layer of `face` (>= 1) for every bundle connected to it there; vertices above get the "
          "parents of\n"
          "those removed. Raises Error for layer 0.");
}

void bindSeams(nb::class_<Model>& c) {
  nb::enum_<WeldPosition>(c, "WeldPosition", "Where a welded vertex goes.")
      .value("AVERAGE", WeldPosition::Average, "the mean of the two")
      .value("FIRST", WeldPosition::First, "where the first one is");
  c.def(
       "separate_edge",
       [](Model& model, const PyEdge& edge) {
         return model.apply("separate edge", [&](HairMesh& m) { return separateEdge(m, edgeRef(edge)); });
       },
       "edge"_a,
       "Separates a shared edge (bundle, layer, side) of layer >= 1, there and on every layer above; nothing "
       "moves.\n\n"
       "Raises Error for layer 0 and boundary edges.")
      .def(
          "separate_vertex",
          [](Model& model, std::uint32_t vertex) {
            return model.apply("separate vertex",
                               [&](HairMesh& m) { return separateVertex(m, VertexId{vertex}); });
          },
          "vertex"_a,
          "Gives every face at a vertex of layer >= 1 a vertex of its own, there and on every layer "
          "above.\n\n"
          "Raises Error for layer 0 and vertices of one face.")
      .def(
          "weld_edges",
          [](Model& model, const PyEdge& first, const PyEdge& second, WeldPosition where) {
            return model.apply("weld edges", [&](HairMesh& m) {
              return weldEdges(m, edgeRef(first), edgeRef(second), where);
            });
          },
          "first"_a, "second"_a, "where"_a = WeldPosition::Average,
          "Joins two sides of one root edge, separate on this layer, there and on every layer below.\n\n"
          "Raises Error for edges of different root edges.")
      .def(
          "weld_vertices",
          [](Model& model, std::uint32_t first, std::uint32_t second, WeldPosition where) {
            return model.apply("weld vertices", [&](HairMesh& m) {
              return weldVertices(m, VertexId{first}, VertexId{second}, where);
            });
          },
          "first"_a, "second"_a, "where"_a = WeldPosition::Average,
          "Joins two vertices of one layer with the same root ancestor, there and on every layer below.\n\n"
          "Raises Error for vertices of different root ancestors.");
}

FacePoint facePoint(const std::variant<std::uint32_t, std::tuple<std::uint32_t, double>>& point) {
  if (const auto* corner = std::get_if<std::uint32_t>(&point)) return {*corner, 0};
  const auto& [corner, t] = std::get<1>(point);
  return {corner, t};
}

void bindDivision(nb::class_<Model>& c) {
  using Point = std::variant<std::uint32_t, std::tuple<std::uint32_t, double>>;
  c.def(
       "divide_face",
       [](Model& model, std::uint32_t bundle, const Point& from, const Point& to) {
         return model.apply("divide face", [&](HairMesh& m) {
           return divideFace(m, BundleId{bundle}, facePoint(from), facePoint(to));
         });
       },
       "bundle"_a, "start"_a, "end"_a,
       "Splits a face in two in the whole bundle, root to tip. start, end: a corner, or (corner, t) for the "
       "point at t in\n"
       "(0, 1) of the side that begins there. The bundle keeps its id; the other part is new.\n\n"
       "Raises Error for points that are neighbours or the same.")
      .def(
          "divide_edge",
          [](Model& model, const PyEdge& edge, double t) {
            return model.apply("divide edge", [&](HairMesh& m) { return divideEdge(m, edgeRef(edge), t); });
          },
          "edge"_a, "t"_a = 0.5,
          "Inserts a vertex at t in (0, 1) along a root edge and all its copies, in every bundle that has "
          "the edge.\n\n"
          "Raises Error for t out of range.")
      .def(
          "dissolve_edge",
          [](Model& model, const PyEdge& edge) {
            return model.apply("dissolve edge", [&](HairMesh& m) { return dissolveEdge(m, edgeRef(edge)); });
          },
          "edge"_a,
          "The inverse of divide_face: merges the two bundles of an edge that they share on every layer. The "
          "lower id\n"
          "stays. Raises Error where heights differ or another corner is common.")
      .def(
          "dissolve_vertex",
          [](Model& model, std::uint32_t vertex) {
            return model.apply("dissolve vertex",
                               [&](HairMesh& m) { return dissolveVertex(m, VertexId{vertex}); });
          },
          "vertex"_a,
          "The inverse of divide_edge: removes a root vertex between just two root edges, and its column.")
      .def(
          "subdivide",
          [](Model& model, std::optional<std::vector<std::uint32_t>> bundles, SubdivisionScheme scheme) {
            const auto ids = bundleIds(bundles.value_or(std::vector<std::uint32_t>{}));
            if (bundles && ids.empty()) {
              throw ErrorException(makeError(ErrorCode::InvalidArgument, "no bundle is selected"));
            }
            return model.apply("subdivide", [&](HairMesh& m) { return subdivide(m, ids, scheme); });
          },
          "bundles"_a.none() = nb::none(), "scheme"_a = SubdivisionScheme::CatmullClark,
          "Refines bundles (all for None) once, on every layer alike, by OpenSubdiv. Bundles beyond the "
          "selection get the\n"
          "new vertices on their edges. Raises Error for Loop on a bundle that is no triangle.");
}

}  // namespace

void bindCreated(nb::module_& m) {
  nb::enum_<SubdivisionScheme>(m, "SubdivisionScheme", "How subdivide() refines.")
      .value("CATMULL_CLARK", SubdivisionScheme::CatmullClark, "any polygon")
      .value("LOOP", SubdivisionScheme::Loop, "triangles");
  nb::class_<Created>(m, "Created", "What an operation made (or, where its text says so, kept).")
      .def_prop_ro(
          "faces",
          [](const Created& made) {
            std::vector<PyFace> faces;
            for (const FaceRef& f : made.faces) faces.emplace_back(std::uint32_t(f.bundle), f.layer);
            return faces;
          },
          "Faces as (bundle, layer).")
      .def_prop_ro(
          "bundles",
          [](const Created& made) {
            std::vector<std::uint32_t> ids;
            for (const BundleId id : made.bundles) ids.push_back(std::uint32_t(id));
            return ids;
          },
          "Bundle ids.")
      .def_prop_ro(
          "vertices",
          [](const Created& made) {
            std::vector<std::uint32_t> ids;
            for (const VertexId id : made.vertices) ids.push_back(std::uint32_t(id));
            return own1(std::move(ids));
          },
          nb::rv_policy::reference, "Vertex ids, uint32, ascending.")
      .def("__repr__", [](const Created& made) {
        return "<coif.Created: " + std::to_string(made.faces.size()) + " faces, " +
               std::to_string(made.bundles.size()) + " bundles, " + std::to_string(made.vertices.size()) +
               " vertices>";
      });
}

void bindOperations(nb::class_<Model>& c) {
  bindExtrude(c);
  bindLayers(c);
  bindSeams(c);
  bindDivision(c);
}

}  // namespace coif::python
