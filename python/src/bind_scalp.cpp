// The scalp room: polygon meshes, queries on them, and the Scalp that Python scripts start from.
#include "bind_scalp.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <limits>

#include "coif/base/parallel.h"
#include "coif/io/mesh_io.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/scalp/surface.h"

namespace coif::python {

using namespace nb::literals;

namespace {

using Self = nb::handle_t<PolygonMesh>;

PolygonMesh& meshOf(nb::handle self) {
  return *nb::inst_ptr<PolygonMesh>(self);
}

PolygonMesh makeMesh(const ArrayLike& positions, nb::handle faces) {
  PolygonMesh mesh;
  mesh.positions = toPoints(positions, "positions");
  Faces indices = toFaces(faces, "faces");
  mesh.faceOffsets = std::move(indices.offsets);
  mesh.corners = std::move(indices.corners);
  take(validate(mesh));
  return mesh;
}

nb::list facesOf(const PolygonMesh& mesh) {
  nb::list faces;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    nb::list face;
    for (const std::uint32_t corner : mesh.face(f)) face.append(corner);
    faces.append(nb::tuple(face));
  }
  return faces;
}

void bindPolygonMesh(nb::module_& m) {
  nb::class_<PolygonMesh>(
      m, "PolygonMesh",
      "A polygon mesh as it came from a file: quads and n-gons kept, nothing repaired.\n\n"
      "V vertices, F faces of any size >= 3, counter-clockwise seen from outside, right-handed,\n"
      "lengths in the file's own unit.")
      .def(
          "__init__",
          [](PolygonMesh* self, const ArrayLike& positions,
             nb::typed<nb::iterable, nb::typed<nb::sequence, int>> faces) {
            new (self) PolygonMesh(makeMesh(positions, faces));
          },
          "positions"_a, "faces"_a,
          "From positions (V×3 floats) and faces: a sequence of index sequences, or an F×k integer array.\n\n"
          "Raises Error for an index out of range, a face of fewer than three corners or a position not "
          "finite.")
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            return Run(0, nb::none())([&](const Context&) { return loadPolygonMesh(path); });
          },
          "path"_a,
          "Reads every polygon of an OBJ, PLY, OFF, STL, GLB, glTF or USD text file, in the scene's own "
          "coordinates.\n\n"
          "Raises Error naming the file and the line or byte.")
      .def(
          "save",
          [](const PolygonMesh& mesh, const std::filesystem::path& path) {
            take(savePolygonMesh(mesh, path));
          },
          "path"_a, "Writes OBJ (quads, n-gons, groups, UVs); the old file stays whole until the new one is.")
      .def_prop_ro(
          "positions",
          [](Self self) {
            auto& p = meshOf(self).positions;
            return view3<double>(self, p.empty() ? nullptr : p.front().data(), p.size());
          },
          nb::rv_policy::reference, "Vertex positions, V×3 float64: a writable view, no copy.")
      .def_prop_ro(
          "face_offsets",
          [](Self self) {
            auto& o = meshOf(self).faceOffsets;
            return view1<const std::uint32_t>(self, o.data(), o.size());
          },
          nb::rv_policy::reference,
          "F + 1 offsets into corners: face f has corners[face_offsets[f]:face_offsets[f + 1]]. Read-only "
          "view.")
      .def_prop_ro(
          "corners",
          [](Self self) {
            auto& c = meshOf(self).corners;
            return view1<const std::uint32_t>(self, c.data(), c.size());
          },
          nb::rv_policy::reference, "Vertex index of every face corner. Read-only view.")
      .def_prop_ro(
          "uvs",
          [](Self self) -> std::optional<Array2<const double>> {
            auto& uv = meshOf(self).cornerUvs;
            if (uv.empty()) return std::nullopt;
            return view2<const double>(self, uv.front().data(), uv.size());
          },
          nb::rv_policy::reference,
          "UV of every face corner, C×2 float64, read-only view; None when the file has none.")
      .def_prop_ro("faces", &facesOf, nb::sig("def faces(self) -> list[tuple[int, ...]]"),
                   "The faces as a list of tuples of vertex indices (a copy).")
      .def_prop_ro("vertex_count", &PolygonMesh::vertexCount, "Number of vertices, V.")
      .def_prop_ro("face_count", &PolygonMesh::faceCount, "Number of faces, F.")
      .def_ro("group_names", &PolygonMesh::groupNames, "Groups and materials by name, as the file has them.")
      .def_prop_ro(
          "face_groups",
          [](Self self) -> std::optional<Array1<const std::uint32_t>> {
            auto& g = meshOf(self).faceGroups;
            if (g.empty()) return std::nullopt;
            return view1<const std::uint32_t>(self, g.data(), g.size());
          },
          nb::rv_policy::reference,
          "Index into group_names of every face, read-only view; None when the file has no groups.")
      .def_rw("meters_per_unit", &PolygonMesh::metersPerUnit, "Metres a unit; 0: the file does not say.")
      .def_rw("up_axis", &PolygonMesh::upAxis, "Which axis points up.")
      .def_ro("notes", &PolygonMesh::notes, "What the reader left out or had to assume, a sentence each.")
      .def_prop_ro(
          "bounds",
          [](const PolygonMesh& mesh) {
            const Box box = bounds(mesh.positions);
            return std::tuple(own(box.lo), own(box.hi));
          },
          nb::rv_policy::reference, "Lowest and highest corner of the bounding box, two arrays of 3.")
      .def(
          "validate", [](const PolygonMesh& mesh) { take(validate(mesh)); },
          "Raises Error naming the element if a position is not finite or a face is not usable.")
      .def("__repr__", [](const PolygonMesh& mesh) {
        return "<coif.PolygonMesh: " + std::to_string(mesh.vertexCount()) + " vertices, " +
               std::to_string(mesh.faceCount()) + " faces>";
      });
}

