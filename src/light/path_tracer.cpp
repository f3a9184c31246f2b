#include "coif/light/path_tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "coif/base/parallel.h"
#include "coif/base/report.h"
#include "coif/light/hair_color.h"
#include "light/path_walk.h"

namespace coif {
namespace light {
namespace {

constexpr int kFirstRound = 16;  // samples before an error estimate is trusted

Status checkOptions(const PathTraceOptions& options) {
  const auto refuse = [](const char* what) { return makeError(ErrorCode::InvalidArgument, what); };
  if (options.width < 1 || options.width > 8192 || options.height < 1 || options.height > 8192)
    return refuse("the picture's sides must lie between 1 and 8192 pixels");
  if (options.samplesPerPixel < 2 || options.samplesPerPixel > (1 << 20))
    return refuse("samples per pixel must lie between 2 and 2^20");
  if (!(options.targetError >= 0 && std::isfinite(options.targetError)))
    return refuse("the target error must not be negative");
  if (options.maxBounces < 1 || options.maxBounces > 65536)
    return refuse("the most bounces must lie between 1 and 65536");
  if (options.rouletteStart < 0) return refuse("Russian roulette starts at 0 bounces or more");
  return {};
}

bool isAlbedo(const Vec3f& color) {
  return color.minCoeff() >= 0 && color.maxCoeff() <= 1;  // false for what is not a number
}

/// A fibre for every colour that strands have, in steps of 1/32 of its square root.
void colorFibres(const PathTraceScene& scene, PathWorld& world) {
  const StrandSet& strands = *scene.strands;
  std::map<std::array<int, 3>, std::uint16_t> palette;
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    Vec3 sum = Vec3::Zero();
    for (std::uint64_t p = strands.offsets[s]; p < strands.offsets[s + 1]; ++p) {
      sum += strands.colors[p].cast<double>();
    }
    sum /= double(std::max<std::uint64_t>(strands.offsets[s + 1] - strands.offsets[s], 1));
    std::array<int, 3> steps;
    for (int c = 0; c < 3; ++c) {
      steps[std::size_t(c)] = sum[c] > 0 ? int(std::lround(31 * std::sqrt(std::min(sum[c], 1.0)))) : 0;
    }
    const auto [at, isNew] = palette.try_emplace(steps, std::uint16_t(palette.size()));
    if (isNew) {
      const Vec3 root = Vec3(steps[0], steps[1], steps[2]) / 31;
      FibreParameters fibre = scene.fibre;
      fibre.absorption = absorptionFromAlbedo(root.cwiseAbs2(), fibre.azimuthalRoughness);
      world.fibres.emplace_back(fibre);
    }
    world.fibreOf.push_back(at->second);
  }
}

double largestCoordinate(const PathTraceScene& scene) {
  double largest = scene.camera.eye.cwiseAbs().maxCoeff();
  if (scene.head) {
    for (const Vec3& p : scene.head->positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  return largest;
}

Result<PathWorld> makeWorld(const PathTraceScene& scene, const PathTraceOptions& options,
                            const CameraFrame& camera) {
  if (!isAlbedo(scene.headColor))
    return makeError(ErrorCode::InvalidArgument, "the head's colour must lie between 0 and 1");
  if (scene.ground) COIF_TRY(validate(*scene.ground));
  const UpAxis up = scene.strands ? scene.strands->upAxis : scene.head ? scene.head->upAxis : UpAxis::Y;
  COIF_ASSIGN(LightSampler lights, LightSampler::create(scene.lights, camera, up));
  COIF_ASSIGN(RayScene rays, RayScene::build(scene.strands, scene.head));
  PathWorld world{std::move(rays), std::move(lights), {}, {}, scene.ground};
  if (world.ground) world.ground->normal = world.ground->normal.stableNormalized();
  if (scene.useStrandColors && scene.strands && !scene.strands->colors.empty()) {
    colorFibres(scene, world);
  }
  if (world.fibres.empty()) world.fibres.emplace_back(scene.fibre);
  world.headColor = scene.headColor.cast<double>();
  world.offset = std::ldexp(largestCoordinate(scene), -19);  // 16 roundings of a float
  world.maxBounces = options.maxBounces;
  world.rouletteStart = options.rouletteStart;
  world.showSurroundings = options.showSurroundings;
  return world;
}

/// Sums of samples and of their squares.
struct Pixel {
  Eigen::Array4d sum = Eigen::Array4d::Zero(), squares = Eigen::Array4d::Zero();
  double luminance = 0, luminanceSquares = 0;

  void add(const Vec3& radiance, double alpha) {
    const Eigen::Array4d value(radiance.x(), radiance.y(), radiance.z(), alpha);
    sum += value;
    squares += value.square();
    const double y = light::luminance(radiance);
    luminance += y;
    luminanceSquares += y * y;
  }
};

/// Of the mean of n samples; rounding may leave a negative variance.
double varianceOfMean(double sum, double squares, int n) {
  return std::max(0.0, (squares - sum * sum / n) / (n - 1.0) / n);
}

class Film {
 public:
  Film(const PathWorld& world, const CameraFrame& camera, const PathTraceOptions& options)
      : world_(world),
        camera_(camera),
        options_(options),
        pixels_(std::size_t(options.width) * std::size_t(options.height)) {}

  int samples() const { return samples_; }

  // `count` more samples a pixel; false when cancelled.
  bool addSamples(const Context& context, int count, int most) {
    // Bands small enough for progress and cancelling, and whole chunks.
    const std::size_t band = std::max<std::size_t>(64, 16384 / std::size_t(count) / 64 * 64);
    for (std::size_t first = 0; first < pixels_.size(); first += band) {
      const std::size_t n = std::min(band, pixels_.size() - first);
      parallelFor(context, n, 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = first + begin; p < first + end; ++p) samplePixel(p, count);
      });
      if (context.cancelled()) return false;
      context.report("path tracing",
                     (double(samples_) + double(count) * double(first + n) / double(pixels_.size())) / most);
    }
    samples_ += count;
    return true;
  }

  double relativeError() const {
    double mean = 0, variance = 0;
    for (const Pixel& pixel : pixels_) {
      mean += pixel.luminance / samples_;
      variance += varianceOfMean(pixel.luminance, pixel.luminanceSquares, samples_);
    }
    const double count = double(pixels_.size());
    return mean > 0 ? std::sqrt(variance / count) / (mean / count) : 0;
  }

  void develop(PathTracePicture& picture) const {
    picture.image = picture.standardError = FloatImage(options_.width, options_.height);
    picture.samplesPerPixel = samples_;
    picture.relativeError = relativeError();
    Eigen::Array4d variance = Eigen::Array4d::Zero(), mean = Eigen::Array4d::Zero();
    for (std::size_t p = 0; p < pixels_.size(); ++p) {
      for (int c = 0; c < 4; ++c) {
        const double v = varianceOfMean(pixels_[p].sum[c], pixels_[p].squares[c], samples_);
        picture.image.rgba[4 * p + std::size_t(c)] = float(pixels_[p].sum[c] / samples_);
        picture.standardError.rgba[4 * p + std::size_t(c)] = float(std::sqrt(v));
        variance[c] += v;
        mean[c] += pixels_[p].sum[c] / samples_;
      }
    }
    const double count = double(pixels_.size());
    picture.mean = (mean / count).head<3>();
    picture.confidence95 = (1.96 * variance.sqrt() / count).head<3>();
    picture.paths = std::uint64_t(pixels_.size()) * std::uint64_t(samples_);
    picture.rays = rays_;
    picture.shadowRays = shadowRays_;
    picture.truncatedPaths = truncated_;
    picture.invalidPaths = invalid_;
  }

 private:
  void samplePixel(std::size_t p, int count) {
    std::uint64_t rays = 0, shadowRays = 0, truncated = 0, invalid = 0;
    const CounterRandom ofPixel(options_.seed, p);
    const double x = double(p % std::size_t(options_.width)), y = double(p / std::size_t(options_.width));
    for (int s = samples_; s < samples_ + count; ++s) {
      const CounterRandom random = ofPixel.child(std::uint64_t(s));
      const double right = 2 * (x + random.uniform(0)) - options_.width,
                   up = options_.height - 2 * (y + random.uniform(1));
      const Vec3 direction =
          camera_.forward + camera_.slopeY / options_.height * (right * camera_.right + up * camera_.up);
      const PathResult path = tracePath(world_, camera_.eye, direction.normalized(), random);
      rays += path.rays, shadowRays += path.shadowRays, truncated += path.truncated ? 1 : 0;
      const bool valid = path.radiance.allFinite();
      invalid += valid ? 0 : 1;
      pixels_[p].add(valid ? path.radiance : Vec3(Vec3::Zero()), path.alpha);
    }
    // Whole numbers: the order in which threads add them does not show.
    rays_ += rays, shadowRays_ += shadowRays, truncated_ += truncated, invalid_ += invalid;
  }

  const PathWorld& world_;
  const CameraFrame& camera_;
  const PathTraceOptions& options_;
  std::vector<Pixel> pixels_;
  int samples_ = 0;
  std::atomic<std::uint64_t> rays_{0}, shadowRays_{0}, truncated_{0}, invalid_{0};
};

void addNotes(PathTracePicture& picture) {
  const auto note = [&](std::uint64_t count, const char* what) {
    if (count > 0) picture.notes.push_back(std::to_string(count) + what);
  };
  note(picture.strandsDropped,
       " strands were left out: values that are not finite, or no two distinct points");
  note(picture.truncatedPaths, " paths ended at the most bounces: their further light is missing");
  note(picture.invalidPaths, " paths gave no finite radiance and count as black");
}

}  // namespace
}  // namespace light

Result<PathTracePicture> pathTrace(const PathTraceScene& scene, const PathTraceOptions& options,
                                   const Context& context) {
  const Stopwatch watch;
  COIF_TRY(light::checkOptions(options));
  COIF_ASSIGN(const CameraFrame camera, frameOf(scene.camera));
  COIF_ASSIGN(const light::PathWorld world, light::makeWorld(scene, options, camera));
  light::Film film(world, camera, options);
  const int most = options.samplesPerPixel;
  while (film.samples() < most) {
    const int samples = film.samples();
    const int round = options.targetError > 0 ? std::max(samples, light::kFirstRound) : most;
    if (!film.addSamples(context, std::min(round, most - samples), most)) {
      return makeError(ErrorCode::Cancelled, "cancelled");
    }
    if (options.targetError > 0 && film.relativeError() <= options.targetError) break;
  }
  PathTracePicture picture;
  film.develop(picture);
  picture.strandsDropped = world.rays.strandsDropped();
  light::addNotes(picture);
  picture.seconds = watch.seconds();
  return picture;
}

}  // namespace coif
