// The scene room: the .coif document and its lazy evaluation.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <mutex>

#include "bind.h"
#include "bind_hairmesh.h"
#include "bind_scalp.h"
#include "bind_simulate.h"
#include "bind_strands.h"
#include "bind_style.h"
#include "coif/scene/evaluate.h"
#include "coif/scene/hairstyle.h"
#include "coif/scene/scene.h"

namespace coif::python {

using namespace nb::literals;

namespace {

/// A document and the results of its last evaluation. The mutex is taken without the interpreter lock: two
/// threads that evaluate one scene wait for each other.
class SceneModel {
 public:
  explicit SceneModel(Scene s) : scene(std::move(s)) {}

  template <class Use>
  auto use(const EvaluateOptions& options, int threads, nb::object progress, Use&& use) {
    const Scene snapshot = scene;  // another thread may edit the document meanwhile
    return Run(threads, std::move(progress))([&](const Context& context) {
      const std::scoped_lock lock(busy_);
      if (!evaluation_ || !same(options, options_)) evaluation_.emplace(options), options_ = options;
      evaluation_->clearReports();
      auto result = use(*evaluation_, snapshot, context);
      reports_ = evaluation_->reports();
      return result;
    });
  }
  std::vector<StageReport> reports() {
    const nb::gil_scoped_release unlocked;
    const std::scoped_lock lock(busy_);
    return reports_;
  }

  Scene scene;

