// The stage "simulate": frames from memory, from a cache file, or computed; what is made of them.
#include <algorithm>
#include <bit>

#include "coif/base/random.h"
#include "scene/dynamics_json.h"
#include "scene/evaluation_impl.h"

namespace coif {

namespace {

constexpr double kCheckpointSeconds = 5;
constexpr std::size_t kMaxFrames = 1000000;

std::uint64_t hashPoint(std::uint64_t hash, const Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) hash = hashCombine(hash, std::bit_cast<std::uint64_t>(point[axis]));
  return hash;
}

std::uint64_t motionKey(const Scene& scene, const SimulateOptions& what, std::uint64_t mesh,
                        std::uint64_t head) {
  std::uint64_t hash = hashCombine(mesh, head);
  for (const char c : coif::scene::dynamicsJson(scene.dynamics).dump())
    hash = hashCombine(hash, std::uint8_t(c));
  hash = hashCombine(hash, std::bit_cast<std::uint64_t>(scene.metersPerUnit));
  hash = hashCombine(hash, std::uint64_t(scene.upAxis));
  hash = hashCombine(hash, std::bit_cast<std::uint64_t>(what.framesPerSecond));
  for (const RigidPose& pose : what.motion.poses) {
    hash = hashPoint(hash, pose.position);
    for (int column = 0; column < 3; ++column) hash = hashPoint(hash, pose.rotation.col(column));
  }
  for (const auto& roots : what.motion.roots)
    for (const Vec3& p : roots) hash = hashPoint(hash, p);
  return hash;
}

void keepFrame(const Simulation& simulation, DynamicsCache& cache) {
  cache.poses.push_back(simulation.pose());
  for (const Vec3& p : simulation.positions()) cache.positions.push_back(p.cast<float>());
}

/// The cache file, when it is there and of this simulation; an empty cache when it is not there.
Result<DynamicsCache> earlier(const SimulateOptions& what, std::uint64_t key) {
  std::error_code unknown;
  if (what.cache.empty() || !std::filesystem::exists(what.cache, unknown)) return DynamicsCache{};
  COIF_ASSIGN(DynamicsCache cache, loadCache(what.cache));
  if (cache.key == key) return cache;
  return makeError(ErrorCode::InvalidArgument,
                   "this cache is of another scene, motion or frame rate; give another name or remove it", "",
                   what.cache.string());
}

void noteSimulation(const SimulationReport& done, StageReport& report) {
  report.notes.push_back(std::to_string(done.chains) + " chains, " + std::to_string(done.links) + " links, " +
                         std::to_string(done.steps) + " steps");
  for (const FieldUse& use : done.fields)
    report.notes.push_back(use.name + " acted in " + std::to_string(use.steps) + " steps");
  if (done.resets > 0)
    report.notes.push_back(std::to_string(done.resets) + " chains were not finite and were reset");
  if (done.unconverged > 0)
    report.notes.push_back(std::to_string(done.unconverged) + " chain steps stopped before their tolerance");
  report.error = {done.maxStretch, "relative length of a link", "greatest over all links and frames"};
}

}  // namespace

Status Evaluation::Impl::simulate(const Scene& scene, const SimulateOptions& what, const Context& context) {
  if (what.frames < 1 || what.frames > kMaxFrames)
    return makeError(ErrorCode::InvalidArgument, "1 to 1 000 000 frames can be simulated");
  const std::uint64_t headKey = head ? hashCombine(1, headHash) : 0;
  const std::uint64_t key = motionKey(scene, what, placedHash, headKey);
  if (motion && motion->key == key && motion->frameCount() >= what.frames && !forced("simulate")) {
    add("simulate", StageState::Reused, "mesh, settings and motion are the same", 0,
        motion->positions.size() * sizeof(Vec3f));
    return what.cache.empty() ? Status{} : saveCache(*motion, what.cache);
  }
  const Stopwatch watch;
  DynamicsCache cache;
  if (motion && motion->key == key && !forced("simulate")) {
    cache = std::move(*motion);
  } else {
    COIF_ASSIGN(cache, earlier(what, key));
    if (forced("simulate")) cache = {};
  }
  motion.reset();
  const std::size_t kept = cache.frameCount();
  if (kept >= what.frames) {
    motion = std::move(cache);
    add("simulate", StageState::Reused, "the cache file has these frames", watch.seconds());
    return {};
  }
  SimulationWorld world{head.get(), scene.metersPerUnit, scene.upAxis, what.motion, what.framesPerSecond};
  context.report("preparing the dynamics", 0);
  COIF_ASSIGN(const auto simulation, Simulation::create(placed, scene.dynamics, world, context));
  if (kept > 0) {
    COIF_TRY(simulation->restore(cache.state));
  } else {
    cache = {};
    cache.key = key;
    cache.framesPerSecond = what.framesPerSecond;
    cache.vertexCount = std::uint32_t(simulation->positions().size());
    keepFrame(*simulation, cache);
  }
  Stopwatch sinceCheckpoint;
  const auto checkpoint = [&]() -> Status {
    cache.state = simulation->state();
    sinceCheckpoint = {};
    return what.cache.empty() ? Status{} : saveCache(cache, what.cache);
  };
  while (cache.frameCount() < what.frames) {
    context.report("simulating", double(cache.frameCount()) / double(what.frames));
    if (const Status status = simulation->advance(context); !status.ok()) {
      COIF_TRY(checkpoint());  // what is done is not lost
      motion = std::move(cache);
      return status;
    }
    keepFrame(*simulation, cache);
    if (!what.cache.empty() && sinceCheckpoint.seconds() > kCheckpointSeconds) COIF_TRY(checkpoint());
  }
  COIF_TRY(checkpoint());
  simulationReport = simulation->report();
  StageReport& report =
      add("simulate", StageState::Ran,
          kept > 0 ? "went on after frame " + std::to_string(kept - 1) : "mesh, settings or motion are new",
          watch.seconds(), cache.positions.size() * sizeof(Vec3f));
  noteSimulation(*simulationReport, report);
  report.leftOut = simulation->leftOut();
  motion = std::move(cache);
  return {};
}

