// The strands room: StrandSet with its arrays as views, grow(), mean value coordinates, Catmull–Rom.
#include "bind_strands.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bind.h"
#include "bind_hairmesh.h"
#include "coif/io/strand_io.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/mean_value.h"

namespace coif::python {

using namespace nb::literals;

namespace {

using Self = nb::handle_t<Strands>;

StrandSet& setOf(nb::handle self) {
  return nb::inst_ptr<Strands>(self)->set;
}

/// A property of an optional array: a writable view, or None where the set has none. Assigning copies values
/// in; assigning None drops them. The vector's memory never moves once it is there, so earlier views stay
/// valid.
template <class T, class Class>
void optionalArray(Class& c, const char* name, std::vector<T> StrandSet::*member, bool perPoint,
                   const char* doc) {
  c.def_prop_rw(
      name,
      [member](Self self) -> std::optional<Array1<T>> {
        auto& values = setOf(self).*member;
        if (values.empty()) return std::nullopt;
        return view1<T>(self, values.data(), values.size());
      },
      [member, perPoint, name](Self self, std::optional<ArrayLike> value) {
        StrandSet& set = setOf(self);
        auto& values = set.*member;
        if (!value) return values.clear();
        const int wanted = int(perPoint ? set.pointCount() : set.strandCount());
        using Wide = std::conditional_t<std::is_floating_point_v<T>, T, std::uint64_t>;
        const auto array = toArray<Wide>(*value, name, {wanted});
        values.assign(array.data(), array.data() + wanted);
      },
      nb::rv_policy::reference, nb::for_setter(nb::arg("value").none()), doc);
}

template <class V, int kColumns, class Class>
void optionalRows(Class& c, const char* name, std::vector<V> StrandSet::*member, bool perPoint,
                  const char* doc) {
  using View = nb::ndarray<nb::numpy, float, nb::shape<-1, kColumns>, nb::c_contig>;
  c.def_prop_rw(
      name,
      [member](Self self) -> std::optional<View> {
        auto& values = setOf(self).*member;
        if (values.empty()) return std::nullopt;
        return View(values.front().data(), {values.size(), std::size_t(kColumns)}, self);
      },
      [member, perPoint, name](Self self, std::optional<ArrayLike> value) {
        StrandSet& set = setOf(self);
        auto& values = set.*member;
        if (!value) return values.clear();
        const std::size_t wanted = perPoint ? set.pointCount() : set.strandCount();
        const auto array = toArray<float>(*value, name, {int(wanted), kColumns});
        values.resize(wanted);
        for (std::size_t i = 0; i < wanted; ++i) values[i] = Eigen::Map<const V>(array.data() + kColumns * i);
      },
      nb::rv_policy::reference, nb::for_setter(nb::arg("value").none()), doc);
}

StrandSet makeStrands(const ArrayLike& points, const std::optional<ArrayLike>& offsets) {
  StrandSet set;
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object shape = numpy.attr("shape")(points.object);
  if (!offsets) {
    if (nb::len(shape) != 3) {
      throw nb::value_error(
          "points: without offsets, expected an array of shape (S, N, 3): S strands of N points");
    }
    const auto array = toArray<float>(points, "points", {-1, -1, 3});
    const std::size_t strands = array.shape(0), each = array.shape(1);
    for (std::size_t s = 1; s <= strands; ++s) set.offsets.push_back(s * each);
    set.points.resize(strands * each);
    std::copy_n(array.data(), array.size(), reinterpret_cast<float*>(set.points.data()));
  } else {
    const auto array = toArray<float>(points, "points", {-1, 3});
    set.points.resize(array.shape(0));
    std::copy_n(array.data(), array.size(), reinterpret_cast<float*>(set.points.data()));
    const auto bounds = toArray<std::uint64_t>(*offsets, "offsets", {-1});
    set.offsets.assign(bounds.data(), bounds.data() + bounds.size());
    if (set.offsets.empty()) throw nb::value_error("offsets: expected S + 1 numbers, at least one");
  }
  take(validate(set, false));
  return set;
}

Array3<float> strandView(Self self, std::int64_t index) {
  StrandSet& set = setOf(self);
  const auto count = std::int64_t(set.strandCount());
  if (index < 0) index += count;
  if (index < 0 || index >= count) throw nb::index_error("strand index out of range");
  const auto strand = set.strand(std::size_t(index));
  return view3<float>(self, const_cast<float*>(strand.empty() ? nullptr : strand.front().data()),
                      strand.size());
}

void bindStrandSet(nb::module_& m) {
  nb::class_<Strands> c(
      m, "StrandSet",
      "S strands of P points in all; strand s has points[offsets[s]:offsets[s + 1]], root first.\n\n"
      "Arrays are views of the same bytes that the files and the GPU get: nothing is copied, and an\n"
      "array keeps its StrandSet alive. Positions and widths are in scene units, float32.");
  c.def(
       "__init__",
       [](Strands* self, const ArrayLike& points, std::optional<ArrayLike> offsets) {
         new (self) Strands{makeStrands(points, offsets), {}};
       },
       "points"_a, "offsets"_a.none() = nb::none(),
       "From points P×3 and offsets (S + 1, ascending, from 0 to P), or from points S×N×3 alone. Copies.\n\n"
       "Raises ValueError for wrong shapes, Error for offsets that do not ascend or do not end at P.")
      .def("__len__", [](const Strands& s) { return s.set.strandCount(); })
      .def("__getitem__", &strandView, "index"_a, "The points of one strand: a writable N×3 view.")
      .def_prop_ro(
          "points",
          [](Self self) {
            auto& p = setOf(self).points;
            return view3<float>(self, p.empty() ? nullptr : p.front().data(), p.size());
          },
          nb::rv_policy::reference, "Points, P×3 float32: a writable view.")
      .def_prop_ro(
          "offsets",
          [](Self self) {
            auto& o = setOf(self).offsets;
            return view1<const std::uint64_t>(self, o.data(), o.size());
          },
          nb::rv_policy::reference, "S + 1 offsets into points, uint64: a read-only view.");
  optionalArray<float>(c, "widths", &StrandSet::widths, true,
                       "Diameter at each point, P float32, or None. Assignable.");
  optionalArray<std::uint64_t>(c, "ids", &StrandSet::ids, false,
                               "Stable id of each strand, S uint64, or None. Assignable.");
  optionalArray<std::uint32_t>(c, "root_faces", &StrandSet::rootFaces, false,
                               "Id of the bundle each strand grows in, S uint32, or None. Assignable.");
  optionalArray<std::uint8_t>(c, "guides", &StrandSet::guides, false,
                              "1 for a guide, S uint8, or None. Assignable.");
  optionalArray<float>(c, "transparencies", &StrandSet::transparencies, true,
                       "Transparency at each point, 0 opaque, P float32, or None. Assignable.");
  optionalArray<std::uint32_t>(c, "groups", &StrandSet::groups, false,
                               "Index into group_names of each strand, S uint32, or None. Assignable.");
  optionalRows<Vec2f, 2>(c, "root_uvs", &StrandSet::rootUvs, false,
                         "UV of each root on the head, S×2 float32, or None. Assignable.");
  optionalRows<Vec3f, 3>(c, "colors", &StrandSet::colors, true,
                         "Linear RGB at each point, P×3 float32, or None. Assignable.");
  c.def_prop_rw(
       "group_names", [](const Strands& s) { return s.set.groupNames; },
       [](Strands& s, std::vector<std::string> names) { s.set.groupNames = std::move(names); },
       "Names of the groups that `groups` refers to.")
      .def_prop_rw(
          "meters_per_unit", [](const Strands& s) { return s.set.metersPerUnit; },
          [](Strands& s, double value) { s.set.metersPerUnit = value; }, "Metres a scene unit.")
      .def_prop_rw(
          "up_axis", [](const Strands& s) { return s.set.upAxis; },
          [](Strands& s, UpAxis axis) { s.set.upAxis = axis; }, "Which axis points up.")
      .def_prop_rw(
          "information", [](const Strands& s) { return s.set.information; },
          [](Strands& s, std::string text) { s.set.information = std::move(text); },
          "Free text that some formats carry (.hair: 87 bytes at most).")
      .def_prop_ro(
          "strand_count", [](const Strands& s) { return s.set.strandCount(); }, "Number of strands, S.")
      .def_prop_ro(
          "point_count", [](const Strands& s) { return s.set.pointCount(); }, "Number of points, P.")
      .def_prop_ro(
          "nbytes", [](const Strands& s) { return s.set.bytes(); }, "Bytes of all arrays.")
      .def_prop_ro(
          "report", [](const Strands& s) { return s.report; },
          "What grow() said of these strands, a GrowReport; None for strands from elsewhere.")
      .def(
          "validate", [](const Strands& s) { take(validate(s.set)); },
          "Raises Error naming the strand if a number is not finite or an array does not fit.")
      .def("__repr__", [](const Strands& s) {
        return "<coif.StrandSet: " + std::to_string(s.set.strandCount()) + " strands, " +
               std::to_string(s.set.pointCount()) + " points>";
      });

  c.def_static(
      "load",
      [](const std::filesystem::path& path) {
        return Strands{Run(0, nb::none())([&](const Context&) { return loadStrands(path); }), {}};
      },
      "path"_a,
      "Reads .hair, .usda and .usdc curves, and the strands of a .glb or .gltf that Coif wrote.\n\n"
      "Raises Error naming the file and the byte or line; MissingFileError when there is no such file.");
  c.def(
      "save",
      [](const Strands& strands, const std::filesystem::path& path, const HairMeshModel* hairMesh,
         const PolygonMesh* head, StrandMesh mesh, std::size_t meshStrandLimit, const ArrayLike& color,
         std::optional<ArrayLike> frames, double framesPerSecond, int threads, nb::object progress) {
        StrandExport what;
        what.strands = &strands.set;
        what.hairMesh = hairMesh ? &hairMesh->mesh() : nullptr;
        what.head = head;
        what.mesh = mesh;
        what.meshStrandLimit = meshStrandLimit;
        what.color = toVec3(color, "color").cast<float>();
        what.timeCodesPerSecond = framesPerSecond;
        std::optional<InputArray<float>> motion;
        if (frames) {
          const std::size_t points = strands.set.pointCount();
          motion = toArray<float>(*frames, "frames", {-1, int(points), 3});
          for (std::size_t f = 0; f < motion->shape(0); ++f) {
            const auto* rows = reinterpret_cast<const Vec3f*>(motion->data()) + f * points;
            what.frames.push_back({double(f), std::span(rows, points)});
          }
        }
        return Run(threads, std::move(progress))(
            [&](const Context& context) { return saveStrands(what, path, context); });
      },
      "path"_a, nb::kw_only(), "hair_mesh"_a.none() = nb::none(), "head"_a.none() = nb::none(),
      "mesh"_a = StrandMesh::Cards, "mesh_strand_limit"_a = StrandExport{}.meshStrandLimit,
      "color"_a = nb::make_tuple(0.09, 0.05, 0.03), "frames"_a.none() = nb::none(),
      "frames_per_second"_a = 24.0, "threads"_a = 0, "progress"_a.none() = nb::none(),
      "Writes .usda, .usdc, .glb, .gltf or .hair, by the extension; the old file stays whole until the new "
      "one is.\n\n"
      "hair_mesh, head: written beside the strands (USD, glTF). mesh: the fall-back that glTF viewers show, "
      "made of at\n"
      "most mesh_strand_limit strands. color: linear RGB where the strands have none. frames: F×P×3, points "
      "over time\n"
      "(USD). Returns a WriteReport whose notes say what the format could not hold. The interpreter lock is "
      "released:\n"
      "do not assign arrays meanwhile. Raises Error for an unknown extension or a file that cannot be "
      "written.");
}

void bindReports(nb::module_& m) {
  nb::enum_<Knots>(m, "Knots", "Spacing of the spline's knots.")
      .value("UNIFORM", Knots::Uniform, "the paper's: linear in the hair mesh's vertices")
      .value("CENTRIPETAL", Knots::Centripetal, "square roots of chord lengths, shared per bundle")
      .value("CHORDAL", Knots::Chordal, "chord lengths, shared per bundle");
  nb::enum_<StrandMesh>(m, "StrandMesh", "How glTF shows strands in viewers that draw no lines well.")
      .value("NONE", StrandMesh::None, "lines only")
      .value("CARDS", StrandMesh::Cards, "ribbons with UVs")
      .value("TUBES", StrandMesh::Tubes, "tubes");
  nb::class_<WriteReport>(m, "WriteReport", "What a file writer did.")
      .def_ro("bytes", &WriteReport::bytes, "Size of the file.")
      .def_ro("notes", &WriteReport::notes, "What the format could not hold, a sentence each.")
      .def("__repr__",
           [](const WriteReport& r) { return "<coif.WriteReport: " + std::to_string(r.bytes) + " bytes>"; });
  nb::class_<GrowReport>(m, "GrowReport", "What grow() met on the way.")
      .def_ro("negative_weights", &GrowReport::negativeWeights,
              "Strands with a negative coordinate (concave faces).")
      .def_ro("triangulated_faces", &GrowReport::triangulatedFaces,
              "Root faces whose projection crosses itself.")
      .def_ro("barren_bundles", &GrowReport::barrenBundles, "Bundles without area or height: no strands.")
      .def_ro("zero_length", &GrowReport::zeroLength, "Strands left out because all their points coincide.")
      .def_ro("max_root_lift", &GrowReport::maxRootLift, "Greatest distance from cage to head, scene units.")
      .def_ro("error", &GrowReport::error, "Chord error of the sampling against the converged spline.")
      .def_ro("seconds", &GrowReport::seconds, "Wall-clock seconds.")
      .def("__repr__", [](const GrowReport& r) {
        return "<coif.GrowReport: " + std::to_string(r.seconds) + " s, " + std::to_string(r.barrenBundles) +
               " barren bundles>";
      });
}

Strands growStrands(const HairMeshModel& model, std::size_t count, std::uint32_t points, std::uint64_t seed,
                    std::optional<double> tolerance, Knots knots, double width, double tipWidth,
                    std::optional<double> metersPerUnit, std::optional<UpAxis> upAxis, const Surface* head,
                    bool useHead, std::optional<ArrayLike> density, int threads, nb::object progress) {
  const HairMesh mesh = model.mesh();  // grown apart, so that other threads may edit the mesh meanwhile
  const std::shared_ptr<const Surface> ownHead = model.head;
  GrowOptions options;
  options.count = count;
  options.points = points;
  options.seed = seed;
  options.tolerance = tolerance;
  options.knots = knots;
  options.width = width;
  options.tipWidth = tipWidth;
  options.metersPerUnit = metersPerUnit.value_or(model.metersPerUnit);
  options.upAxis = upAxis.value_or(model.upAxis);
  if (useHead) options.head = head ? head : ownHead.get();
  std::optional<InputArray<double>> weights;
  if (density) {
    weights = toArray<double>(*density, "density", {int(mesh.bundles().size())});
    options.density = std::span(weights->data(), weights->size());
  }
  GrowResult grown =
      Run(threads, std::move(progress))([&](const Context& c) { return grow(mesh, options, c); });
  return Strands{std::move(grown.strands), std::move(grown.report)};
}

void bindGrow(nb::module_& m) {
  const GrowOptions defaults;
  m.def(
      "grow", &growStrands, "mesh"_a, "count"_a = defaults.count, "points"_a = defaults.points,
      "seed"_a = defaults.seed, nb::kw_only(), "tolerance"_a.none() = nb::none(), "knots"_a = defaults.knots,
      "width"_a = defaults.width, "tip_width"_a = defaults.tipWidth, "meters_per_unit"_a.none() = nb::none(),
      "up_axis"_a.none() = nb::none(), "head"_a.none() = nb::none(), "use_head"_a = true,
      "density"_a.none() = nb::none(), "threads"_a = 0, "progress"_a.none() = nb::none(),
      "Grows `count` strands of `points` points each in the bundles of a HairMesh (Yuksel et al. 2009, "
      "section 3.1).\n\n"
      "Roots are progressive blue noise: every prefix of the strands is itself evenly spread, and ids are "
      "stable.\n"
      "The same arguments give the same bytes, whatever `threads` is (0: all cores).\n"
      "tolerance: a bound on the chord error in scene units; then the number of points is chosen by strand.\n"
      "width: root diameter in scene units (0: 0.08 mm); tip_width: the tip's, as a fraction of it.\n"
      "head: a Surface that roots are laid on; None: the scalp that the mesh was made from, unless use_head "
      "is False.\n"
      "density: one weight >= 0 a bundle, in the order of mesh.bundle_ids. meters_per_unit, up_axis: None: "
      "the mesh's.\n"
      "The interpreter lock is released. Raises ArgumentError for numbers out of range, Error when no bundle "
      "can\n"
      "carry a strand.");
}

Array1<double> meanValues(const ArrayLike& polygon, const ArrayLike& point) {
  const nb::object shape = nb::module_::import_("numpy").attr("shape")(polygon.object);
  const bool planar = nb::len(shape) == 2 && nb::cast<int>(shape[1]) == 2;
  const auto corners = toArray<double>(polygon, "polygon", {-1, planar ? 2 : 3});
  const auto at = toArray<double>(point, "point", {planar ? 2 : 3});
  const std::size_t n = corners.shape(0);
  if (n < 3) throw nb::value_error("polygon: expected at least 3 corners");
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!std::isfinite(corners.data()[i])) throw nb::value_error("polygon: a coordinate is not finite");
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!std::isfinite(at.data()[i])) throw nb::value_error("point: a coordinate is not finite");
  }
  std::vector<double> weights(n);
  const auto solve = [&]<class V>(V) {
    std::vector<V> vertices(n);
    for (std::size_t i = 0; i < n; ++i)
      vertices[i] = Eigen::Map<const V>(corners.data() + V::SizeAtCompileTime * i);
    const V x = Eigen::Map<const V>(at.data());
    if (meanValueCoordinates(vertices, x, weights) == MeanValueCase::Degenerate) {
      throw ErrorException(makeError(ErrorCode::Degenerate, "the polygon has no area, so no weights exist"));
    }
  };
  planar ? solve(Vec2()) : solve(Vec3());
  return own1(std::move(weights));
}

