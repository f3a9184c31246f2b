// Geometric editing as methods of coif.HairMesh: selections by id, moves with soft falloff, mirror symmetry.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bind_hairmesh.h"
#include "coif/hairmesh/edit.h"

namespace coif::python {

using namespace nb::literals;

namespace {

using Model = HairMeshModel;
using PyEdge = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

EdgeRef edgeRef(const PyEdge& e) {
  return {BundleId{std::get<0>(e)}, std::get<1>(e), std::get<2>(e)};
}
PyEdge pyEdge(const EdgeRef& e) {
  return {std::uint32_t(e.bundle), e.layer, e.side};
}

Array1<std::uint32_t> vertexIds(const Model& model, std::vector<std::uint32_t> indices) {
  for (auto& v : indices) v = std::uint32_t(model.mesh().vertices()[v].id);
  return own1(std::move(indices));
}
Array1<std::uint32_t> bundleIds(const Model& model, std::vector<std::uint32_t> indices) {
  for (auto& b : indices) b = std::uint32_t(model.mesh().bundles()[b].id);
  return own1(std::move(indices));
}

/// Weights from ids and a falloff radius, or from an array of one weight a vertex; neither: 1 everywhere.
VertexWeights weightsOf(const Model& model, const std::optional<ArrayLike>& vertices, double radius,
                        const std::optional<ArrayLike>& weights) {
  const std::size_t count = model.mesh().vertices().size();
  if (vertices && weights) throw nb::value_error("give vertices or weights, not both");
  if (weights) {
    const auto array = toArray<double>(*weights, "weights", {int(count)});
    return VertexWeights(array.data(), array.data() + count);
  }
  if (!vertices) return VertexWeights(count, 1.0);
  return take(softSelection(model.mesh(), model.vertexIndices(*vertices, "vertices"), radius));
}

Vec3 pivotOf(const Model& model, const std::optional<ArrayLike>& pivot, const VertexWeights& weights) {
  if (pivot) return toVec3(*pivot, "pivot");
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    sum += weights[v] * model.mesh().position(std::uint32_t(v));
    total += weights[v];
  }
  return total > 0 ? Vec3(sum / total) : Vec3(Vec3::Zero());
}

void bindSelections(nb::class_<Model>& c) {
  c.def(
       "layer_vertices",
       [](const Model& m, std::uint32_t layer) { return vertexIds(m, verticesOfLayer(m.mesh(), layer)); },
       "layer"_a, "Ids of the vertices of a layer, uint32, ascending.\n\nEmpty above the tips.")
      .def(
          "bundle_vertices",
          [](const Model& m, std::uint32_t bundle, std::optional<std::uint32_t> layer) {
            return vertexIds(m, take(verticesOfBundle(m.mesh(), BundleId{bundle}, layer.value_or(kNone))));
          },
          "bundle"_a, "layer"_a.none() = nb::none(),
          "Ids of the vertices of a bundle, on one layer or (None) on all.\n\nRaises Error for a bundle that "
          "does not exist.")
      .def(
          "column",
          [](const Model& m, std::uint32_t vertex) {
            const std::uint32_t index = m.vertexIndices(ArrayLike{nb::make_tuple(vertex)}, "vertex").front();
            return vertexIds(m, take(columnOf(m.mesh(), index)));
          },
          "vertex"_a,
          "Ids of a vertex, its ancestors down to the root and all its descendants.\n\nRaises Error for an "
          "id that does not exist.")
      .def(
          "connected_bundles",
          [](const Model& m, std::uint32_t bundle, std::uint32_t layer) {
            return bundleIds(m, take(connectedBundles(m.mesh(), BundleId{bundle}, layer)));
          },
          "bundle"_a, "layer"_a = 0,
          "Ids of the bundles that shared edges connect to a bundle on a layer.\n\nRaises Error for a bundle "
          "that does not exist.")
      .def(
          "quad_strip",
          [](const Model& m, const PyEdge& side) {
            return bundleIds(m, take(quadStrip(m.mesh(), edgeRef(side))));
          },
          "edge"_a,
          "Ids of the bundles in a strip of root quads, from a side (bundle, 0, side) across opposite sides "
          "both ways.\n\n"
          "Raises Error for a side that does not exist.")
      .def(
          "soft_selection",
          [](const Model& m, const ArrayLike& vertices, double radius) {
            return own1(weightsOf(m, vertices, radius, std::nullopt));
          },
          "vertices"_a, "radius"_a = 0.0,
          "One weight a vertex, V float64: 1 on `vertices` (ids), falling smoothly to 0 at `radius` from the "
          "nearest.");
}

void bindMoves(nb::class_<Model>& c) {
  c.def(
       "translate",
       [](Model& m, const ArrayLike& by, std::optional<ArrayLike> vertices, double radius,
          std::optional<ArrayLike> weights) {
         const auto w = weightsOf(m, vertices, radius, weights);
         const Vec3 shift = toVec3(by, "by");
         m.applyStatus("translate", [&](HairMesh& mesh) { return translate(mesh, w, shift); });
       },
       "by"_a, "vertices"_a.none() = nb::none(), nb::kw_only(), "radius"_a = 0.0,
       "weights"_a.none() = nb::none(),
       "Moves `vertices` (ids; None: all) by a vector. radius: soft falloff around them, scene units. "
       "weights: one in\n"
       "[0, 1] a vertex, instead of vertices and radius. Raises Error for values not finite.")
      .def(
          "scale",
          [](Model& m, const ArrayLike& factors, std::optional<ArrayLike> vertices,
             std::optional<ArrayLike> pivot, double radius, std::optional<ArrayLike> weights) {
            const auto w = weightsOf(m, vertices, radius, weights);
            const Vec3 by = toVec3(factors, "factors"), about = pivotOf(m, pivot, w);
            m.applyStatus("scale", [&](HairMesh& mesh) { return scale(mesh, w, about, by); });
          },
          "factors"_a, "vertices"_a.none() = nb::none(), nb::kw_only(), "pivot"_a.none() = nb::none(),
          "radius"_a = 0.0, "weights"_a.none() = nb::none(),
          "Scales `vertices` (ids; None: all) by three factors about `pivot` (None: their weighted mean).\n\n"
          "radius and weights as in translate. Raises Error for values not finite.")
      .def(
          "rotate",
          [](Model& m, const ArrayLike& axis, double angle, std::optional<ArrayLike> vertices,
             std::optional<ArrayLike> pivot, double radius, std::optional<ArrayLike> weights) {
            const auto w = weightsOf(m, vertices, radius, weights);
            const Vec3 line = toVec3(axis, "axis"), about = pivotOf(m, pivot, w);
            m.applyStatus("rotate", [&](HairMesh& mesh) { return rotate(mesh, w, about, line, angle); });
          },
          "axis"_a, "angle"_a, "vertices"_a.none() = nb::none(), nb::kw_only(), "pivot"_a.none() = nb::none(),
          "radius"_a = 0.0, "weights"_a.none() = nb::none(),
          "Turns `vertices` (ids; None: all) by weight times `angle` (radians, right-handed) about `axis` "
          "through `pivot`\n"
          "(None: their weighted mean). radius and weights as in translate. Raises Error for an axis of no "
          "length.")
      .def(
          "smooth",
          [](Model& m, double strength, int steps, std::optional<ArrayLike> vertices, double radius,
             std::optional<ArrayLike> weights) {
            const auto w = weightsOf(m, vertices, radius, weights);
            m.applyStatus("smooth", [&](HairMesh& mesh) { return smooth(mesh, w, strength, steps); });
          },
          "strength"_a = 0.5, "steps"_a = 1, "vertices"_a.none() = nb::none(), nb::kw_only(),
          "radius"_a = 0.0, "weights"_a.none() = nb::none(),
          "Moves each vertex `strength` times its weight towards the mean of its neighbours in its layer, "
          "`steps` times.\n\n"
          "vertices, radius and weights as in translate. Raises Error for a strength outside [0, 1].");
}

void bindFlags(nb::class_<Model>& c) {
  c.def(
       "set_pinned",
       [](Model& m, const ArrayLike& vertices, bool pinned) {
         HairMesh next = m.mesh();
         for (const std::uint32_t v : m.vertexIndices(vertices, "vertices")) next.setPinned(v, pinned);
         m.change("pin", std::move(next));
       },
       "vertices"_a, "pinned"_a = true,
       "Pins vertices (ids), so that place() leaves them where they are, or frees them.\n\n"
       "Raises Error for an id that does not exist.")
      .def(
          "set_group",
          [](Model& m, const ArrayLike& bundles, const std::string& name) {
            HairMesh next = m.mesh();
            const std::uint32_t group = next.addGroup(name);
            for (const std::uint32_t id : toIndices(bundles, "bundles"))
              next.setGroup(m.bundleIndex(id), group);
            m.change("group", std::move(next));
          },
          "bundles"_a, "name"_a,
          "Puts bundles (ids) into the group of that name, made if it is new.\n\nRaises Error for an id that "
          "does not exist.");
}

void bindMirror(nb::module_& m, nb::class_<Model>& c) {
  nb::class_<Mirror>(
      m, "Mirror", "Which elements of a hair mesh are each other's image; valid until its topology changes.")
      .def_prop_ro("complete", &Mirror::complete, "Whether every vertex and bundle has a partner.")
      .def_prop_ro(
          "point", [](const Mirror& mirror) { return own(mirror.point); }, nb::rv_policy::reference,
          "A point of the plane.")
      .def_prop_ro(
          "normal", [](const Mirror& mirror) { return own(mirror.normal); }, nb::rv_policy::reference,
          "Its unit normal.");
  c.def(
       "find_mirror",
       [](const Model& model, const ArrayLike& point, const ArrayLike& normal, double tolerance) {
         return take(findMirror(model.mesh(), toVec3(point, "point"), toVec3(normal, "normal"), tolerance));
       },
       "point"_a, "normal"_a, "tolerance"_a,
       "Partners across a plane: on the root layer by position within `tolerance`, above by topology. A "
       "Mirror.\n\n"
       "Raises Error for a normal of no length or a tolerance not above 0.")
      .def(
          "with_mirrored",
          [](const Model& model, const Mirror& mirror, const std::vector<std::uint32_t>& bundles) {
            std::vector<BundleId> ids;
            for (const std::uint32_t id : bundles) ids.push_back(BundleId{id});
            std::vector<std::uint32_t> out;
            for (const BundleId id : take(withMirrored(model.mesh(), mirror, ids)))
              out.push_back(std::uint32_t(id));
            return own1(std::move(out));
          },
          "mirror"_a, "bundles"_a,
          "Bundles (ids) and their mirror images, each once.\n\nRaises Error for a bundle without a partner.")
      .def(
          "mirrored_edge",
          [](const Model& model, const Mirror& mirror, const PyEdge& edge) {
            return pyEdge(take(mirrored(model.mesh(), mirror, edgeRef(edge))));
          },
          "mirror"_a, "edge"_a, "The same edge on the other side.\n\nRaises Error when it has no partner.")
      .def(
          "move_symmetrically",
          [](Model& model, const Mirror& mirror, const ArrayLike& displacements) {
            const auto by = toPoints(displacements, "displacements");
            model.applyStatus("move symmetrically",
                              [&](HairMesh& mesh) { return moveSymmetrically(mesh, mirror, by); });
          },
          "mirror"_a, "displacements"_a,
          "Moves vertices by V×3 displacements and their partners by the mirrored ones; the plane's own stay "
          "on it.\n\n"
          "Raises Error for values not finite.")
      .def(
          "symmetrise",
          [](Model& model, const Mirror& mirror) {
            return model.apply("symmetrise", [&](HairMesh& mesh) { return symmetrise(mesh, mirror); });
          },
          "mirror"_a,
          "Puts every vertex behind the plane at its partner's image. Returns the number of those without a "
          "partner.\n\n"
          "They are left alone.");
}

}  // namespace

void bindEdit(nb::module_& m, nb::class_<Model>& c) {
  bindSelections(c);
  bindMoves(c);
  bindFlags(c);
  bindMirror(m, c);
}

}  // namespace coif::python
