#include "light/path_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace coif::light {
namespace {

// A right-handed orthonormal frame around x.
struct Frame {
  Vec3 x, y, z;
  explicit Frame(const Vec3& axis) : x(axis), y(axis.unitOrthogonal()), z(x.cross(y)) {}
  Vec3 local(const Vec3& v) const { return {v.dot(x), v.dot(y), v.dot(z)}; }
  Vec3 world(const Vec3& v) const { return v.x() * x + v.y() * y + v.z() * z; }
};

// Where a path is scattered, and how: a fibre or a diffuse face.
struct Scatterer {
  const FibreScattering* fibre = nullptr;
  Frame frame{Vec3::UnitX()};  // x: the fibre, or the smooth normal
  Vec3 wo = Vec3::Zero();      // back along the path, in the frame
  double h = 0;
  Vec3 albedo = Vec3::Zero(), faceNormal = Vec3::Zero();  // of a face, towards wo
  RayStart start;

  struct Sample {
    Vec3 direction = Vec3::Zero(), weight = Vec3::Zero();
    double pdf = 0;
  };

  // f cos θ_i towards a direction of the world, and the density of sample() drawing it.
  Vec3 evaluate(const Vec3& direction, double& pdf) const {
    if (fibre) {
      const Vec3 wi = frame.local(direction);
      pdf = fibre->pdf(wi, wo, h);
      return fibre->evaluate(wi, wo, h);
    }
    const double cosine = std::max(0.0, direction.dot(frame.x)) / std::numbers::pi;
    pdf = cosine;
    return direction.dot(faceNormal) > 0 ? Vec3(albedo * cosine) : Vec3(Vec3::Zero());
  }

  Sample sample(const CounterRandom& random, std::uint64_t counter) const {
    if (fibre) {
      const FibreSample s = fibre->sample(wo, h,
                                          {random.uniform(counter), random.uniform(counter + 1),
                                           random.uniform(counter + 2), random.uniform(counter + 3)});
      return {frame.world(s.direction).normalized(), s.weight, s.pdf};
    }
    const double u = random.uniform(counter), angle = 2 * std::numbers::pi * random.uniform(counter + 1);
    const double x = std::sqrt(1 - u), r = std::sqrt(u);
    const Vec3 direction = frame.world({x, r * std::cos(angle), r * std::sin(angle)}).normalized();
    return {direction, direction.dot(faceNormal) > 0 ? albedo : Vec3(Vec3::Zero()), x / std::numbers::pi};
  }
};

Scatterer onFibre(const PathWorld& world, const RayHit& hit, const Vec3& origin, const Vec3& direction) {
  Scatterer s;
  const std::size_t fibre = world.fibreOf.empty() ? 0 : world.fibreOf[hit.strand.strand];
  s.fibre = &world.fibres[fibre];
  s.frame = Frame(hit.strand.tangent);
  s.wo = s.frame.local(-direction);
  s.h = hit.strand.h;
  s.start = {origin + hit.distance * direction, hit.strand.strand, kNone};
  return s;
}

Scatterer onFace(const PathWorld& world, Vec3 faceNormal, Vec3 smoothNormal, const Vec3& albedo,
                 const Vec3& point, const Vec3& direction, std::uint32_t triangle) {
  if (faceNormal.dot(direction) > 0) faceNormal = -faceNormal, smoothNormal = -smoothNormal;
  Scatterer s;
  s.frame = Frame(smoothNormal);
  s.faceNormal = faceNormal;
  s.albedo = albedo;
  s.start = {point + world.offset * faceNormal, kNone, triangle};
  return s;
}

double groundDistance(const std::optional<Ground>& ground, const Vec3& origin, const Vec3& direction) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (!ground) return kNever;
  const double slope = ground->normal.dot(direction);
  if (slope == 0) return kNever;
  const double distance = ground->normal.dot(ground->point - origin) / slope;
  if (!(distance > 0)) return kNever;
  return (origin + distance * direction - ground->point).norm() <= ground->radius ? distance : kNever;
}