template <class Query>
Array1<double> mapPoints(const ArrayLike& points, Query&& query) {
  const std::vector<Vec3> p = toPoints(points, "points");
  std::vector<double> out(p.size());
  {
    const nb::gil_scoped_release unlocked;
    query(p, out);
  }
  return own1(std::move(out));
}

std::tuple<Array3<double>, Array3<double>, Array1<double>> project(const Surface& s,
                                                                   const ArrayLike& points) {
  const std::vector<Vec3> p = toPoints(points, "points");
  std::vector<Vec3> feet(p.size()), normals(p.size());
  std::vector<double> distances(p.size());
  {
    const nb::gil_scoped_release unlocked;
    parallelFor(Context{}, p.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const SurfacePoint foot = s.nearest(p[i]);
        feet[i] = foot.position;
        normals[i] = foot.normal;
        distances[i] = s.windingNumber(p[i]) > 0.5 ? -foot.distance : foot.distance;
      }
    });
  }
  return {own3(std::move(feet)), own3(std::move(normals)), own1(std::move(distances))};
}

void bindSurface(nb::module_& m) {
  nb::class_<SurfacePoint>(m, "SurfacePoint",
                           "A point on a surface: where, on which face, and how far from the query.")
      .def_prop_ro(
          "position", [](const SurfacePoint& p) { return own(p.position); }, nb::rv_policy::reference,
          "Position, 3 float64.")
      .def_prop_ro(
          "normal", [](const SurfacePoint& p) { return own(p.normal); }, nb::rv_policy::reference,
          "Unit normal, interpolated from area-weighted vertex normals.")
      .def_ro("face", &SurfacePoint::face, "Face of the mesh.")
      .def_ro("distance", &SurfacePoint::distance, "Unsigned distance to the query, mesh units.")
      .def("__repr__", [](const SurfacePoint& p) {
        return "<coif.SurfacePoint: face " + std::to_string(p.face) + ", distance " +
               std::to_string(p.distance) + ">";
      });

  nb::class_<Surface>(
      m, "Surface",
      "Distance, inside/outside and nearest-point queries on a mesh. Keeps its own copy of the mesh.")
      .def(
          "__init__",
          [](Surface* self, const PolygonMesh& mesh) {
            take(validate(mesh));
            const nb::gil_scoped_release unlocked;
            new (self) Surface(mesh);
          },
          "mesh"_a, "Triangulates the mesh and builds the search structure.")
      .def(
          "nearest",
          [](const Surface& s, const ArrayLike& point) { return s.nearest(toVec3(point, "point")); },
          "point"_a, "The surface point nearest to `point` (3 floats).")
      .def("project", &project, "points"_a,
           "The surface points nearest to each of `points` (N×3): positions N×3, unit normals N×3 and signed "
           "distances N\n"
           "(negative inside), all float64. Threaded, lock released.")
      .def(
          "intersect",
          [](const Surface& s, const ArrayLike& origin, const ArrayLike& direction,
             double maxT) -> std::optional<SurfacePoint> {
            SurfacePoint hit;
            if (!s.intersect(toVec3(origin, "origin"), toVec3(direction, "direction"), maxT, hit))
              return std::nullopt;
            return hit;
          },
          "origin"_a, "direction"_a, "max_t"_a = std::numeric_limits<double>::infinity(),
          "First hit of the ray origin + t·direction with 0 < t <= max_t, or None.")
      .def(
          "signed_distance",
          [](const Surface& s, const ArrayLike& points) {
            return mapPoints(points, [&](const std::vector<Vec3>& p, std::vector<double>& out) {
              parallelFor(Context{}, p.size(), 256, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) out[i] = s.signedDistance(p[i]);
              });
            });
          },
          "points"_a,
          "Distance of each of `points` (N×3), negative inside: N float64. Threaded, lock released.")
      .def(
          "winding_number",
          [](const Surface& s, const ArrayLike& points) {
            return mapPoints(points, [&](const std::vector<Vec3>& p, std::vector<double>& out) {
              s.windingNumbers(Context{}, p, out);
            });
          },
          "points"_a,
          "Generalised winding number of each of `points` (N×3): about 1 inside, 0 outside (Jacobson et al. "
          "2013).")
      .def_prop_ro(
          "mesh", [](const Surface& s) { return s.mesh(); }, "The mesh, as it was given. A copy.")
      .def_prop_ro("size", &Surface::size, "Diagonal of the bounding box.")
      .def("__repr__", [](const Surface& s) {
        return "<coif.Surface: " + std::to_string(s.mesh().faceCount()) + " faces, size " +
               std::to_string(s.size()) + ">";
      });
}

}  // namespace

void bindScalp(nb::module_& m) {
  bindPolygonMesh(m);
  bindSurface(m);
  bindRegions(m);
}

}  // namespace coif::python
