#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/base/random.h"
#include "coif/base/report.h"
#include "coif/simulate/collider.h"

namespace coif {

namespace {

constexpr std::size_t kMaxBricks = std::size_t{1} << 24;

struct Exact {
  double distance;
  Vec3 gradient;
};

Exact exactAt(const Surface& surface, const Vec3& point) {
  const SurfacePoint foot = surface.nearest(point);
  const double sign = surface.windingNumber(point) > 0.5 ? -1 : 1;
  const Vec3 out = point - foot.position;
  const double length = out.norm();
  // On the surface the direction to the foot is rounding; the normal is what it tends to.
  const Vec3 gradient = length > 1e-9 * surface.size() ? Vec3(sign / length * out) : foot.normal;
  return {sign * length, gradient};
}

}  // namespace

Vec3 DistanceBand::brickCentre(std::size_t brick) const {
  const auto b = long(brick);
  const Vec3 index(double(b % bricks_[0]), double(b / bricks_[0] % bricks_[1]),
                   double(b / bricks_[0] / bricks_[1]));
  return origin_ + (index + Vec3::Constant(0.5)) * double(kBrick) * cell_;
}

Result<DistanceBand> DistanceBand::build(const Surface& surface, const DistanceBandOptions& options,
                                         const Context& context) {
  const Stopwatch watch;
  if (surface.triangleCount() == 0)
    return makeError(ErrorCode::Degenerate, "the head has no face that could be collided with");
  if (!(options.cell >= 0) || !(options.reach >= 0) || !std::isfinite(options.cell + options.reach))
    return makeError(ErrorCode::InvalidArgument, "cell and reach of a distance band must be 0 or more");
  DistanceBand band;
  band.cell_ = options.cell > 0 ? options.cell : surface.size() / 64;
  band.reach_ = options.reach > 0 ? options.reach : 3 * band.cell_;
  const Box box = bounds(surface.mesh().positions);
  const double brick = double(kBrick) * band.cell_;
  band.origin_ = box.lo - Vec3::Constant(band.reach_ + 0.5 * band.cell_);
  const Vec3 extents = box.hi - band.origin_ + Vec3::Constant(band.reach_ + 0.5 * band.cell_);
  double wanted = 1;
  for (int axis = 0; axis < 3; ++axis) wanted *= std::ceil(extents[axis] / brick);
  if (!(wanted > 0 && wanted < double(kMaxBricks)))
    return makeError(ErrorCode::TooLarge, "the cells of the distance band are too small for this head");
  for (int axis = 0; axis < 3; ++axis) band.bricks_[axis] = long(std::ceil(extents[axis] / brick));

  const auto total = std::size_t(wanted);
  band.centres_.resize(total);
  band.brickStart_.assign(total, kFar);
  parallelFor(context, total, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const Exact exact = exactAt(surface, band.brickCentre(b));
      band.centres_[b] = {float(exact.distance), exact.gradient.cast<float>()};
    }
  });
  // A distance changes by no more than the way: half a brick's diagonal says which bricks the band meets.
  const double half = 0.5 * std::sqrt(3.0) * brick;
  std::vector<std::uint32_t> chosen;
  for (std::size_t b = 0; b < total; ++b) {
    const double d = band.centres_[b].distance;
    if (d > band.reach_ + half) continue;
    band.brickStart_[b] = d < -(2 * band.cell_ + half) ? kDeep : std::uint32_t(chosen.size());
    if (band.brickStart_[b] != kDeep) chosen.push_back(std::uint32_t(b));
  }
  band.nodes_.resize(chosen.size() * std::size_t(kSide * kSide * kSide));
  parallelFor(context, chosen.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Vec3 low = band.brickCentre(chosen[c]) - Vec3::Constant(0.5 * brick);
      Node* node = &band.nodes_[c * std::size_t(kSide * kSide * kSide)];
      for (long k = 0; k < kSide; ++k) {
        for (long j = 0; j < kSide; ++j) {
          for (long i = 0; i < kSide; ++i, ++node) {
            const Exact exact = exactAt(surface, low + Vec3(double(i), double(j), double(k)) * band.cell_);
            *node = {float(exact.distance), exact.gradient.cast<float>()};
          }
        }
      }
    }
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped while the head was measured");
  band.report_.nodes = band.nodes_.size();
  band.report_.bricks = chosen.size();
  band.report_.bytes = (band.nodes_.size() + total) * sizeof(Node) + total * sizeof(std::uint32_t);
  band.measure(surface);
  band.report_.seconds = watch.seconds();
  return band;
}

bool DistanceBand::sample(const Vec3& local, double& distance, Vec3& gradient) const {
  const Vec3 cells = (local - origin_) / cell_;
  long cell[3];
  std::size_t brick = 0, stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(cells[axis] >= 0 && cells[axis] < double(kBrick * bricks_[axis]))) return false;
    cell[axis] = long(cells[axis]);
    brick += std::size_t(cell[axis] / kBrick) * stride;
    stride *= std::size_t(bricks_[axis]);
  }
  const std::uint32_t start = brickStart_[brick];
  if (start == kFar) return false;
  if (start == kDeep) {
    gradient = centres_[brick].gradient.cast<double>();
    distance = centres_[brick].distance + gradient.dot(local - brickCentre(brick));
    return true;
  }
  const Node* nodes = &nodes_[start * std::size_t(kSide * kSide * kSide)];
  const Vec3 t(cells[0] - double(cell[0]), cells[1] - double(cell[1]), cells[2] - double(cell[2]));
  distance = 0;
  gradient.setZero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at((corner & 1) ? 1 : 0, (corner & 2) ? 1 : 0, (corner & 4) ? 1 : 0);
    const Node& node =
        nodes[((cell[2] % kBrick + long(at[2])) * kSide + cell[1] % kBrick + long(at[1])) * kSide +
              cell[0] % kBrick + long(at[0])];
    const Vec3 g = node.gradient.cast<double>();
    const Vec3 w = (at.array() > 0).select(t, Vec3(Vec3::Ones() - t));
    const Vec3 sign = 2 * at - Vec3::Ones();
    const Vec3 slope = Vec3(sign[0] * w[1] * w[2], w[0] * sign[1] * w[2], w[0] * w[1] * sign[2]) / cell_;
    const double value = node.distance + 0.5 * cell_ * g.dot(t - at);
    distance += w.prod() * value;
    gradient += slope * value + 0.5 * w.prod() * g;
  }
  return distance <= reach_;
}

void DistanceBand::measure(const Surface& surface) {
  const CounterRandom random(17);
  double worst = 0, sum = 0;
  std::size_t count = 0;
  for (std::uint64_t i = 0; i < 8000 && count < 2000 && report_.bricks > 0; ++i) {
    const std::uint32_t triangle = random.below(5 * i, std::uint32_t(surface.triangleCount()));
    const double u = random.uniform(5 * i + 1), v = random.uniform(5 * i + 2);
    const double root = std::sqrt(u);
    const SurfacePoint foot = surface.at(triangle, Vec3(1 - root, root * (1 - v), root * v));
    const Vec3 point = foot.position + (random.uniform(5 * i + 3) * (reach_ + cell_) - cell_) * foot.normal;
    double found = 0;
    Vec3 gradient;
    if (!sample(point, found, gradient)) continue;
    const double error = std::abs(found - surface.signedDistance(point));
    worst = std::max(worst, error);
    sum += error * error;
    ++count;
  }
  report_.worstError = worst;
  report_.rmsError = count > 0 ? std::sqrt(sum / double(count)) : 0;
}

}  // namespace coif