double powerHeuristic(double own, double other) {
  return own * own / (own * own + other * other);
}

class Walk {
 public:
  Walk(const PathWorld& world, const Vec3& eye, const Vec3& direction, const CounterRandom& random)
      : world_(world), random_(random), direction_(direction) {
    start_.origin = eye;
  }

  PathResult run() {
    for (int bounce = 0;; ++bounce) {
      const std::optional<Scatterer> scatterer = meet(bounce);
      if (!scatterer) break;
      result_.alpha = 1;
      if (bounce >= world_.maxBounces) {
        result_.truncated = true;
        break;
      }
      const std::uint64_t counter = 8 * std::uint64_t(bounce + 1);
      addLight(*scatterer, counter);
      if (!goOn(*scatterer, counter + 3, bounce)) break;
    }
    return result_;
  }

 private:
  // The next scatterer; none: the path has left the scene, its light is added.
  std::optional<Scatterer> meet(int bounce) {
    ++result_.rays;
    const RayHit hit = world_.rays.closest(start_, direction_);
    const double toGround = groundDistance(world_.ground, start_.origin, direction_);
    if (toGround <
        (hit.kind == RayHit::Kind::Nothing ? std::numeric_limits<double>::infinity() : hit.distance)) {
      return onFace(world_, world_.ground->normal, world_.ground->normal, world_.ground->color.cast<double>(),
                    start_.origin + toGround * direction_, direction_, kNone);
    }
    switch (hit.kind) {
      case RayHit::Kind::Strand:
        return onFibre(world_, hit, start_.origin, direction_);
      case RayHit::Kind::Head:
        return onFace(world_, hit.faceNormal, hit.smoothNormal, world_.headColor,
                      start_.origin + hit.distance * direction_, direction_, hit.triangle);
      default:
        break;
    }
    if (bounce == 0 && !world_.showSurroundings) return {};
    const double other = bounce == 0 ? 0 : world_.lights.surroundingsPdf(start_.origin, direction_);
    const double share = other > 0 ? powerHeuristic(pdf_, other) : 1;
    result_.radiance += share * throughput_.cwiseProduct(world_.lights.surroundings(direction_));
    return {};
  }

  void addLight(const Scatterer& at, std::uint64_t counter) {
    const LightSample light =
        world_.lights.sample(at.start.origin, random_.uniform(counter), random_.uniform(counter + 1),
                             random_.uniform(counter + 2));
    if (light.radiance.isZero(0)) return;
    double pdf = 0;
    const Vec3 scattered = at.evaluate(light.direction, pdf);
    if (scattered.isZero(0)) return;
    ++result_.shadowRays;
    if (groundDistance(world_.ground, at.start.origin, light.direction) < light.distance) return;
    if (world_.rays.blocked(at.start, light.direction, light.distance)) return;
    const double share = light.pdf > 0 ? powerHeuristic(light.pdf, pdf) : 1;
    result_.radiance += share * throughput_.cwiseProduct(scattered).cwiseProduct(light.radiance);
  }

  // Draws the next direction; false: the path ends.
  bool goOn(const Scatterer& at, std::uint64_t counter, int bounce) {
    const Scatterer::Sample next = at.sample(random_, counter);
    throughput_ = throughput_.cwiseProduct(next.weight);
    const double most = throughput_.maxCoeff();
    if (!(most > 0)) return false;
    if (bounce >= world_.rouletteStart && most < 1) {
      if (random_.uniform(counter + 4) >= most) return false;
      throughput_ /= most;
    }
    start_ = at.start;
    direction_ = next.direction;
    pdf_ = next.pdf;
    return true;
  }

  const PathWorld& world_;
  const CounterRandom random_;
  RayStart start_;
  Vec3 direction_, throughput_ = Vec3::Ones();
  double pdf_ = 0;  // of direction_
  PathResult result_;
};

}  // namespace

PathResult tracePath(const PathWorld& world, const Vec3& eye, const Vec3& direction,
                     const CounterRandom& random) {
  return Walk(world, eye, direction, random).run();
}

}  // namespace coif::light