Result<const DynamicsCache*> Evaluation::simulate(const Scene& scene, const SimulateOptions& what,
                                                  const Context& context) {
  COIF_TRY(impl_->loadHead(scene, context));
  COIF_TRY(impl_->check(scene));
  COIF_TRY(impl_->runPlace(scene, context));
  COIF_TRY(impl_->simulate(scene, what, context));
  return static_cast<const DynamicsCache*>(&*impl_->motion);
}

Result<WriteReport> Evaluation::exportMotion(const Scene& scene, const SimulateOptions& what,
                                             const std::filesystem::path& path, const Context& context) {
  COIF_ASSIGN(const DynamicsCache* motion, simulate(scene, what, context));
  const std::size_t reported = impl_->reports.size();
  const Stopwatch watch;
  std::vector<StrandSet> frames;
  for (std::size_t f = 0; f < what.frames; ++f) {
    context.report("strands of the frames", double(f) / double(what.frames));
    if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped before the file was written");
    COIF_ASSIGN(StrandSet set, strandsAt(scene, *motion, f, context));
    if (f > 0) {
      StrandSet points;  // the rest is that of frame 0
      points.points = std::move(set.points);
      set = std::move(points);
    }
    frames.push_back(std::move(set));
  }
  impl_->reports.resize(reported);  // place was asked once a frame
  StrandExport out;
  out.strands = &frames[0];
  const auto& poses = motion->poses;
  const bool moves =
      std::any_of(poses.begin(), poses.end(), [](const RigidPose& p) { return !(p == RigidPose{}); });
  out.head = impl_->head ? &impl_->head->mesh() : nullptr;
  out.color = scene.look.hairColor;
  out.timeCodesPerSecond = what.framesPerSecond;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    out.frames.push_back({double(f), frames[f].points});
    if (!moves || !impl_->head) continue;
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose.topLeftCorner<3, 3>() = poses[f].rotation;
    pose.topRightCorner<3, 1>() = poses[f].position;
    out.headPoses.push_back(pose);
  }
  COIF_ASSIGN(const WriteReport written, saveStrands(out, path, context));
  StageReport& report = impl_->add("export", StageState::Ran, path.filename().string() + " was asked for",
                                   watch.seconds(), written.bytes);
  report.notes = written.notes;
  return written;
}

Result<DrapeReport> Evaluation::drape(Scene& scene, const DrapeOptions& options, const Context& context) {
  COIF_TRY(impl_->loadHead(scene, context));
  COIF_TRY(impl_->check(scene));
  COIF_TRY(impl_->runPlace(scene, context));
  const Stopwatch watch;
  HairMesh mesh = impl_->placed;
  const SimulationWorld world{impl_->head.get(), scene.metersPerUnit, scene.upAxis, {}, 24};
  COIF_ASSIGN(const DrapeReport done, coif::drape(mesh, scene.dynamics, world, options, context));
  scene.hairMesh = std::move(mesh);
  scene.placedHash = meshHash(scene.hairMesh);
  StageReport& report = impl_->add("simulate", StageState::Ran, "draping was asked for", watch.seconds());
  noteSimulation(done.simulation, report);
  report.leftOut = done.leftOut;
  if (!done.settled) report.notes.push_back("the hair still moved when the time was over");
  return done;
}

const SimulationReport* Evaluation::simulationReport() const {
  return impl_->simulationReport ? &*impl_->simulationReport : nullptr;
}

}  // namespace coif
