#include "cage_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "triangle_tree.h"

namespace coif {

struct PatchLocator::Impl {
  const Patch& patch;
  TriangleTree space, disc;
  double scale = 1;
  Vec3 origin = Vec3::Zero();
};

PatchLocator::PatchLocator(const Patch& patch, const DiscMap& map, const Context& context)
    : impl_(std::make_unique<Impl>(Impl{patch, {}, {}, 1, Vec3::Zero()})) {
  const Box box = bounds(patch.positions);
  impl_->origin = box.lo;
  if (box.diagonal() > 0) impl_->scale = box.diagonal();
  std::vector<TriangleTree::Triangle> space, disc;
  for (const Patch::Triangle& t : patch.triangles) {
    TriangleTree::Triangle s, d;
    for (std::size_t k = 0; k < 3; ++k) {
      s[k] = (patch.positions[t[k]] - impl_->origin) / impl_->scale;
      d[k] = {map.uv[t[k]].x(), map.uv[t[k]].y(), 0};
    }
    space.push_back(s);
    disc.push_back(d);
  }
  // Half a tree would answer nothing: whoever was cancelled asks for no more than that.
  const Context whole{context.threads};
  impl_->space = TriangleTree(std::move(space), whole);
  impl_->disc = TriangleTree(std::move(disc), whole);
}
PatchLocator::~PatchLocator() = default;

PatchPoint PatchLocator::nearest(const Vec3& position) const {
  const auto hit = impl_->space.nearest((position - impl_->origin) / impl_->scale);
  return {hit.triangle, hit.barycentric};
}

PatchPoint PatchLocator::inDisc(const Vec2& uv) const {
  const auto hit = impl_->disc.nearest({uv.x(), uv.y(), 0});
  return {hit.triangle, hit.barycentric};
}

Vec3 PatchLocator::position(const PatchPoint& point) const {
  const Patch::Triangle& t = impl_->patch.triangles[point.triangle];
  Vec3 p = Vec3::Zero();
  for (int k = 0; k < 3; ++k) p += point.barycentric[k] * impl_->patch.positions[t[std::size_t(k)]];
  return p;
}

const Patch& PatchLocator::patch() const {
  return impl_->patch;
}

namespace {

/// Length on the patch of a straight line across the disc.
double lineLength(const PatchLocator& locator, const Vec2& from, const Vec2& to) {
  constexpr int kSteps = 64;
  double sum = 0;
  Vec3 last = locator.position(locator.inDisc(from));
  for (int i = 1; i <= kSteps; ++i) {
    const Vec3 next = locator.position(locator.inDisc(from + double(i) / kSteps * (to - from)));
    sum += (next - last).norm();
    last = next;
  }
  return sum;
}

/// A path of edges of the patch, walked by arc length.
class EdgePath {
 public:
  EdgePath(const Patch& patch, std::vector<std::uint32_t> vertices)
      : patch_(patch), vertices_(std::move(vertices)) {
    std::vector<std::uint8_t> on(patch.positions.size(), 0);
    for (std::uint32_t v : vertices_) on[v] = 1;
    for (std::size_t t = 0; t < patch.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = patch.triangles[t][k], b = patch.triangles[t][(k + 1) % 3];
        if (on[a] && on[b]) edges_.try_emplace(std::minmax(a, b), std::uint32_t(t));
      }
    for (std::size_t i = 1; i < vertices_.size(); ++i)
      running_.push_back(running_.back() + (at(i) - at(i - 1)).norm());
  }

  PatchPoint atFraction(double s) const {
    const double target = s * running_.back();
    std::size_t i =
        std::size_t(std::upper_bound(running_.begin(), running_.end(), target) - running_.begin());
    i = std::clamp<std::size_t>(i, 1, running_.size() - 1);
    const double span = running_[i] - running_[i - 1];
    return onEdge(i, span > 0 ? std::clamp((target - running_[i - 1]) / span, 0.0, 1.0) : 0);
  }

