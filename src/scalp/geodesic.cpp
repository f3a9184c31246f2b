#include "coif/scalp/geodesic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "connectivity.h"

namespace coif {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Triangle = std::array<std::uint32_t, 3>;

class Marcher {
 public:
  /// Both must outlive it.
  Marcher(std::span<const Vec3> positions, std::span<const Triangle> triangles, double limit)
      : positions_(positions), triangles_(triangles), limit_(limit) {
    start_.assign(positions.size() + 1, 0);
    forEachCorner([&](std::uint32_t v, std::uint32_t) { ++start_[v + 1]; });
    for (std::size_t v = 0; v < positions.size(); ++v) start_[v + 1] += start_[v];
    around_.resize(start_.back());
    std::vector<std::uint32_t> cursor(start_.begin(), start_.end() - 1);
    forEachCorner([&](std::uint32_t v, std::uint32_t t) { around_[cursor[v]++] = t; });
    distance_.assign(positions.size(), kInfinity);
    source_.assign(positions.size(), 0);
    done_.assign(positions.size(), 0);
  }

  void seed(std::uint32_t vertex, std::uint32_t source) { offer(vertex, 0, source); }

  /// A point inside a triangle or at one of its corners.
  void seed(std::uint32_t triangle, const Vec3& at, double size) {
    for (std::uint32_t v : triangles_[triangle]) offer(v, (positions_[v] - at).norm(), 0);
    // Straight distances to the next ring as well: the flat image needs two vertices that see the source.
    for (std::uint32_t v : triangles_[triangle])
      if ((positions_[v] - at).norm() <= 1e-12 * size)
        for (std::uint32_t t : trianglesAt(v))
          for (std::uint32_t w : triangles_[t]) offer(w, (positions_[w] - at).norm(), 0);
  }

  std::vector<double> march() {
    while (!queue_.empty()) {
      const auto [d, v] = queue_.top();
      queue_.pop();
      if (d > distance_[v]) continue;
      done_[v] = 1;
      for (std::uint32_t t : trianglesAt(v)) update(v, t);
    }
    return distance_;
  }

 private:
  template <class Body>
  void forEachCorner(Body body) const {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (std::uint32_t v : triangles_[t]) body(v, t);
  }
  std::span<const std::uint32_t> trianglesAt(std::uint32_t v) const {
    return std::span(around_).subspan(start_[v], start_[v + 1] - start_[v]);
  }

  void offer(std::uint32_t v, double d, std::uint32_t source) {
    // A gain of rounding's size is none, or it would go round in circles.
    if (!(d < distance_[v] * (1 - 1e-12)) || d > limit_) return;
    distance_[v] = d, source_[v] = source;
    queue_.emplace(d, v);
  }

  void update(std::uint32_t settled, std::uint32_t triangle) {
    const Triangle& v = triangles_[triangle];
    const std::uint32_t source = source_[settled];
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] == settled) continue;
      const std::uint32_t other = v[(k + 1) % 3] == settled ? v[(k + 2) % 3] : v[(k + 1) % 3];
      offer(v[k], distance_[settled] + (positions_[v[k]] - positions_[settled]).norm(), source);
      // Ends that are nearest to two sources have no image in common.
      if (other != settled && other != v[k] && done_[other] && source_[other] == source)
        offer(v[k], across(settled, other, v[k]), source);
    }
  }

  /// Distance at c from the flat image of the source behind edge (a, b); infinity when the line misses the
  /// edge.
  double across(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3 edge = positions_[b] - positions_[a], side = positions_[c] - positions_[a];
    const double length = edge.norm(), da = distance_[a], db = distance_[b];
    if (!(length > 0) || da + db < length || std::abs(da - db) > length) return kInfinity;
    const double sx = (da * da - db * db + length * length) / (2 * length);
    const double sy = -std::sqrt(std::max(0.0, da * da - sx * sx));
    const double cx = side.dot(edge) / length;
    const double cy = (side - cx / length * edge).norm();
    if (!(cy - sy > 0)) return kInfinity;
    const double hit = sx + (cx - sx) * (-sy) / (cy - sy);
    if (hit < 0 || hit > length) return kInfinity;
    return std::hypot(cx - sx, cy - sy);
  }

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  double limit_;
  std::vector<std::uint32_t> start_, around_, source_;
  std::vector<double> distance_;
  std::vector<std::uint8_t> done_;
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

Result<std::vector<double>> geodesicDistances(const Surface& surface, std::span<const SurfacePoint> sources) {
  if (sources.empty())
    return makeError(ErrorCode::InvalidArgument, "A distance needs a point to start from.");
  for (const SurfacePoint& s : sources)
    if (s.triangle >= surface.triangleCount() || !s.position.allFinite())
      return makeError(ErrorCode::InvalidArgument, "A start of the distance is not on the surface.");
  const std::vector<Vec3>& positions = surface.mesh().positions;
  const auto name = coincidentRepresentatives(positions, 0);
  std::vector<Triangle> triangles(surface.triangleCount());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    triangles[t] = surface.triangleVertices(t);
    for (std::uint32_t& v : triangles[t]) v = name[v];
  }
  Marcher marcher(positions, triangles, kInfinity);
  for (const SurfacePoint& s : sources) marcher.seed(s.triangle, s.position, surface.size());
  const std::vector<double> found = marcher.march();
  std::vector<double> out(found.size());
  for (std::size_t v = 0; v < out.size(); ++v) out[v] = found[name[v]];
  return out;
}

std::vector<double> geodesicDistances(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> sources, double limit) {
  Marcher marcher(positions, triangles, limit);
  for (const std::uint32_t v : sources) marcher.seed(v, v);
  return marcher.march();
}

}  // namespace coif
