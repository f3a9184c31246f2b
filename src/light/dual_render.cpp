#include "coif/light/dual_render.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "coif/base/parallel.h"

namespace coif {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

// A fibre's frame: x along it.
Mat3 frameOfFibre(const Vec3& tangent) {
  Mat3 frame;
  frame.col(0) = tangent;
  frame.col(1) = tangent.unitOrthogonal();
  frame.col(2) = tangent.cross(frame.col(1));
  return frame;
}

class Renderer {
 public:
  Renderer(const DualRenderScene& scene, const DualRenderOptions& options, const CameraFrame& frame,
           std::vector<ShiningLight> lights)
      : scene_(scene), options_(options), frame_(frame), lights_(std::move(lights)) {}

  void row(int y, FloatImage& image) const {
    std::vector<StrandMeeting> meetings;
    SurroundingLight around;
    for (int x = 0; x < options_.width; ++x) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      const CounterRandom random(options_.seed,
                                 std::uint64_t(y) * std::uint64_t(options_.width) + std::uint64_t(x));
      for (int s = 0; s < options_.samplesPerPixel; ++s) {
        sum += sample(x + random.uniform(2 * std::uint64_t(s)), y + random.uniform(2 * std::uint64_t(s) + 1),
                      random.child(std::uint64_t(s)), meetings, around);
      }
      float* pixel = image.at(x, y);
      for (int c = 0; c < 4; ++c) pixel[c] = float(sum[c] / options_.samplesPerPixel);
    }
  }

 private:
  Eigen::Vector4d sample(double x, double y, const CounterRandom& random,
                         std::vector<StrandMeeting>& meetings, SurroundingLight& around) const {
    const double w = options_.width, h = options_.height;
    const Vec3 direction =
        (frame_.forward + frame_.slopeY * ((2 * x - w) * frame_.right + (h - 2 * y) * frame_.up) / h)
            .normalized();
    const bool head = scene_.strands->shoot(frame_.eye, direction, kFar, meetings);
    Eigen::Vector4d out(0, 0, 0, head || !meetings.empty() ? 1 : 0);
    if (meetings.empty()) return out;
    const StrandMeeting first = meetings.front();
    const Mat3 fibre = frameOfFibre(first.tangent), local = fibre.transpose();
    const Vec3 point = frame_.eye + first.distance * direction, wo = -(local * direction);
    for (std::size_t l = 0; l < lights_.size(); ++l) {
      const Vec3& toLight = lights_[l].toLight;
      const Vec3 wi = local * toLight;
      Vec3 radiance;
      if (options_.maps.empty() && options_.surroundingRays > 0) {
        shootAround(*scene_.strands, *scene_.hair, point, first.strand, fibre, toLight,
                    options_.surroundingRays, random.child(l), meetings, around);
        radiance = scene_.hair->evaluate(wi, wo, around, first.h);
      } else {
        const ForwardScattering arriving =
            options_.maps.empty()
                ? shootForward(*scene_.strands, *scene_.hair, point, first.strand, toLight, meetings)
                : options_.maps[l]->at(point, {first.tangent, 2 * first.radius});
        radiance = scene_.hair->evaluate(wi, wo, arriving, first.h);
      }
      out.head<3>() += radiance.cwiseProduct(lights_[l].irradiance);
    }
    return out;
  }

  const DualRenderScene& scene_;
  const DualRenderOptions& options_;
  CameraFrame frame_;
  std::vector<ShiningLight> lights_;
};

}  // namespace

std::vector<ShiningLight> shiningLights(const Lights& lights, const CameraFrame& frame) {
  std::vector<Light> all{lights.key, lights.fill, lights.rim};
  all.insert(all.end(), lights.more.begin(), lights.more.end());
  std::vector<ShiningLight> out;
  for (const Light& light : all) {
    const Vec3 toLight = towardsLight(light, lights.followCamera, frame.right, frame.up, frame.forward);
    if (light.color.maxCoeff() > 0 && toLight.squaredNorm() > 0) {
      out.push_back({toLight, light.color.cast<double>()});
    }
  }
  return out;
}

ForwardScattering shootForward(const StrandShooter& strands, const DualScattering& hair, const Vec3& point,
                               std::uint32_t strand, const Vec3& toLight,
                               std::vector<StrandMeeting>& meetings) {
  if (strands.shoot(point, toLight, kFar, meetings, strand)) return {0, Vec3::Zero(), Vec3::Zero()};
  ForwardPath path;
  for (const StrandMeeting& meeting : meetings) path.cross(hair, meeting.inclinationRad(toLight));
  return path.result();
}