  PatchPoint nearest(const Vec3& p) const {
    double best = std::numeric_limits<double>::infinity(), bestT = 0;
    std::size_t edge = 1;
    for (std::size_t i = 1; i < vertices_.size(); ++i) {
      const Vec3 d = at(i) - at(i - 1);
      const double t =
          d.squaredNorm() > 0 ? std::clamp((p - at(i - 1)).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
      const double distance = (at(i - 1) + t * d - p).squaredNorm();
      if (distance < best) best = distance, bestT = t, edge = i;
    }
    return onEdge(edge, bestT);
  }

 private:
  const Vec3& at(std::size_t i) const { return patch_.positions[vertices_[i]]; }
  PatchPoint onEdge(std::size_t i, double t) const {
    const std::uint32_t a = vertices_[i - 1], b = vertices_[i];
    PatchPoint point;
    point.triangle = edges_.at(std::minmax(a, b));
    const Patch::Triangle& corners = patch_.triangles[point.triangle];
    for (int k = 0; k < 3; ++k) {
      if (corners[std::size_t(k)] == a) point.barycentric[k] = 1 - t;
      if (corners[std::size_t(k)] == b) point.barycentric[k] = t;
    }
    return point;
  }

  const Patch& patch_;
  std::vector<std::uint32_t> vertices_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges_;
  std::vector<double> running_{0};
};

std::vector<std::uint32_t> half(const Patch& patch, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> path;
  const auto n = std::uint32_t(patch.boundary.size());
  for (std::uint32_t i = from;; i = (i + 1) % n) {
    path.push_back(patch.boundary[i]);
    if (i == to) return path;
  }
}

class Smoother {
 public:
  Smoother(const PatchLocator& locator, GridSize size, const std::optional<MirrorPlane>& mirror)
      : locator_(locator), size_(size), mirror_(mirror), width_(size.columns + 1) {
    if (!locator.patch().middle.empty()) middle_.emplace(locator.patch(), locator.patch().middle);
  }

  void start(std::uint32_t front, std::uint32_t back) {
    points_.resize(std::size_t(width_) * (size_.rows + 1));
    for (std::uint32_t j = 0; j <= size_.rows; ++j)
      for (std::uint32_t i = 0; i <= size_.columns; ++i) {
        const double x = 2.0 * i / size_.columns - 1, y = 2.0 * j / size_.rows - 1;
        // The elliptical map of the square to the disc.
        points_[index(i, j)] = locator_.inDisc({x * std::sqrt(1 - y * y / 2), y * std::sqrt(1 - x * x / 2)});
      }
    if (middle_)
      for (std::uint32_t j = 0; j <= size_.rows; ++j)
        points_[index(size_.columns / 2, j)] = middle_->atFraction(double(j) / size_.rows);
    const EdgePath left(locator_.patch(), half(locator_.patch(), front, back));
    auto rightPath = half(locator_.patch(), back, front);
    std::reverse(rightPath.begin(), rightPath.end());
    const EdgePath right(locator_.patch(), std::move(rightPath));
    const std::uint32_t steps = size_.columns + size_.rows, n2 = size_.columns / 2;
    for (std::uint32_t k = 0; k <= steps; ++k) {
      std::uint32_t i = n2 - k, j = 0;
      if (k > n2) i = 0, j = k - n2;
      if (k > n2 + size_.rows) i = k - n2 - size_.rows, j = size_.rows;
      points_[index(i, j)] = left.atFraction(double(k) / steps);
      points_[index(size_.columns - i, j)] = right.atFraction(double(k) / steps);
    }
    positions_.resize(points_.size());
    for (std::size_t v = 0; v < points_.size(); ++v) positions_[v] = locator_.position(points_[v]);
  }

  /// One round; the greatest move, in units of the mean side.
  double round() {
    std::vector<Vec3> targets = positions_;
    for (std::uint32_t j = 1; j < size_.rows; ++j)
      for (std::uint32_t i = 1; i < size_.columns; ++i) targets[index(i, j)] = target(i, j);
    double greatest = 0;
    const double side = std::sqrt(meanArea());
    std::vector<PatchPoint> points = points_;
    for (std::uint32_t j = 1; j < size_.rows; ++j)
      for (std::uint32_t i = 1; i < size_.columns; ++i) {
        Vec3 p = targets[index(i, j)];
        if (mirror_) p = 0.5 * (p + mirror_->reflect(targets[index(size_.columns - i, j)]));
        const bool held = middle_ && 2 * i == size_.columns;
        points[index(i, j)] = held ? middle_->nearest(p) : locator_.nearest(p);
      }
    for (std::size_t v = 0; v < points.size(); ++v) {
      const Vec3 p = locator_.position(points[v]);
      if (side > 0) greatest = std::max(greatest, (p - positions_[v]).norm() / side);
      positions_[v] = p;
    }
    points_ = std::move(points);
    return greatest;
  }

