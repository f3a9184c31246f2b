// Lights as the path tracer asks for them: one at random, or the surroundings in a direction.
#pragma once

#include <memory>
#include <vector>

#include "coif/base/result.h"
#include "coif/light/camera.h"
#include "coif/light/image.h"
#include "coif/light/lights.h"

namespace coif::light {

double luminance(const Vec3& rgb);

/// Piecewise constant surroundings, drawn in proportion to their luminance.
class SurroundingsSampler {
 public:
  explicit SurroundingsSampler(std::shared_ptr<const FloatImage> image);
  /// In the frame (right, up, back).
  Vec3 radiance(const Vec3& direction) const;
  double pdf(const Vec3& direction) const;  ///< per solid angle
  Vec3 sample(double u, double v) const;
  double power() const { return total_; }  ///< ∫ luminance

 private:
  std::size_t texelOf(const Vec3& direction) const;
  double cosAbove(std::size_t row) const;

  std::shared_ptr<const FloatImage> image_;
  std::size_t width_, height_;
  std::vector<double> rows_, cells_;  // running sums; cells_ within each row
  double total_ = 0;
};

struct LightSample {
  Vec3 direction = Vec3::Zero();  ///< to the light
  double distance = 0;
  Vec3 radiance = Vec3::Zero();  ///< over the probability of this choice; zero: nothing was drawn
  double pdf = 0;                ///< per solid angle, choice included; 0 for lights without extent
};

class LightSampler {
 public:
  /// Errors: InvalidArgument for lights that are not finite or negative.
  static Result<LightSampler> create(const Lights& lights, const CameraFrame& camera, UpAxis upAxis);

  LightSample sample(const Vec3& at, double choice, double u, double v) const;
  Vec3 surroundings(const Vec3& direction) const;
  /// Of sample() drawing this direction from the surroundings.
  double surroundingsPdf(const Vec3& at, const Vec3& direction) const;

 private:
  struct Distant {
    Vec3 direction, color;
    double weight;
  };
  struct Near {
    Vec3 position, color;
    double weight;
  };
  Vec3 inFrame(const Vec3& d) const { return {d.dot(right_), d.dot(up_), d.dot(back_)}; }
  double totalWeight(const Vec3& at) const;

  std::vector<Distant> distant_;
  std::vector<Near> near_;
  std::shared_ptr<const SurroundingsSampler> image_;
  Vec3 sky_ = Vec3::Zero(), ground_ = Vec3::Zero();
  Vec3 right_, up_, back_;
};

}  // namespace coif::light