void shootAround(const StrandShooter& strands, const DualScattering& hair, const Vec3& point,
                 std::uint32_t strand, const Mat3& fibre, const Vec3& toLight, int rays,
                 const CounterRandom& random, std::vector<StrandMeeting>& meetings, SurroundingLight& out) {
  const Vec3 wi = fibre.transpose() * toLight;
  const double theta = std::asin(std::clamp(wi.x(), -1.0, 1.0)), azimuth = std::atan2(wi.z(), wi.y());
  // Even over half the circle, one a stratum.
  const auto onCone = [&](double inclination, double middle, int ray, std::uint64_t number) -> Vec3 {
    const double phi = middle + std::numbers::pi * ((ray + random.uniform(number)) / rays - 0.5);
    return {std::sin(inclination), std::cos(inclination) * std::cos(phi),
            std::cos(inclination) * std::sin(phi)};
  };
  const bool hidden = strands.shoot(point, toLight, kFar, meetings, strand);
  out.directFraction = hidden || !meetings.empty() ? 0 : 1;
  out.arrivals.assign(std::size_t(rays), {});
  out.backscatter = Vec3::Zero();
  out.behind = {0, Vec3::Zero(), Vec3::Zero()};
  int met = 0;
  for (int r = 0; r < rays; ++r) {
    const auto number = 2 * std::uint64_t(r);
    SurroundingLight::Arrival& arrival = out.arrivals[std::size_t(r)];
    arrival.direction = onCone(theta, azimuth, r, number);
    const Vec3 forwards = fibre * arrival.direction;
    strands.shoot(point, forwards, kFar, meetings, strand);
    if (!meetings.empty()) {
      const StrandMeeting last = meetings.front();
      const ForwardScattering there =
          shootForward(strands, hair, point + last.distance * forwards, last.strand, toLight, meetings);
      const Mat3 local = frameOfFibre(last.tangent).transpose();
      arrival.transmittance = hair.turned(local * toLight, -(local * forwards), there);
      arrival.variance = there.variance + hair.forwardVariance(last.inclinationRad(toLight));
    }
    const Vec3 backwards = fibre * onCone(-theta, azimuth + std::numbers::pi, r, number + 1);
    strands.shoot(point, backwards, kFar, meetings, strand);
    out.backscatter += hair.backscatterShare(theta, double(meetings.size())) / rays;
    if (meetings.empty()) continue;
    const StrandMeeting next = meetings.front();
    const ForwardScattering there =
        shootForward(strands, hair, point + next.distance * backwards, next.strand, toLight, meetings);
    ++met;
    out.behind.directFraction += there.directFraction;
    out.behind.transmittance += there.transmittance;
    out.behind.variance += (1 - there.directFraction) * there.transmittance.cwiseProduct(there.variance);
  }
  if (met == 0) return;
  out.behind.directFraction /= met;
  out.behind.transmittance /= met;
  const Vec3 scattered = out.behind.transmittance.array() - out.behind.directFraction;
  out.behind.variance = (out.behind.variance / met).cwiseQuotient(scattered.cwiseMax(1e-12));
}

Result<FloatImage> renderDualScattering(const DualRenderScene& scene, const DualRenderOptions& options,
                                        const Context& context) {
  if (scene.strands == nullptr || scene.hair == nullptr || options.width < 1 || options.height < 1 ||
      options.width > kLargestPictureSide || options.height > kLargestPictureSide ||
      options.samplesPerPixel < 1 || options.surroundingRays < 0) {
    return makeError(ErrorCode::InvalidArgument,
                     "dual scattering needs strands, hair, a size, samples and no negative number of rays");
  }
  COIF_ASSIGN(const CameraFrame frame, frameOf(scene.camera));
  std::vector<ShiningLight> lights = shiningLights(scene.lights, frame);
  if (!options.maps.empty() && options.maps.size() != lights.size()) {
    return makeError(ErrorCode::InvalidArgument, "dual scattering needs one map a light that shines");
  }
  FloatImage image(options.width, options.height);
  const Renderer renderer(scene, options, frame, std::move(lights));
  parallelFor(context, std::size_t(options.height), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) renderer.row(int(y), image);
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the picture was cancelled");
  return image;
}

}  // namespace coif