  /// Spread of the areas, infinite where a quad turns over: what smoothing should lower.
  double badness() const {
    const double mean = meanArea();
    double worst = 0;
    for (std::uint32_t j = 0; j < size_.rows; ++j)
      for (std::uint32_t i = 0; i < size_.columns; ++i) {
        const Vec3 n = normal(i, j);
        if (!(n.dot(outward(i, j)) > 0)) return std::numeric_limits<double>::infinity();
        worst = std::max(worst, std::abs(std::log(0.5 * n.norm() / mean)));
      }
    return worst;
  }

  std::vector<PatchPoint>& points() { return points_; }

 private:
  std::uint32_t index(std::uint32_t i, std::uint32_t j) const { return j * width_ + i; }
  const Vec3& at(std::uint32_t i, std::uint32_t j) const { return positions_[index(i, j)]; }

  Vec3 normal(std::uint32_t i, std::uint32_t j) const {
    return (at(i + 1, j + 1) - at(i, j)).cross(at(i + 1, j) - at(i, j + 1));
  }
  Vec3 centre(std::uint32_t i, std::uint32_t j) const {
    return 0.25 * (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1));
  }
  Vec3 outward(std::uint32_t i, std::uint32_t j) const {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t v : gridQuad(size_, i, j)) {
      const Patch& patch = locator_.patch();
      const auto& [a, b, c] = patch.triangles[points_[v].triangle];
      sum += (patch.positions[b] - patch.positions[a])
                 .cross(patch.positions[c] - patch.positions[a])
                 .normalized();
    }
    return sum;
  }
  double meanArea() const {
    double sum = 0;
    for (std::uint32_t j = 0; j < size_.rows; ++j)
      for (std::uint32_t i = 0; i < size_.columns; ++i) sum += 0.5 * normal(i, j).norm();
    return sum / (double(size_.columns) * size_.rows);
  }

  /// Half the mean of the neighbours (even sides), half the area-weighted middle of the quads (even areas).
  Vec3 target(std::uint32_t i, std::uint32_t j) const {
    const Vec3 even = 0.25 * (at(i - 1, j) + at(i + 1, j) + at(i, j - 1) + at(i, j + 1));
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (std::uint32_t dj : {1u, 0u})
      for (std::uint32_t di : {1u, 0u}) {
        const double area = normal(i - di, j - dj).norm();
        sum += area * centre(i - di, j - dj);
        weight += area;
      }
    const Vec3 balanced = weight > 0 ? Vec3(sum / weight) : even;
    return 0.3 * at(i, j) + 0.35 * even + 0.35 * balanced;
  }

  const PatchLocator& locator_;
  GridSize size_;
  std::optional<MirrorPlane> mirror_;
  std::uint32_t width_;
  std::optional<EdgePath> middle_;
  std::vector<PatchPoint> points_;
  std::vector<Vec3> positions_;
};

}  // namespace

GridSize chooseGrid(const PatchLocator& locator, int count) {
  const double across = lineLength(locator, {-1, 0}, {1, 0}), along = lineLength(locator, {0, -1}, {0, 1});
  const double wanted = across > 0 && along > 0 ? across / along : 1;
  GridSize best;
  double bestCost = std::numeric_limits<double>::infinity();
  for (std::uint32_t n = 2; n <= std::uint32_t(count); n += 2) {
    const auto m = std::max(1u, std::uint32_t(std::lround(double(count) / n)));
    // A tenth more or fewer quads weighs as much as sides a fifth longer one way.
    const double cost =
        std::abs(double(n) * m / count - 1) + 0.5 * std::abs(std::log(double(n) / m / wanted));
    if (cost < bestCost) bestCost = cost, best = {n, m};
  }
  return best;
}

std::vector<PatchPoint> layGrid(const PatchLocator& locator, GridSize size, std::uint32_t front,
                                std::uint32_t back, const std::optional<MirrorPlane>& mirror, int rounds,
                                const Context& context) {
  context.report("cage", 0.85);
  Smoother smoother(locator, size, mirror);
  smoother.start(front, back);
  std::vector<PatchPoint> best = smoother.points();
  double bestBadness = smoother.badness();
  for (int i = 0; i < rounds && !context.cancelled(); ++i) {
    context.report("cage", 0.85 + 0.15 * double(i) / rounds);
    const double moved = smoother.round();
    const double badness = smoother.badness();
    // Equal badness too: infinite ones are worth smoothing on.
    if (badness <= bestBadness) bestBadness = badness, best = smoother.points();
    if (moved < 1e-4) break;
  }
  return best;
}

}  // namespace coif
