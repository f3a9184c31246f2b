#include "root_sequence.h"

#include <algorithm>
#include <cmath>

#include "coif/base/check.h"
#include "coif/base/random.h"

namespace coif {
namespace {

constexpr std::uint32_t kTileSize = 8192;
constexpr std::uint32_t kCandidates = 32;
constexpr double kThinnest = 1.0 / 64;  // area of a face over its box's larger side squared

/// Points so far in the cells of a grid over the torus, for nearest-neighbour distances.
class TorusGrid {
 public:
  explicit TorusGrid(std::uint32_t cells) : cells_(cells), heads_(std::size_t(cells) * cells, kNone) {}

  void add(const Vec2f& p, std::uint32_t index) {
    if (next_.size() <= index) next_.resize(index + 1, kNone);
    std::uint32_t& head = heads_[cellOf(p)];
    next_[index] = head;
    head = index;
  }

  /// Squared distance to the nearest point, exact when below one cell, else at least that cell.
  float nearest(const Vec2f& p, const std::vector<Vec2f>& points) const {
    const auto cx = std::int32_t(p.x() * float(cells_)), cy = std::int32_t(p.y() * float(cells_));
    const auto n = std::int32_t(cells_);
    const float reach = std::min(0.5f, 1.0f / float(cells_));
    float best = 2 * reach * reach;
    for (std::int32_t y = cy - 1; y <= cy + 1; ++y) {
      for (std::int32_t x = cx - 1; x <= cx + 1; ++x) {
        const std::size_t cell = std::size_t((y + n) % n) * cells_ + std::size_t((x + n) % n);
        for (std::uint32_t i = heads_[cell]; i != kNone; i = next_[i]) {
          float dx = std::abs(points[i].x() - p.x()), dy = std::abs(points[i].y() - p.y());
          dx = std::min(dx, 1 - dx), dy = std::min(dy, 1 - dy);
          best = std::min(best, dx * dx + dy * dy);
        }
      }
    }
    return best;
  }

 private:
  std::size_t cellOf(const Vec2f& p) const {
    const auto x = std::min(std::uint32_t(p.x() * float(cells_)), cells_ - 1);
    const auto y = std::min(std::uint32_t(p.y() * float(cells_)), cells_ - 1);
    return std::size_t(y) * cells_ + x;
  }
  std::uint32_t cells_;
  std::vector<std::uint32_t> heads_, next_;
};

std::vector<Vec2f> makeTile() {
  const CounterRandom random(0x636f6966);
  std::vector<Vec2f> points;
  points.reserve(kTileSize);
  std::uint64_t counter = 0;
  const auto candidate = [&] {
    const std::uint64_t bits = random.bits(counter++);
    return Vec2f(float(bits >> 40) * 0x1p-24f, float((bits >> 8) & 0xffffff) * 0x1p-24f);
  };
  std::uint32_t rebuildAt = 0;
  TorusGrid grid(1);
  while (points.size() < kTileSize) {
    if (points.size() >= rebuildAt) {  // cells of about one to four points
      rebuildAt = std::max<std::uint32_t>(4, 4 * std::uint32_t(points.size()));
      grid = TorusGrid(std::uint32_t(std::max(1.0, std::sqrt(double(rebuildAt) / 4))));
      for (std::uint32_t i = 0; i < points.size(); ++i) grid.add(points[i], i);
    }
    Vec2f best = Vec2f::Zero();
    float bestDistance = -1;
    for (std::uint32_t c = 0; c < (points.empty() ? 1 : kCandidates); ++c) {
      const Vec2f p = candidate();
      const float distance = grid.nearest(p, points);
      if (distance > bestDistance) best = p, bestDistance = distance;
    }
    grid.add(best, std::uint32_t(points.size()));
    points.push_back(best);
  }
  return points;
}

double wrap(double x) {
  return x - std::floor(x);
}

}  // namespace

std::span<const Vec2f> progressiveTile() {
  static const std::vector<Vec2f> tile = makeTile();  // a constant: no argument, no state
  return tile;
}

RootSequence::RootSequence(const RootFace& face, std::uint64_t seed, BundleId bundle)
    : face_(face), tile_(progressiveTile()) {
  const CounterRandom random(seed, std::uint64_t(bundle));
  symmetry_ = random.below(2, 8);
  const Vec2 size = face.hi() - face.lo();
  side_ = size.maxCoeff();
  // The first root falls in the middle half of the face's box, so that few roots keep apart across faces too.
  const Vec2 first =
      (Vec2(random.uniform(0), random.uniform(1)) / 2 + Vec2(0.25, 0.25)).cwiseProduct(size / side_);
  shift_ = Vec2::Zero();
  shift_ = first - tilePoint(0);
  sliver_ = face.triangulated() || face.area() < kThinnest * side_ * side_;
}

Vec2 RootSequence::tilePoint(std::uint64_t index) const {
  // Passes after the first shift by the R2 sequence (the plastic number's powers): passes interleave evenly.
  const double pass = double(index / kTileSize);
  const Vec2f& p = tile_[index % kTileSize];
  double x = (symmetry_ & 1u) ? p.y() : p.x(), y = (symmetry_ & 1u) ? p.x() : p.y();
  if (symmetry_ & 2u) x = 1 - x;
  if (symmetry_ & 4u) y = 1 - y;
  return {wrap(x + shift_.x() + 0.7548776662466927 * pass), wrap(y + shift_.y() + 0.5698402909980532 * pass)};
}

RootSequence::Root RootSequence::next() {
  for (;;) {
    const std::uint64_t index = next_++;
    COIF_CHECK(index < kNone, "a face has at most 2^32 root places");
    const Vec2 p = tilePoint(index);
    if (sliver_) return {std::uint32_t(index), face_.fromSquare(p.x(), p.y())};
    const Vec2 place = face_.lo() + side_ * p;
    if (place.x() <= face_.hi().x() && place.y() <= face_.hi().y() && face_.contains(place)) {
      return {std::uint32_t(index), place};
    }
  }
}

}  // namespace coif
