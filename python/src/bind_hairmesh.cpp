// The hairmesh room: the mesh as Python reads it, and its history. Operations are in bind_operations.cpp.
#include "bind_hairmesh.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind_scalp.h"
#include "coif/hairmesh/invariants.h"

namespace coif::python {

using namespace nb::literals;

std::vector<std::uint32_t> HairMeshModel::vertexIndices(const ArrayLike& ids, const char* argument) const {
  auto indices = toIndices(ids, argument);
  for (auto& index : indices) {
    const std::uint32_t id = index;
    index = mesh().indexOf(VertexId{id});
    if (index == kNone) {
      throw ErrorException(
          makeError(ErrorCode::NotFound, "there is no such vertex", "vertex " + std::to_string(id)));
    }
  }
  return indices;
}

std::uint32_t HairMeshModel::bundleIndex(std::uint32_t id) const {
  const std::uint32_t index = mesh().indexOf(BundleId{id});
  if (index == kNone) {
    throw ErrorException(
        makeError(ErrorCode::NotFound, "there is no such bundle", "bundle " + std::to_string(id)));
  }
  return index;
}

namespace {

using Model = HairMeshModel;

std::uint32_t idOf(const HairMesh& mesh, std::uint32_t vertex) {
  return std::uint32_t(mesh.vertices()[vertex].id);
}

/// One value a vertex, as an array.
template <class Read>
auto perVertex(const Model& model, Read read) {
  using T = decltype(read(model.mesh().vertices()[0]));
  std::vector<T> values;
  values.reserve(model.mesh().vertices().size());
  for (const HairVertex& v : model.mesh().vertices()) values.push_back(read(v));
  return own1(std::move(values));
}

Array1<bool> flags(std::span<const std::uint8_t> values) {
  auto* kept = new std::vector<std::uint8_t>(values.begin(), values.end());
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<std::uint8_t>*>(p); });
  return view1<bool>(owner, reinterpret_cast<bool*>(kept->data()), kept->size());
}

/// A bundle as Python sees it: a copy of what it was when asked for.
struct BundleView {
  std::uint32_t id = 0, corners = 0, height = 0;
  std::string group;
  std::vector<std::uint32_t> vertices;  ///< ids
};

BundleView viewOf(const HairMesh& mesh, const Bundle& bundle) {
  BundleView view{
      std::uint32_t(bundle.id), bundle.corners, bundle.height(), mesh.groupNames()[bundle.group], {}};
  for (const std::uint32_t v : bundle.vertices) view.vertices.push_back(idOf(mesh, v));
  return view;
}

nb::ndarray<nb::numpy, std::uint32_t, nb::ndim<2>, nb::c_contig> verticesOf(const BundleView& view) {
  auto* kept = new std::vector<std::uint32_t>(view.vertices);
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<std::uint32_t>*>(p); });
  return {kept->data(), {std::size_t(view.height) + 1, view.corners}, owner};
}

void bindBundle(nb::module_& m) {
  nb::class_<BundleView>(m, "Bundle",
                         "One column of faces over a root face, as it was when it was asked for (a copy).")
      .def_ro("id", &BundleView::id, "Persistent id.")
      .def_ro("corners", &BundleView::corners, "Corners of each of its faces.")
      .def_ro("height", &BundleView::height, "Layers above the root: its tip face is on this layer.")
      .def_ro("group", &BundleView::group, "Name of its group.")
      .def_prop_ro(
          "vertices", &verticesOf, nb::rv_policy::reference,
          "Vertex ids, (height + 1)×corners uint32: row k is the face on layer k, corner i over corner i.")
      .def("__repr__", [](const BundleView& b) {
        return "<coif.Bundle " + std::to_string(b.id) + ": " + std::to_string(b.corners) +
               " corners, height " + std::to_string(b.height) + ">";
      });
}

void setPositions(Model& model, const ArrayLike& positions) {
  const auto count = int(model.mesh().vertices().size());
  const auto array = toArray<double>(positions, "positions", {count, 3});
  HairMesh next = model.mesh();
  for (int v = 0; v < count; ++v) {
    const Vec3 position = Eigen::Map<const Vec3>(array.data() + 3 * v);
    if (!position.allFinite()) {
      throw ErrorException(makeError(ErrorCode::InvalidArgument, "a position is not finite",
                                     "vertex " + std::to_string(idOf(next, std::uint32_t(v)))));
    }
    next.setPosition(std::uint32_t(v), position);
  }
  model.change("move", std::move(next));
}

