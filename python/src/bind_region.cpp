// The scalp room: what is odd about a mesh, where hair may grow, the coarse cage on it; and the Scalp class
// that takes a head through all of it.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bind_scalp.h"
#include "coif/io/mesh_io.h"
#include "coif/scalp/example_head.h"
#include "coif/scalp/mesh_report.h"
#include "coif/scalp/weld.h"

namespace coif::python {

using namespace nb::literals;

namespace {

void bindMeshReport(nb::module_& m) {
  nb::enum_<MeshFault>(m, "MeshFault", "What can be odd about a mesh.")
      .value("NON_FINITE_POSITION", MeshFault::NonFinitePosition, "a coordinate is not finite")
      .value("BAD_FACE", MeshFault::BadFace, "a corner out of range, or fewer than three corners")
      .value("REPEATED_CORNER", MeshFault::RepeatedCorner, "a face names a vertex twice")
      .value("ZERO_AREA_FACE", MeshFault::ZeroAreaFace, "a face without area")
      .value("UNREFERENCED_VERTEX", MeshFault::UnreferencedVertex, "a vertex without a face")
      .value("COINCIDENT_VERTICES", MeshFault::CoincidentVertices, "vertices at exactly one position")
      .value("NON_MANIFOLD_EDGE", MeshFault::NonManifoldEdge, "an edge of three or more faces")
      .value("NON_MANIFOLD_VERTEX", MeshFault::NonManifoldVertex,
             "a vertex whose faces form more than one fan")
      .value("INCONSISTENT_WINDING", MeshFault::InconsistentWinding,
             "an edge that two faces run the same way")
      .value("INSIDE_OUT_SHELL", MeshFault::InsideOutShell, "a closed shell of negative volume")
      .value("OPEN_SHELL", MeshFault::OpenShell, "a shell with a boundary")
      .value("SEVERAL_SHELLS", MeshFault::SeveralShells, "more than one connected set of faces");
  nb::class_<MeshFinding>(m, "MeshFinding", "One kind of oddity of a mesh: how often, and where.")
      .def_ro("fault", &MeshFinding::fault, "The kind.")
      .def_ro("count", &MeshFinding::count, "How many.")
      .def_prop_ro(
          "elements", [](const MeshFinding& f) { return own1(std::vector<std::uint32_t>(f.elements)); },
          nb::rv_policy::reference, "Vertices, faces or shells, uint32; for edges two vertices each.")
      .def_ro("text", &MeshFinding::text, "One sentence.")
      .def("__repr__", [](const MeshFinding& f) { return "<coif.MeshFinding: " + f.text + ">"; });
  nb::class_<Shell>(m, "Shell", "A set of faces connected by shared vertices.")
      .def_ro("face_count", &Shell::faceCount, "Number of faces.")
      .def_ro("vertex_count", &Shell::vertexCount, "Number of vertices.")
      .def_ro("boundary_loops", &Shell::boundaryLoops, "Number of boundary loops.")
      .def_ro("closed", &Shell::closed, "Whether it has no boundary edge.")
      .def_ro("manifold", &Shell::manifold, "Whether it has no non-manifold element and one winding.")
      .def_ro("genus", &Shell::genus, "Genus; -1 where it is not defined.")
      .def_ro("area", &Shell::area, "Area, mesh units squared.")
      .def_ro("volume", &Shell::volume, "Signed volume of a closed shell.");
  nb::class_<MeshReport>(m, "MeshReport",
                         "What is odd about a mesh: found, counted and named, never repaired.")
      .def_ro("shells", &MeshReport::shells, "The shells.")
      .def_ro("findings", &MeshReport::findings, "The findings, only kinds that were found.")
      .def_prop_ro(
          "face_shell", [](const MeshReport& r) { return own1(std::vector<std::uint32_t>(r.faceShell)); },
          nb::rv_policy::reference, "Shell of each face, uint32; 4294967295 for bad faces.")
      .def("__str__", &MeshReport::text)
      .def("__repr__", [](const MeshReport& r) {
        return "<coif.MeshReport: " + std::to_string(r.shells.size()) + " shells, " +
               std::to_string(r.findings.size()) + " findings>";
      });
  m.def("inspect", &inspect, "mesh"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Looks for everything that later stages stumble over; takes any mesh and repairs nothing.");
  m.def(
      "weld",
      [](const PolygonMesh& mesh, double tolerance) {
        return Run(0, nb::none())([&](const Context&) { return weld(mesh, {tolerance}); }).mesh;
      },
      "mesh"_a, "tolerance"_a = 0.0,
      "Joins vertices within `tolerance` (mesh units; 0: equal positions only) of the one of lowest index: a "
      "new mesh.\n\n"
      "Corners keep their UVs. Raises Error for a tolerance that is negative or not finite.");
}

void bindFrame(nb::module_& m) {
  nb::class_<HeadFrame>(m, "HeadFrame",
                        "Where is up, front and the crown of a head. Right-handed, mesh units.")
      .def_prop_ro(
          "centre", [](const HeadFrame& f) { return own(f.centre); }, nb::rv_policy::reference,
          "Centre of the skull, 3 float64.")
      .def_prop_ro(
          "up", [](const HeadFrame& f) { return own(f.up); }, nb::rv_policy::reference, "Unit vector up.")
      .def_prop_ro(
          "forward", [](const HeadFrame& f) { return own(f.forward); }, nb::rv_policy::reference,
          "Unit vector out of the face.")
      .def_prop_ro(
          "right", [](const HeadFrame& f) { return own(f.right); }, nb::rv_policy::reference,
          "Unit vector to the head's own right.")
      .def_ro("height", &HeadFrame::height, "Chin to crown.")
      .def_ro("depth", &HeadFrame::depth, "Brow to back of the head.")
      .def_ro("half_width", &HeadFrame::halfWidth, "Half the width of the skull above the ears.")
      .def_ro("face_found", &HeadFrame::faceFound,
              "Whether the profile shows a face; else forward is a convention.")
      .def_ro("ears_found", &HeadFrame::earsFound, "Whether ears were found.")
      .def_ro("notes", &HeadFrame::notes, "What was not found and assumed, a sentence each.");
}

void bindRegion(nb::module_& m) {
  nb::class_<Region>(m, "Region", "The faces of a mesh that may carry hair. Combine with & | and -.")
      .def_prop_ro(
          "faces", [](const Region& r) { return own1(r.list()); }, nb::rv_policy::reference,
          "Faces inside, uint32, ascending. A copy.")
      .def_prop_ro("count", &Region::count, "Number of faces inside.")
      .def_ro("frame", &Region::frame,
              "The head's frame, where the automatic cap made the region; else None.")
      .def_ro("notes", &Region::notes, "What was assumed, a sentence each.")
      .def(
          "__and__", [](const Region& a, const Region& b) { return take(intersection(a, b)); },
          nb::is_operator())
      .def(
          "__or__", [](const Region& a, const Region& b) { return take(unionOf(a, b)); }, nb::is_operator())
      .def(
          "__sub__", [](const Region& a, const Region& b) { return take(difference(a, b)); },
          nb::is_operator())
      .def("__repr__",
           [](const Region& r) { return "<coif.Region: " + std::to_string(r.count()) + " faces>"; });
}

struct RegionChoice {
  std::optional<std::vector<std::string>> groups;
  std::optional<ArrayLike> faces;
  std::optional<std::tuple<ArrayLike, double>> sphere, disc;
  std::optional<std::tuple<ArrayLike, ArrayLike>> halfSpace;
  std::optional<std::uint32_t> shell;
};

Result<Region> chosenRegion(const Surface& surface, const RegionChoice& choice) {
  const PolygonMesh& mesh = surface.mesh();
  if (choice.groups) return regionOfGroups(mesh, *choice.groups);
  if (choice.faces) return regionOfFaces(mesh, toIndices(*choice.faces, "faces"));
  if (choice.sphere) {
    return regionOfSphere(mesh, toVec3(std::get<0>(*choice.sphere), "sphere"), std::get<1>(*choice.sphere));
  }
  if (choice.disc) {
    return regionOfGeodesicDisc(surface, toVec3(std::get<0>(*choice.disc), "disc"),
                                std::get<1>(*choice.disc));
  }
  if (choice.halfSpace) {
    return regionOfHalfSpace(mesh, toVec3(std::get<0>(*choice.halfSpace), "half_space"),
                             toVec3(std::get<1>(*choice.halfSpace), "half_space"));
  }
  return regionOfShell(mesh, choice.shell);
}

Region regionOf(const ScalpModel& scalp, std::optional<std::vector<std::string>> groups,
                std::optional<ArrayLike> faces, std::optional<std::tuple<ArrayLike, double>> sphere,
                std::optional<std::tuple<ArrayLike, double>> disc,
                std::optional<std::tuple<ArrayLike, ArrayLike>> halfSpace, std::optional<std::uint32_t> shell,
                const CapOptions& cap) {
  const int given = groups.has_value() + faces.has_value() + sphere.has_value() + disc.has_value() +
                    halfSpace.has_value() + shell.has_value();
  if (given > 1)
    throw nb::value_error("region: give one of groups, faces, sphere, disc, half_space and shell");
  if (given == 1) {
    return take(chosenRegion(*scalp.surface, {std::move(groups), std::move(faces), std::move(sphere),
                                              std::move(disc), std::move(halfSpace), shell}));
  }
  return Run(0, nb::none())([&](const Context&) { return automaticCap(*scalp.surface, cap); });
}

std::optional<Vec3> optionalVec3(const std::optional<ArrayLike>& value, const char* argument) {
  if (!value) return std::nullopt;
  return toVec3(*value, argument);
}

ScalpModel loadScalp(const std::filesystem::path& path) {
  return Run(0, nb::none())([&](const Context&) -> Result<ScalpModel> {
    COIF_ASSIGN(PolygonMesh mesh, loadPolygonMesh(path));
    if (const Status status = validate(mesh); !status.ok()) return inFile(status.error(), path.string());
    return ScalpModel{std::make_shared<const Surface>(mesh), path};
  });
}

void bindScalpClass(nb::module_& m) {
  nb::class_<ScalpModel>(
      m, "Scalp",
      "A head, ready to carry hair: its mesh, what is odd about it, where hair grows, a coarse cage.")
      .def(
          "__init__",
          [](ScalpModel* self, const PolygonMesh& mesh) {
            take(validate(mesh));
            new (self) ScalpModel{std::make_shared<const Surface>(mesh), {}};
          },
          "mesh"_a, "From a mesh, which is copied. Raises Error if a face or a position is not usable.")
      .def_static("load", &loadScalp, "path"_a,
                  "Reads a head from an OBJ, PLY, OFF, STL, GLB, glTF or USD text file.\n\n"
                  "Raises Error naming the file and the line, byte or element.")
      .def_prop_ro(
          "mesh", [](const ScalpModel& s) { return s.surface->mesh(); },
          "The head's mesh, as it was given. A copy.")
      .def_prop_ro(
          "surface",
          [](const ScalpModel& s) {
            return std::const_pointer_cast<Surface>(s.surface);
          },  // it has no setters
          "Distance and nearest-point queries on the head.")
      .def_ro("path", &ScalpModel::path, "The file it was loaded from; '' for none.")
      .def(
          "report", [](const ScalpModel& s) { return inspect(s.surface->mesh()); },
          nb::call_guard<nb::gil_scoped_release>(),
          "What is odd about the mesh, a MeshReport. Nothing is repaired.")
      .def(
          "frame",
          [](const ScalpModel& s, std::optional<ArrayLike> up, std::optional<ArrayLike> forward) {
            CapOptions cap;
            cap.head = {optionalVec3(up, "up"), optionalVec3(forward, "forward"), {}};
            return *Run(0, nb::none())([&](const Context&) { return automaticCap(*s.surface, cap); }).frame;
          },
          nb::kw_only(), "up"_a.none() = nb::none(), "forward"_a.none() = nb::none(),
          "Where is up, front and the crown: a HeadFrame. up, forward (3 floats): where they are not to be "
          "found.")
      .def(
          "region",
          [](const ScalpModel& s, std::optional<std::vector<std::string>> groups,
             std::optional<ArrayLike> faces, std::optional<std::tuple<ArrayLike, double>> sphere,
             std::optional<std::tuple<ArrayLike, double>> disc,
             std::optional<std::tuple<ArrayLike, ArrayLike>> halfSpace, std::optional<std::uint32_t> shell,
             std::optional<ArrayLike> up, std::optional<ArrayLike> forward, double foreheadLine,
             double napeLine, double earClearance) {
            CapOptions cap;
            cap.head = {optionalVec3(up, "up"), optionalVec3(forward, "forward"), {}};
            cap.foreheadLine = foreheadLine;
            cap.napeLine = napeLine;
            cap.earClearanceRad = earClearance;
            return regionOf(s, std::move(groups), std::move(faces), std::move(sphere), std::move(disc),
                            std::move(halfSpace), shell, cap);
          },
          nb::kw_only(), "groups"_a.none() = nb::none(), "faces"_a.none() = nb::none(),
          "sphere"_a.none() = nb::none(), "disc"_a.none() = nb::none(), "half_space"_a.none() = nb::none(),
          "shell"_a.none() = nb::none(), "up"_a.none() = nb::none(), "forward"_a.none() = nb::none(),
          "forehead_line"_a = CapOptions{}.foreheadLine, "nape_line"_a = CapOptions{}.napeLine,
          "ear_clearance"_a = CapOptions{}.earClearanceRad,
          "Where hair may grow: a Region. Without a choice, the hair-bearing part of a head, found by "
          "itself.\n\n"
          "groups: names of groups or materials. faces: indices. sphere: (centre, radius). disc: (seed, "
          "radius along the\n"
          "surface). half_space: (point, normal). shell: index in report().shells. One of them at most.\n"
          "up, forward, forehead_line and nape_line (heights, of chin to crown) and ear_clearance (radians) "
          "steer the\n"
          "automatic one. Raises Error for unknown names, faces out of range or an empty region.")
      .def(
          "cage",
          [](const ScalpModel& s, int count, const std::optional<Region>& region, bool exact, bool mirror,
             int smoothing) {
            CageOptions options;
            options.count = count;
            options.exact = exact;
            options.useMirror = mirror;
            options.smoothing = smoothing;
            return makeCage(s, region, options);
          },
          "count"_a = CageOptions{}.count, "region"_a.none() = nb::none(), nb::kw_only(), "exact"_a = false,
          "mirror"_a = true, "smoothing"_a = CageOptions{}.smoothing,
          "A coarse Cage of about `count` quads on `region` (None: the hair-bearing part, found by "
          "itself).\n\n"
          "exact: the region's own polygons instead of a grid. mirror: symmetric where the head is. "
          "smoothing: rounds\n"
          "at most. Raises Error for a region that is empty, closed, a ring or has a handle, saying what to "
          "do.")
      .def("__repr__", [](const ScalpModel& s) {
        return "<coif.Scalp: " + std::to_string(s.surface->mesh().faceCount()) + " faces" +
               (s.path.empty() ? "" : " from " + s.path.string()) + ">";
      });
  m.def("example_head", &makeExampleHead, "resolution"_a = 48,
        "A stylised head to try things on: quads, symmetric, y up, facing +z, in centimetres; a "
        "PolygonMesh.\n\n"
        "Groups 'scalp' (where hair grows), 'face' and 'base'. resolution: quads around half the head, 16 to "
        "256.");
}

}  // namespace

void bindRegions(nb::module_& m) {
  bindMeshReport(m);
  bindFrame(m);
  bindRegion(m);
  bindCage(m);
  bindScalpClass(m);
}

}  // namespace coif::python
