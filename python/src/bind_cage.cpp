// The scalp room: the coarse cage of quads that a hair mesh stands on.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bind_scalp.h"

namespace coif::python {

using namespace nb::literals;

Cage makeCage(const ScalpModel& scalp, const std::optional<Region>& region, const CageOptions& options) {
  return Run(0, nb::none())([&](const Context& context) -> Result<Cage> {
    if (region) return buildCage(scalp.surface->mesh(), *scalp.surface, *region, options, context);
    COIF_ASSIGN(const Region cap, automaticCap(*scalp.surface));
    return buildCage(scalp.surface->mesh(), *scalp.surface, cap, options, context);
  });
}

namespace {

using Self = nb::handle_t<Cage>;

const Cage& cageOf(nb::handle self) {
  return *nb::inst_ptr<Cage>(self);
}

nb::list facesOf(const Cage& cage) {
  nb::list faces;
  for (std::size_t f = 0; f < cage.faceCount(); ++f) {
    nb::list face;
    for (std::uint32_t c = cage.faceOffsets[f]; c < cage.faceOffsets[f + 1]; ++c)
      face.append(cage.corners[c]);
    faces.append(nb::tuple(face));
  }
  return faces;
}

std::optional<nb::ndarray<nb::numpy, const std::uint32_t, nb::shape<-1, 2>, nb::c_contig>> gridOf(Self self) {
  const Cage& cage = cageOf(self);
  if (cage.grid.empty()) return std::nullopt;
  return nb::ndarray<nb::numpy, const std::uint32_t, nb::shape<-1, 2>, nb::c_contig>(
      cage.grid.front().data(), {cage.grid.size(), 2}, self);
}

void bindQuality(nb::module_& m) {
  nb::class_<CageQuality>(m, "CageQuality", "How even a cage is and how near to the head.")
      .def_ro("min_area_ratio", &CageQuality::minAreaRatio, "Smallest face area, of the mean.")
      .def_ro("max_area_ratio", &CageQuality::maxAreaRatio, "Greatest face area, of the mean.")
      .def_ro("max_aspect", &CageQuality::maxAspect, "Longest over shortest side, of the worst face.")
      .def_ro("flips", &CageQuality::flips, "Faces whose normal points into the head.")
      .def_ro("max_distance", &CageQuality::maxDistance, "Face middle to the head, of the head's height.")
      .def_ro("mirror_error", &CageQuality::mirrorError,
              "Greatest distance from a mirrored partner, of the height.");
}

}  // namespace

void bindCage(nb::module_& m) {
  bindQuality(m);
  nb::class_<Cage>(
      m, "Cage",
      "A coarse cage of quads on the hair-bearing part of a head: the root layer of a hair mesh.\n\n"
      "V vertices on the head's surface, F faces wound outward. A grid of columns×rows faces: column 0 is\n"
      "the head's left side, row 0 its front.")
      .def_prop_ro(
          "positions",
          [](Self self) {
            const auto& p = cageOf(self).positions;
            return view3<const double>(self, p.empty() ? nullptr : p.front().data(), p.size());
          },
          nb::rv_policy::reference, "Vertex positions, V×3 float64: a read-only view.")
      .def_prop_ro("faces", &facesOf, nb::sig("def faces(self) -> list[tuple[int, ...]]"),
                   "The faces as a list of tuples of vertex indices (a copy).")
      .def_prop_ro(
          "uv",
          [](Self self) -> std::optional<Array2<const double>> {
            const auto& uv = cageOf(self).uv;
            if (uv.empty()) return std::nullopt;
            return view2<const double>(self, uv.front().data(), uv.size());
          },
          nb::rv_policy::reference,
          "V×2: u from -1 left to +1 right, v from -1 front to +1 back; a read-only view, or None.")
      .def_prop_ro("grid", &gridOf, nb::rv_policy::reference,
                   "Column and row of each vertex, V×2 uint32; None for the region's own polygons.")
      .def_ro("columns", &Cage::columns, "Faces across; 0 for the region's own polygons.")
      .def_ro("rows", &Cage::rows, "Faces from front to back; 0 for the region's own polygons.")
      .def_prop_ro(
          "partner",
          [](Self self) -> std::optional<Array1<const std::uint32_t>> {
            const auto& p = cageOf(self).partner;
            if (p.empty()) return std::nullopt;
            return view1<const std::uint32_t>(self, p.data(), p.size());
          },
          nb::rv_policy::reference, "Mirrored vertex of each vertex (itself on the mirror plane), or None.")
      .def_ro("frame", &Cage::frame, "The head's frame.")
      .def_ro("quality", &Cage::quality, "How even it is and how near to the head.")
      .def_ro("notes", &Cage::notes, "What was assumed, a sentence each.")
      .def("__len__", &Cage::faceCount)
      .def("__repr__", [](const Cage& c) {
        return "<coif.Cage: " + std::to_string(c.faceCount()) + " faces, " + std::to_string(c.columns) +
               " × " + std::to_string(c.rows) + ">";
      });
}

}  // namespace coif::python
