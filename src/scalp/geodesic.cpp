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

class Marcher {
 public:
  explicit Marcher(const Surface& surface) : surface_(surface) {
    const auto& positions = surface.mesh().positions;
    name_ = coincidentRepresentatives(positions, 0);
    start_.assign(positions.size() + 1, 0);
    forEachCorner([&](std::uint32_t v, std::uint32_t) { ++start_[v + 1]; });
    for (std::size_t v = 0; v < positions.size(); ++v) start_[v + 1] += start_[v];
    around_.resize(start_.back());
    std::vector<std::uint32_t> cursor(start_.begin(), start_.end() - 1);
    forEachCorner([&](std::uint32_t v, std::uint32_t t) { around_[cursor[v]++] = t; });
    distance_.assign(positions.size(), kInfinity);
    done_.assign(positions.size(), 0);
  }

  void seed(const SurfacePoint& source) {
    for (std::uint32_t v : names(source.triangle)) offer(v, (position(v) - source.position).norm());
    // Straight distances to the next ring as well: the flat image needs two vertices that see the source.
    for (std::uint32_t v : names(source.triangle))
      if ((position(v) - source.position).norm() <= 1e-12 * surface_.size())
        for (std::uint32_t t : trianglesAt(v))
          for (std::uint32_t w : names(t)) offer(w, (position(w) - source.position).norm());
  }

  std::vector<double> march() {
    while (!queue_.empty()) {
      const auto [d, v] = queue_.top();
      queue_.pop();
      if (d > distance_[v]) continue;
      done_[v] = 1;
      for (std::uint32_t t : trianglesAt(v)) update(v, t);
    }
    std::vector<double> out(distance_.size());
    for (std::size_t v = 0; v < out.size(); ++v) out[v] = distance_[name_[v]];
    return out;
  }

 private:
  template <class Body>
  void forEachCorner(Body body) const {
    for (std::uint32_t t = 0; t < surface_.triangleCount(); ++t)
      for (std::uint32_t v : names(t)) body(v, t);
  }
  std::array<std::uint32_t, 3> names(std::uint32_t t) const {
    auto v = surface_.triangleVertices(t);
    for (std::uint32_t& x : v) x = name_[x];
    return v;
  }
  std::span<const std::uint32_t> trianglesAt(std::uint32_t v) const {
    return std::span(around_).subspan(start_[v], start_[v + 1] - start_[v]);
  }
  const Vec3& position(std::uint32_t v) const { return surface_.mesh().positions[v]; }

  void offer(std::uint32_t v, double d) {
    // A gain of rounding's size is none, or it would go round in circles.
    if (!(d < distance_[v] * (1 - 1e-12))) return;
    distance_[v] = d;
    queue_.emplace(d, v);
  }

  void update(std::uint32_t settled, std::uint32_t triangle) {
    const auto v = names(triangle);
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] == settled) continue;
      const std::uint32_t other = v[(k + 1) % 3] == settled ? v[(k + 2) % 3] : v[(k + 1) % 3];
      offer(v[k], distance_[settled] + (position(v[k]) - position(settled)).norm());
      if (other != settled && other != v[k] && done_[other]) offer(v[k], across(settled, other, v[k]));
    }
  }

  /// Distance at c from the flat image of the source behind edge (a, b); infinity when the line misses the
  /// edge.
  double across(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3 edge = position(b) - position(a), side = position(c) - position(a);
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

  const Surface& surface_;
  std::vector<std::uint32_t> name_, start_, around_;
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
  Marcher marcher(surface);
  for (const SurfacePoint& s : sources) marcher.seed(s);
  return marcher.march();
}

}  // namespace coif