std::tuple<nb::ndarray<nb::numpy, std::uint32_t, nb::shape<-1, 4>, nb::c_contig>, Array1<bool>> quadsOf(
    const Model& model) {
  auto* ids = new std::vector<std::uint32_t>;
  nb::capsule owner(ids, [](void* p) noexcept { delete static_cast<std::vector<std::uint32_t>*>(p); });
  std::vector<std::uint8_t> exposed;
  for (const SideQuad& q : sideQuads(model.mesh())) {
    for (const std::uint32_t v : {q.a, q.b, q.c, q.d}) ids->push_back(idOf(model.mesh(), v));
    exposed.push_back(q.exposed);
  }
  return {{ids->data(), {exposed.size(), 4}, owner}, flags(exposed)};
}

/// The root layer: a cage, or faces of the scalp's own mesh.
Model fromScalp(const ScalpModel& scalp, std::optional<std::variant<Cage, ArrayLike>> faces) {
  if (!faces) faces = makeCage(scalp, std::nullopt, {});
  const auto rootOf = [](const auto& mesh, const std::vector<std::uint32_t>& offsets) {
    return Model(take(HairMesh::fromRoot(mesh.positions, offsets, mesh.corners)));
  };
  Model model;
  if (const auto* cage = std::get_if<Cage>(&*faces)) {
    model = rootOf(*cage, cage->faceOffsets);
  } else {
    const PolygonMesh& head = scalp.surface->mesh();
    PolygonMesh root;
    root.positions = head.positions;
    for (const std::uint32_t f : toIndices(std::get<ArrayLike>(*faces), "faces")) {
      if (f >= head.faceCount()) {
        throw ErrorException(
            makeError(ErrorCode::NotFound, "the scalp has no such face", "face " + std::to_string(f)));
      }
      root.addFace(head.face(f));
    }
    model = rootOf(root, root.faceOffsets);
  }
  model.layOn(scalp.surface);
  return model;
}

void bindMaking(nb::class_<Model>& c) {
  c.def_static(
       "from_root",
       [](const ArrayLike& positions, nb::typed<nb::iterable, nb::typed<nb::sequence, int>> faces) {
         const auto points = toPoints(positions, "positions");
         const Faces root = toFaces(faces, "faces");
         return Model(take(HairMesh::fromRoot(points, root.offsets, root.corners)));
       },
       "positions"_a, "faces"_a,
       "The root layer alone, every bundle of height 0: positions V×3 and faces, a sequence of index "
       "sequences or an\n"
       "F×k integer array. Vertices that no face uses are dropped; where faces only touch in a vertex it is "
       "split.\n\n"
       "Raises Error for edges of three or more faces, inconsistent winding, indices out of range or values "
       "not finite.")
      .def_static("from_scalp", &fromScalp, "scalp"_a, "faces"_a.none() = nb::none(),
                  "The root layer on a head: a Cage, faces of the head's own mesh by index, or (None) a cage "
                  "of about 200 quads\n"
                  "on the hair-bearing part. The mesh remembers the head: grow() lays roots on it.\n\n"
                  "Raises Error for faces that do not exist or do not make a root layer.")

      .def(
          "copy", [](const Model& model) { return Model(model); }, "A copy with a history of its own.")
      .def("__copy__", [](const Model& model) { return Model(model); })
      .def(
          "__deepcopy__", [](const Model& model, nb::handle) { return Model(model); }, "memo"_a)
      .def(
          "__eq__", [](const Model& a, const Model& b) { return a.mesh() == b.mesh(); }, nb::is_operator());
}