Array3<double> catmullRomSamples(const ArrayLike& points, std::size_t samples, Knots knots) {
  const std::vector<Vec3> control = toPoints(points, "points");
  if (control.size() < 2) throw nb::value_error("points: expected at least 2 control points");
  if (samples < 2) throw nb::value_error("samples: expected at least 2");
  return own3(catmullRom(control, samples, knots));
}

}  // namespace

void bindStrands(nb::module_& m) {
  bindReports(m);
  bindStrandSet(m);
  bindGrow(m);
  m.def("mean_value_coordinates", &meanValues, "polygon"_a, "point"_a,
        "Mean value coordinates of `point` in `polygon` (N×2 or N×3, either direction, may be concave): N "
        "float64.\n\n"
        "They sum to 1 and reproduce the point: weights @ polygon == point. A polygon in space is first laid "
        "down in\n"
        "its Newell plane. Concave polygons may give negative weights. Accurate to 1e-13 also near edges and "
        "corners.\n"
        "Raises ValueError for fewer than 3 corners, wrong shapes or values not finite; Error for a polygon "
        "without\n"
        "area. Source: Floater 2003, equation 2.1.");
  m.def("catmull_rom", &catmullRomSamples, "points"_a, "samples"_a, "knots"_a = Knots::Uniform,
        "The C¹ Catmull–Rom spline through `points` (K×3, K >= 2) at `samples` >= 2 equal parameter steps "
        "from the\n"
        "first point to the last, both included exactly: samples×3 float64.\n\n"
        "Ends are pinned: the phantom points are 2·P0 − P1 and 2·Pn − P(n−1); two points give a straight "
        "line.");
}

}  // namespace coif::python