 private:
  static bool same(const EvaluateOptions& a, const EvaluateOptions& b) {
    return a.useHead == b.useHead && a.force == b.force;
  }
  std::mutex busy_;
  std::optional<Evaluation> evaluation_;
  EvaluateOptions options_;
  std::vector<StageReport> reports_;
};

EvaluateOptions optionsOf(bool useHead, std::set<std::string> force) {
  EvaluateOptions options;
  options.useHead = useHead;
  options.force = std::move(force);
  return options;
}

Strands evaluate(SceneModel& model, bool useHead, std::set<std::string> force, int threads,
                 nb::object progress) {
  return model.use(optionsOf(useHead, std::move(force)), threads, std::move(progress),
                   [](Evaluation& evaluation, const Scene& scene, const Context& context) -> Result<Strands> {
                     const auto strands = evaluation.strands(scene, context);
                     if (!strands.ok()) return strands.error();
                     Strands copy{**strands, {}};
                     if (const GrowReport* report = evaluation.growReport()) copy.report = *report;
                     return copy;
                   });
}

WriteReport exportScene(SceneModel& model, const std::filesystem::path& path, StrandMesh mesh, bool useHead,
                        int threads, nb::object progress) {
  return model.use(optionsOf(useHead, {}), threads, std::move(progress),
                   [&](Evaluation& evaluation, const Scene& scene, const Context& context) {
                     StrandExport what;
                     what.mesh = mesh;
                     return evaluation.exportTo(scene, path, what, context);
                   });
}

HairMeshModel placedMesh(SceneModel& model) {
  HairMesh mesh =
      model.use({}, 0, nb::none(),
                [](Evaluation& evaluation, const Scene& scene, const Context& context) -> Result<HairMesh> {
                  const auto placed = evaluation.placedMesh(scene, context);
                  if (!placed.ok()) return placed.error();
                  return **placed;
                });
  HairMeshModel result(std::move(mesh));
  result.metersPerUnit = model.scene.metersPerUnit;
  result.upAxis = model.scene.upAxis;
  return result;
}

SimulateOptions simulateOptions(std::size_t frames, double fps, const nb::object& poses,
                                const nb::object& roots, const std::optional<std::filesystem::path>& cache) {
  SimulateOptions what;
  what.frames = frames;
  what.framesPerSecond = fps;
  what.motion = toMotion(poses, roots);
  if (cache) what.cache = *cache;
  return what;
}

DynamicsCache simulateScene(SceneModel& model, std::size_t frames, double fps, const nb::object& poses,
                            const nb::object& roots, const std::optional<std::filesystem::path>& cache,
                            bool useHead, int threads, nb::object progress) {
  const SimulateOptions what = simulateOptions(frames, fps, poses, roots, cache);
  return model.use(
      optionsOf(useHead, {}), threads, std::move(progress),
      [&](Evaluation& evaluation, const Scene& scene, const Context& context) -> Result<DynamicsCache> {
        const auto motion = evaluation.simulate(scene, what, context);
        if (!motion.ok()) return motion.error();
        return **motion;
      });
}

WriteReport exportMotion(SceneModel& model, const std::filesystem::path& path, std::size_t frames, double fps,
                         const nb::object& poses, const nb::object& roots, bool useHead, int threads,
                         nb::object progress) {
  const SimulateOptions what = simulateOptions(frames, fps, poses, roots, {});
  return model.use(optionsOf(useHead, {}), threads, std::move(progress),
                   [&](Evaluation& evaluation, const Scene& scene, const Context& context) {
                     return evaluation.exportMotion(scene, what, path, context);
                   });
}

Strands strandsAt(SceneModel& model, const DynamicsCache& motion, std::size_t frame, bool useHead,
                  int threads) {
  return model.use(
      optionsOf(useHead, {}), threads, nb::none(),
      [&](Evaluation& evaluation, const Scene& scene, const Context& context) -> Result<Strands> {
        // The stage loads the head; without it roots would stay on the cage.
        const auto head = evaluation.head(scene, context);
        if (!head.ok()) return head.error();
        auto strands = evaluation.strandsAt(scene, motion, frame, context);
        if (!strands.ok()) return strands.error();
        return Strands{std::move(strands).value(), {}};
      });
}

DrapeReport drapeScene(SceneModel& model, double seconds, double tolerance, bool useHead, int threads) {
  Scene draped = model.scene;
  const DrapeReport report = model.use(optionsOf(useHead, {}), threads, nb::none(),
                                       [&](Evaluation& evaluation, const Scene&, const Context& context) {
                                         return evaluation.drape(draped, {seconds, tolerance}, context);
                                       });
  model.scene = std::move(draped);
  return report;
}

void bindMotion(nb::module_& m) {
  using C = DynamicsCache;
  nb::class_<C>(m, "Motion",
                "Hair in motion: positions of the hair mesh's vertices, or of the points of its wisps' "
                "guides, frame by frame.")
      .def_prop_ro(
          "positions",
          [](nb::object self) {
            C& cache = nb::cast<C&>(self);
            static float none{};
            return nb::ndarray<nb::numpy, const float, nb::shape<-1, -1, 3>, nb::c_contig>(
                cache.positions.empty() ? &none : cache.positions[0].data(),
                {cache.frameCount(), std::size_t(cache.vertexCount), 3}, self);
          },
          "(F, V, 3) 32-bit floats in scene units, a view.")
      .def_prop_ro(
          "head_poses",
          [](const C& cache) {
            std::vector<double> out;
            for (const RigidPose& pose : cache.poses) {
              for (int row = 0; row < 3; ++row) {
                for (int column = 0; column < 3; ++column) out.push_back(pose.rotation(row, column));
                out.push_back(pose.position[row]);
              }
              out.insert(out.end(), {0, 0, 0, 1});
            }
            auto* kept = new std::vector<double>(std::move(out));
            nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
            return nb::ndarray<nb::numpy, double, nb::shape<-1, 4, 4>, nb::c_contig>(
                kept->data(), {kept->size() / 16, 4, 4}, owner);
          },
          nb::rv_policy::reference, "(F, 4, 4) rigid transforms of the head by frame (a copy).")
      .def_ro("fps", &C::framesPerSecond, "Frames a second.")
      .def("__len__", &C::frameCount)
      .def(
          "save", [](const C& cache, const std::filesystem::path& path) { take(saveCache(cache, path)); },
          "path"_a, "Writes a .coifcache; the old one stays whole until the new one is.")
      .def_static(
          "load", [](const std::filesystem::path& path) { return take(loadCache(path)); }, "path"_a,
          "Reads a .coifcache. Raises Error for a file that is cut off, changed or no cache.")
      .def("__repr__", [](const C& cache) {
        return "<coif.Motion: " + std::to_string(cache.frameCount()) + " frames of " +
               std::to_string(cache.vertexCount) + " vertices>";
      });
}

void bindSettings(nb::module_& m) {
  nb::class_<StrandSettings>(m, "StrandSettings", "What a scene asks of grow(), as the .coif file keeps it.")
      .def_rw("count", &StrandSettings::count, "Strands wanted.")
      .def_rw("points", &StrandSettings::points, "Points a strand, >= 2.")
      .def_rw("tolerance", &StrandSettings::tolerance, "> 0: adaptive sampling, chord error in scene units.")
      .def_rw("seed", &StrandSettings::seed, "Seed of the roots.")
      .def_rw("knots", &StrandSettings::knots, "Spacing of the spline's knots.")
      .def_rw("width", &StrandSettings::width, "Root diameter in scene units; 0: 0.08 mm.")
      .def_rw("tip_width", &StrandSettings::tipWidth, "Tip diameter as a fraction of the root's.")
      .def("__repr__", [](const StrandSettings& s) {
        return "<coif.StrandSettings: " + std::to_string(s.count) + " strands of " +
               std::to_string(s.points) + " points>";
      });
}

HairMeshModel styled(const std::string& style, const ScalpModel& scalp, const std::optional<Cage>& cage) {
  const auto names = hairstyleNames();
  if (std::find(names.begin(), names.end(), style) == names.end()) {
    throw ErrorException(
        makeError(ErrorCode::InvalidArgument, "there is no hairstyle named '" + style + "'"));
  }
  CageOptions options;
  options.count = int(suggestedCageCount(style));
  const Cage root = cage ? *cage : makeCage(scalp, std::nullopt, options);
  Hairstyle made = Run(0, nb::none())(
      [&](const Context& context) { return modelHairstyle(style, root, *scalp.surface, context); });
  HairMeshModel model(std::move(made.mesh));
  model.layOn(scalp.surface);
  return model;
}

void bindHairstyles(nb::module_& m) {
  m.def(
      "hairstyle_names",
      [] {
        const auto names = hairstyleNames();
        return std::vector<std::string>(names.begin(), names.end());
      },
      "Names that model_hairstyle() takes.\n\nA list of strings.");
  m.def("model_hairstyle", &styled, "style"_a, "scalp"_a, "cage"_a.none() = nb::none(),
        "A ready hairstyle as a HairMesh on a Scalp, modelled by the library's own operations: a place to "
        "start from.\n\n"
        "style: one of hairstyle_names(). cage: a Cage of the scalp; None: one that suits the style, on the "
        "hair-bearing\n"
        "part. The interpreter lock is released. Raises Error for an unknown style or a cage that cannot "
        "carry it.");
}

}  // namespace

void bindScene(nb::module_& m) {
  bindSettings(m);
  bindHairstyles(m);
  bindMotion(m);
  nb::class_<SceneModel> c(
      m, "Scene",
      "The document: which head, which hair mesh, how strands grow on it. A .coif file.\n\n"
      "evaluate() keeps its results: what has not changed is not computed again, and `reports`\n"
      "says what each stage did and why.");
  c.def(
       "__init__",
       [](SceneModel* self, const HairMeshModel* hairMesh, const std::filesystem::path& head,
          const std::string& name) {
         Scene scene;
         scene.name = name;
         scene.head.path = head;
         if (hairMesh) {
           scene.hairMesh = hairMesh->mesh();
           scene.metersPerUnit = hairMesh->metersPerUnit;
           scene.upAxis = hairMesh->upAxis;
         }
         new (self) SceneModel(std::move(scene));
       },
       "hair_mesh"_a.none() = nb::none(), "head"_a = "", "name"_a = "",
       "A new document. head: path of the head's mesh file, or '' for none.")
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            // Not by value: the model holds a mutex.
            return std::make_unique<SceneModel>(take(loadScene(path)));
          },
          "path"_a, "Reads a .coif file. Raises Error naming the file and the JSON path of what is wrong.")
      .def(
          "save", [](SceneModel& s, const std::filesystem::path& path) { take(saveScene(s.scene, path)); },
          "path"_a,
          "Writes a .coif file; the old one stays whole until the new one is. A relative head path follows "
          "the new place.")
      .def("evaluate", &evaluate, nb::kw_only(), "use_head"_a = true, "force"_a = std::set<std::string>{},
           "threads"_a = 0, "progress"_a.none() = nb::none(),
           "Places the hair mesh, lays roots on the head and grows the strands: a StrandSet of its own, free "
           "to change.\n\n"
           "use_head: False leaves roots on the cage and never reads the head. force: names of stages to run "
           "although\n"
           "nothing changed, or {'all'}. The interpreter lock is released. Raises Error.")
      .def("export", &exportScene, "path"_a, nb::kw_only(), "mesh"_a = StrandMesh::Cards, "use_head"_a = true,
           "threads"_a = 0, "progress"_a.none() = nb::none(),
           "Evaluates, and writes strands, hair mesh and head to a .usda, .usdc, .glb, .gltf or .hair file.")
      .def("placed_mesh", &placedMesh, "The hair mesh with its internal vertices placed (a copy).")
      .def_prop_ro("reports", &SceneModel::reports, "What each stage of the last evaluation did.")
      .def(
          "explain", [](SceneModel& s) { return explainText(s.reports()); },
          "The reports as a table for people.");
  c.def("simulate", &simulateScene, "frames"_a, nb::kw_only(), "fps"_a = 24.0,
        "head_poses"_a.none() = nb::none(), "root_positions"_a.none() = nb::none(), "cache"_a = nb::none(),
        "use_head"_a = true, "threads"_a = 0, "progress"_a.none() = nb::none(),
        "Moves the hair by `dynamics`: a Motion of at least so many frames, the first the modelled style.\n\n"
        "head_poses: (F, 4, 4) rigid transforms of the head by frame; root_positions: (F, R, 3) of the "
        "layer-0\n"
        "vertices instead. cache: a .coifcache that is gone on with, with the same bytes, and kept up to "
        "date.\n"
        "The interpreter lock is released. Raises Error.")
      .def("export_motion", &exportMotion, "path"_a, "frames"_a, nb::kw_only(), "fps"_a = 24.0,
           "head_poses"_a.none() = nb::none(), "root_positions"_a.none() = nb::none(), "use_head"_a = true,
           "threads"_a = 0, "progress"_a.none() = nb::none(),
           "Simulates as simulate() does, and writes every frame: strands and head as time samples of a "
           ".usda, "
           ".usdc or,\n"
           "where this build has Alembic, .abc file. Returns a WriteReport. Raises Error.")
      .def("strands_at", &strandsAt, "motion"_a, "frame"_a, nb::kw_only(), "use_head"_a = true,
           "threads"_a = 0,
           "The strands on a frame of a Motion of this scene: the same strands on every frame.")
      .def("drape", &drapeScene, nb::kw_only(), "seconds"_a = 10.0, "tolerance"_a = 1e-4, "use_head"_a = true,
           "threads"_a = 0,
           "Lets the hair mesh hang under gravity until it rests and keeps the shape. Returns a DrapeReport.")
      .def_prop_rw(
          "dynamics", [](SceneModel& s) -> DynamicsSettings& { return s.scene.dynamics; },
          [](SceneModel& s, const DynamicsSettings& settings) { s.scene.dynamics = settings; },
          nb::rv_policy::reference_internal, "How hair moves; change its fields.");
  c.def_prop_rw(
       "hair_mesh",
       [](const SceneModel& s) {
         HairMeshModel model(s.scene.hairMesh);
         model.metersPerUnit = s.scene.metersPerUnit;
         model.upAxis = s.scene.upAxis;
         return model;
       },
       [](SceneModel& s, const HairMeshModel& mesh) { s.scene.hairMesh = mesh.mesh(); },
       "The hair mesh. A copy: assign it back after a change.")
      .def_prop_ro(
          "strands", [](SceneModel& s) -> StrandSettings& { return s.scene.strands; },
          nb::rv_policy::reference_internal, "How strands grow; change its fields.")
      .def_prop_rw(
          "styles", [](const SceneModel& s) { return fromStyles(s.scene.styles); },
          [](SceneModel& s, const nb::object& styles) { s.scene.styles = toStyles(styles); },
          "What is done to the strands, in order: a list of dicts with kind, name, enabled, amount, seed, "
          "group,\nparameters (dict), ramp (list of (x, y)), smooth and mask (root vertex id → 0 … 1). A "
          "copy: "
          "assign it back\nafter a change. In what is assigned only 'kind' is needed; style_kinds() lists "
          "them.")
      .def_prop_rw(
          "name", [](const SceneModel& s) { return s.scene.name; },
          [](SceneModel& s, std::string name) { s.scene.name = std::move(name); }, "Name of the hairstyle.")
      .def_prop_rw(
          "head", [](const SceneModel& s) { return s.scene.head.path; },
          [](SceneModel& s, const std::filesystem::path& path) {
            s.scene.head.path = path;
            s.scene.head.contentHash = 0;
          },
          "Path of the head's mesh file; a relative one is relative to the .coif file.")
      .def_prop_rw(
          "meters_per_unit", [](const SceneModel& s) { return s.scene.metersPerUnit; },
          [](SceneModel& s, double value) { s.scene.metersPerUnit = value; }, "Metres a scene unit.")
      .def_prop_rw(
          "up_axis", [](const SceneModel& s) { return s.scene.upAxis; },
          [](SceneModel& s, UpAxis axis) { s.scene.upAxis = axis; }, "Which axis points up.")
      .def_prop_rw(
          "azimuth", [](const SceneModel& s) { return s.scene.look.azimuthDeg; },
          [](SceneModel& s, double degrees) { s.scene.look.azimuthDeg = degrees; },
          "Where `coif render` looks from, degrees around the head; 0: at the face.")
      .def_prop_rw(
          "elevation", [](const SceneModel& s) { return s.scene.look.elevationDeg; },
          [](SceneModel& s, double degrees) { s.scene.look.elevationDeg = degrees; },
          "Where `coif render` looks from, degrees above the horizon.")
      .def_prop_rw(
          "hair_color", [](const SceneModel& s) { return own(s.scene.look.hairColor.cast<double>()); },
          [](SceneModel& s, const ArrayLike& color) {
            s.scene.look.hairColor = toVec3(color, "hair_color").cast<float>();
          },
          nb::rv_policy::reference, "Linear RGB of the hair, 3 floats.")
      .def_prop_ro(
          "file", [](const SceneModel& s) { return s.scene.file; },
          "Where it was loaded from or saved to; '' for a new one.")
      .def("__repr__", [](const SceneModel& s) {
        return "<coif.Scene '" + s.scene.name + "': " + std::to_string(s.scene.hairMesh.bundles().size()) +
               " bundles>";
      });
}

}  // namespace coif::python