void bindReading(nb::class_<Model>& c) {
  c.def_prop_ro(
       "vertex_count", [](const Model& m) { return m.mesh().vertices().size(); }, "Number of vertices, V.")
      .def_prop_ro(
          "bundle_count", [](const Model& m) { return m.mesh().bundles().size(); }, "Number of bundles, B.")
      .def_prop_ro(
          "layer_count", [](const Model& m) { return m.mesh().layerCount(); },
          "1 + the height of the tallest bundle; 0 when empty.")
      .def_prop_rw(
          "positions",
          [](const Model& m) {
            std::vector<Vec3> p;
            for (const HairVertex& v : m.mesh().vertices()) p.push_back(v.position);
            return own3(std::move(p));
          },
          &setPositions, nb::rv_policy::reference,
          "Positions, V×3 float64, in the order of vertex_ids. A copy: assign the whole array to move "
          "vertices (one\n"
          "step of the history).")
      .def_prop_ro(
          "vertex_ids",
          [](const Model& m) { return perVertex(m, [](auto& v) { return std::uint32_t(v.id); }); },
          nb::rv_policy::reference, "Persistent vertex ids, V uint32, ascending. A copy.")
      .def_prop_ro(
          "layers", [](const Model& m) { return perVertex(m, [](auto& v) { return v.layer; }); },
          nb::rv_policy::reference, "Layer of each vertex, V uint32; 0 is the root. A copy.")
      .def_prop_ro(
          "parents",
          [](const Model& m) {
            return perVertex(m, [&](auto& v) -> std::int64_t {
              return v.parent == kNone ? -1 : std::int64_t(idOf(m.mesh(), v.parent));
            });
          },
          nb::rv_policy::reference,
          "Id of each vertex's parent, one layer down, V int64; -1 on layer 0. A copy.")
      .def_prop_ro(
          "pinned",
          [](const Model& m) {
            std::vector<std::uint8_t> values;
            for (const HairVertex& v : m.mesh().vertices()) values.push_back(v.pinned);
            return flags(values);
          },
          nb::rv_policy::reference, "Which vertices the artist has pinned, V bool. A copy; see set_pinned.")
      .def_prop_ro(
          "external", [](const Model& m) { return flags(externalVertices(m.mesh())); },
          nb::rv_policy::reference,
          "Which vertices the artist places (root, tip, boundary, exposed or pinned), V bool; place() moves "
          "the others.")
      .def_prop_ro(
          "bundle_ids",
          [](const Model& m) {
            std::vector<std::uint32_t> ids;
            for (const Bundle& b : m.mesh().bundles()) ids.push_back(std::uint32_t(b.id));
            return own1(std::move(ids));
          },
          nb::rv_policy::reference, "Persistent bundle ids, B uint32, ascending. A copy.")
      .def(
          "bundle",
          [](const Model& m, std::uint32_t id) {
            return viewOf(m.mesh(), m.mesh().bundles()[m.bundleIndex(id)]);
          },
          "id"_a, "The bundle of that id. Raises Error when there is none.")
      .def_prop_ro(
          "bundles",
          [](const Model& m) {
            std::vector<BundleView> all;
            for (const Bundle& b : m.mesh().bundles()) all.push_back(viewOf(m.mesh(), b));
            return all;
          },
          "All bundles, in the order of bundle_ids.")
      .def_prop_ro(
          "group_names",
          [](const Model& m) {
            return std::vector<std::string>(m.mesh().groupNames().begin(), m.mesh().groupNames().end());
          },
          "Names of the groups.")
      .def(
          "indices", [](const Model& m, const ArrayLike& ids) { return own1(m.vertexIndices(ids, "ids")); },
          "ids"_a,
          "Rows of the per-vertex arrays for vertex ids. Raises Error for an id that does not exist.")
      .def("side_quads", &quadsOf,
           "Every side quad once: vertex ids Q×4 (a→b below, c over a, d over b) and Q bool, whether it is "
           "exposed.")
      .def(
          "faults",
          [](const Model& m) {
            std::vector<std::string> texts;
            for (const InvariantFault& f : checkInvariants(m.mesh())) {
              texts.push_back(f.name + ": " + f.element + ": " + f.message);
            }
            return texts;
          },
          "Broken invariants, a sentence each; empty for a sound mesh.")
      .def("__repr__", [](const Model& m) {
        return "<coif.HairMesh: " + std::to_string(m.mesh().bundles().size()) + " bundles, " +
               std::to_string(m.mesh().vertices().size()) + " vertices, " +
               std::to_string(m.mesh().layerCount()) + " layers>";
      });
}

void bindHistory(nb::class_<Model>& c) {
  c.def(
       "undo",
       [](Model& m) {
         std::string label = m.history().undoLabel();
         m.undo();
         return label;
       },
       "Takes the last step back, exactly, and returns its name. Raises Error when there is none.\n\n"
       "Every operation, place() and every assignment to positions is a step; their number has no limit.")
      .def(
          "redo",
          [](Model& m) {
            std::string label = m.history().redoLabel();
            m.redo();
            return label;
          },
          "Does the last step taken back again, exactly, and returns its name. Raises Error when there is "
          "none.")
      .def_prop_ro(
          "undo_count", [](const Model& m) { return m.history().undoCount(); },
          "Steps that undo() can take back.")
      .def_prop_ro(
          "redo_count", [](const Model& m) { return m.history().redoCount(); },
          "Steps that redo() can do again.");
}

}  // namespace

void bindHairMesh(nb::module_& m) {
  bindBundle(m);
  bindCreated(m);
  nb::class_<Model> c(
      m, "HairMesh",
      "The hair mesh: layers of polygons over a root layer, one column of faces (a bundle) a root face.\n\n"
      "Vertices and bundles have persistent ids, plain integers here. A face is (bundle, layer), an edge\n"
      "(bundle, layer, side): side i runs from corner i to corner i + 1. Every operation keeps every\n"
      "invariant, or raises Error with the reason and changes nothing; all can be undone. Source: Yuksel,\n"
      "Schaefer, Keyser, \"Hair Meshes\", 2009.");
  bindMaking(c);
  bindReading(c);
  bindOperations(c);
  bindEdit(m, c);
  bindHistory(c);
}

}  // namespace coif::python
