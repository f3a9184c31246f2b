#include "coif/light/dual_render.h"

#include <cmath>
#include <limits>

#include "coif/base/parallel.h"
#include "coif/base/random.h"

namespace coif {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

// A fibre's frame: x along it.
struct FibreFrame {
  Vec3 x, y, z;
  explicit FibreFrame(const Vec3& tangent) : x(tangent), y(tangent.unitOrthogonal()), z(tangent.cross(y)) {}
  Vec3 local(const Vec3& w) const { return Vec3(w.dot(x), w.dot(y), w.dot(z)); }
};

class Renderer {
 public:
  Renderer(const DualRenderScene& scene, const DualRenderOptions& options, const CameraFrame& frame,
           std::vector<ShiningLight> lights)
      : scene_(scene), options_(options), frame_(frame), lights_(std::move(lights)) {}

  void row(int y, FloatImage& image) const {
    std::vector<StrandMeeting> meetings;
    for (int x = 0; x < options_.width; ++x) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      const CounterRandom random(options_.seed,
                                 std::uint64_t(y) * std::uint64_t(options_.width) + std::uint64_t(x));
      for (int s = 0; s < options_.samplesPerPixel; ++s) {
        sum += sample(x + random.uniform(2 * std::uint64_t(s)), y + random.uniform(2 * std::uint64_t(s) + 1),
                      meetings);
      }
      float* pixel = image.at(x, y);
      for (int c = 0; c < 4; ++c) pixel[c] = float(sum[c] / options_.samplesPerPixel);
    }
  }

 private:
  Eigen::Vector4d sample(double x, double y, std::vector<StrandMeeting>& meetings) const {
    const double w = options_.width, h = options_.height;
    const Vec3 direction =
        (frame_.forward + frame_.slopeY * ((2 * x - w) * frame_.right + (h - 2 * y) * frame_.up) / h)
            .normalized();
    const bool head = scene_.strands->shoot(frame_.eye, direction, kFar, meetings);
    Eigen::Vector4d out(0, 0, 0, head || !meetings.empty() ? 1 : 0);
    if (meetings.empty()) return out;
    const StrandMeeting first = meetings.front();
    const FibreFrame fibre(first.tangent);
    const Vec3 point = frame_.eye + first.distance * direction, wo = fibre.local(-direction);
    for (std::size_t l = 0; l < lights_.size(); ++l) {
      const ForwardScattering arriving =
          options_.maps.empty()
              ? shootForward(*scene_.strands, *scene_.hair, point, first.strand, lights_[l].toLight, meetings)
              : options_.maps[l]->at(point);
      out.head<3>() += scene_.hair->evaluate(fibre.local(lights_[l].toLight), wo, arriving, first.h)
                           .cwiseProduct(lights_[l].irradiance);
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

Result<FloatImage> renderDualScattering(const DualRenderScene& scene, const DualRenderOptions& options,
                                        const Context& context) {
  if (scene.strands == nullptr || scene.hair == nullptr || options.width < 1 || options.height < 1 ||
      options.width > kLargestPictureSide || options.height > kLargestPictureSide ||
      options.samplesPerPixel < 1) {
    return makeError(ErrorCode::InvalidArgument, "dual scattering needs strands, hair, a size and samples");
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
