#include "light/light_sampler.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace coif::light {

double luminance(const Vec3& rgb) {
  return rgb.dot(Vec3(0.2126, 0.7152, 0.0722));
}

SurroundingsSampler::SurroundingsSampler(std::shared_ptr<const FloatImage> image)
    : image_(std::move(image)), width_(std::size_t(image_->width)), height_(std::size_t(image_->height)) {
  for (std::size_t y = 0; y < height_; ++y) {
    const double solidAngle = (cosAbove(y) - cosAbove(y + 1)) * 2 * std::numbers::pi / double(width_);
    double row = 0;
    for (std::size_t x = 0; x < width_; ++x) {
      const float* p = image_->at(int(x), int(y));
      row += luminance(Vec3(p[0], p[1], p[2])) * solidAngle;
      cells_.push_back(row);
    }
    total_ += row;
    rows_.push_back(total_);
  }
}

double SurroundingsSampler::cosAbove(std::size_t row) const {
  return std::cos(std::numbers::pi * double(row) / double(height_));
}

std::size_t SurroundingsSampler::texelOf(const Vec3& d) const {
  const double theta = std::acos(std::clamp(d.y(), -1.0, 1.0));
  const double turn = 0.5 + std::atan2(-d.x(), d.z()) / (2 * std::numbers::pi);
  const auto x = std::min(std::size_t(turn * double(width_)), width_ - 1);
  const auto y = std::min(std::size_t(theta / std::numbers::pi * double(height_)), height_ - 1);
  return y * width_ + x;
}

Vec3 SurroundingsSampler::radiance(const Vec3& direction) const {
  const float* p = image_->rgba.data() + 4 * texelOf(direction);
  return {p[0], p[1], p[2]};
}

double SurroundingsSampler::pdf(const Vec3& direction) const {
  return total_ > 0 ? luminance(radiance(direction)) / total_ : 0;
}

Vec3 SurroundingsSampler::sample(double u, double v) const {
  const auto pick = [](auto first, auto last, double& w) {  // the cell of w, and w's place in it
    w *= *(last - 1);
    const auto cell = std::min(std::upper_bound(first, last, w), last - 1);
    const double before = cell == first ? 0 : *(cell - 1);
    w = std::clamp((w - before) / std::max(*cell - before, 1e-300), 0.0, 1 - 1e-12);
    return std::size_t(cell - first);
  };
  const std::size_t y = pick(rows_.begin(), rows_.end(), u);
  const auto row = cells_.begin() + std::ptrdiff_t(y * width_);
  const std::size_t x = pick(row, row + std::ptrdiff_t(width_), v);
  const double cosTheta = cosAbove(y) + u * (cosAbove(y + 1) - cosAbove(y));
  const double sinTheta = std::sqrt(std::max(0.0, 1 - cosTheta * cosTheta));
  const double angle = ((double(x) + v) / double(width_) - 0.5) * 2 * std::numbers::pi;
  return {-std::sin(angle) * sinTheta, cosTheta, std::cos(angle) * sinTheta};
}

namespace {

bool isLight(const Vec3f& color) {
  return color.allFinite() && color.minCoeff() >= 0;
}
Error notALight(const char* what) {
  return makeError(ErrorCode::InvalidArgument,
                   std::string(what) + " must be finite, and its colour must not be negative");
}

}  // namespace

Result<LightSampler> LightSampler::create(const Lights& lights, const CameraFrame& camera, UpAxis upAxis) {
  LightSampler sampler;
  sampler.right_ = lights.followCamera ? camera.right : Vec3::UnitX();
  sampler.up_ = lights.followCamera ? camera.up : upAxis == UpAxis::Y ? Vec3::UnitY() : Vec3::UnitZ();
  sampler.back_ = sampler.right_.cross(sampler.up_);
  std::vector<Light> distant{lights.key, lights.fill, lights.rim};
  distant.insert(distant.end(), lights.more.begin(), lights.more.end());
  for (const Light& light : distant) {
    if (!isLight(light.color) || !light.direction.allFinite()) return notALight("a distant light");
    const Vec3 direction = towardsLight(light, lights.followCamera, camera.right, camera.up, camera.forward);
    if (light.color.isZero(0)) continue;
    if (direction.isZero()) return notALight("the direction of a light has no length: it");
    const Vec3 color = light.color.cast<double>();
    sampler.distant_.push_back({direction, color, luminance(color)});
  }
  for (const PointLight& light : lights.points) {
    if (!isLight(light.color) || !light.position.allFinite()) return notALight("a point light");
    const Vec3 color = light.color.cast<double>();
    if (!color.isZero(0)) sampler.near_.push_back({light.position, color, luminance(color)});
  }
  if (!isLight(lights.skyColor) || !isLight(lights.groundColor)) return notALight("the sky or the ground");
  sampler.sky_ = lights.skyColor.cast<double>();
  sampler.ground_ = lights.groundColor.cast<double>();
  if (lights.surroundings) {
    COIF_TRY(validate(*lights.surroundings));
    for (std::size_t i = 0; i < lights.surroundings->rgba.size(); ++i) {
      const float value = lights.surroundings->rgba[i];
      if (i % 4 != 3 && !(value >= 0 && std::isfinite(value))) return notALight("the surroundings' picture");
    }
    sampler.image_ = std::make_shared<SurroundingsSampler>(lights.surroundings);
  }
  return sampler;
}

double LightSampler::totalWeight(const Vec3& at) const {
  double total = image_ ? image_->power() : 0;
  for (const Distant& light : distant_) total += light.weight;
  for (const Near& light : near_) total += light.weight / (light.position - at).squaredNorm();
  return total;
}

LightSample LightSampler::sample(const Vec3& at, double choice, double u, double v) const {
  LightSample s;
  const double total = totalWeight(at);
  if (!(total > 0) || !std::isfinite(total)) return s;
  double left = choice * total;
  for (const Distant& light : distant_) {
    if ((left -= light.weight) >= 0) continue;
    return {light.direction, std::numeric_limits<double>::infinity(), light.color * (total / light.weight),
            0};
  }
  for (const Near& light : near_) {
    const Vec3 way = light.position - at;
    const double weight = light.weight / way.squaredNorm();
    if ((left -= weight) >= 0) continue;
    return {way.normalized(), way.norm(), light.color * (total / (weight * way.squaredNorm())), 0};
  }
  if (!image_ || !(image_->power() > 0)) return s;
  const Vec3 local = image_->sample(u, v);
  const double pdf = image_->pdf(local) * image_->power() / total;
  if (!(pdf > 0)) return s;
  s.direction = local.x() * right_ + local.y() * up_ + local.z() * back_;
  s.distance = std::numeric_limits<double>::infinity();
  s.pdf = pdf;
  s.radiance = image_->radiance(local) / pdf;
  return s;
}

Vec3 LightSampler::surroundings(const Vec3& direction) const {
  if (image_) return image_->radiance(inFrame(direction));
  return direction.dot(up_) >= 0 ? sky_ : ground_;
}

double LightSampler::surroundingsPdf(const Vec3& at, const Vec3& direction) const {
  if (!image_) return 0;
  const double total = totalWeight(at);
  return total > 0 && std::isfinite(total) ? image_->pdf(inFrame(direction)) * image_->power() / total : 0;
}

}  // namespace coif::light
