#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "connectivity.h"
#include "patch.h"

namespace coif {
namespace {

/// Holes longer than this part of the hairline make the region a ring.
constexpr double kGreatestHole = 0.4;

struct Corners {
  std::vector<std::uint32_t> offsets{0}, corners;
  explicit Corners(const Patch& patch) {
    for (const Patch::Triangle& t : patch.triangles) {
      corners.insert(corners.end(), t.begin(), t.end());
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
};

/// Drops vertices without a triangle and gives every fan of triangles at a vertex a vertex of its own.
void splitFans(Patch& patch) {
  const Corners c(patch);
  DisjointSets fans = cornerFans(buildEdges(c.offsets, c.corners), c.corners.size());
  std::vector<std::uint32_t> number(c.corners.size(), kNone);  // by fan
  std::vector<Vec3> positions;
  for (std::uint32_t i = 0; i < c.corners.size(); ++i) {
    std::uint32_t& n = number[fans.find(i)];
    if (n == kNone) {
      n = std::uint32_t(positions.size());
      positions.push_back(patch.positions[c.corners[i]]);
    }
    patch.triangles[i / 3][i % 3] = n;
  }
  patch.positions = std::move(positions);
}

Status checkEdges(const EdgeTable& edges) {
  std::size_t crowded = 0, twisted = 0;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.edge(e);
    crowded += uses.size() > 2;
    twisted += uses.size() == 2 && uses[0].forward == uses[1].forward;
  }
  if (crowded > 0)
    return makeError(ErrorCode::Degenerate, "The region has " + std::to_string(crowded) +
                                                " edges of three faces or more; leave them out of it.");
  if (twisted > 0)
    return makeError(ErrorCode::Degenerate, "The region has " + std::to_string(twisted) +
                                                " edges between faces of opposite winding.");
  return {};
}

std::vector<std::vector<std::uint32_t>> boundaryLoops(const Patch& patch, const EdgeTable& edges) {
  std::map<std::uint32_t, std::uint32_t> next;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const EdgeUse& use = edges.edge(e)[0];
    if (edges.edge(e).size() == 1) next[use.forward ? use.a : use.b] = use.forward ? use.b : use.a;
  }
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::uint8_t> seen(patch.positions.size(), 0);
  for (const auto& [first, unused] : next) {
    if (seen[first]) continue;
    loops.emplace_back();
    for (std::uint32_t v = first; !seen[v]; v = next[v]) {
      seen[v] = 1;
      loops.back().push_back(v);
    }
  }
  return loops;
}

double length(const Patch& patch, const std::vector<std::uint32_t>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += (patch.positions[loop[(i + 1) % loop.size()]] - patch.positions[loop[i]]).norm();
  return sum;
}

void addLid(Patch& patch, const std::vector<std::uint32_t>& loop) {
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t v : loop) middle += patch.positions[v] / double(loop.size());
  const auto centre = std::uint32_t(patch.positions.size());
  patch.positions.push_back(middle);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    patch.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], centre});
    patch.parents.push_back(kNone);
    patch.barycentrics.push_back({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
  }
}

double cotangent(const Vec3& apex, const Vec3& a, const Vec3& b) {
  const double area = (a - apex).cross(b - apex).norm();
  return area > 0 ? (a - apex).dot(b - apex) / area : 0;
}

struct WeightedEdge {
  std::uint32_t a, b;  // a < b
  double weight;
};

/// Each edge once.
std::vector<WeightedEdge> weights(const Patch& patch, bool uniform) {
  std::vector<WeightedEdge> edges;
  edges.reserve(3 * patch.triangles.size());
  for (const Patch::Triangle& t : patch.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[(k + 1) % 3], t[(k + 2) % 3]);
      edges.push_back({a, b, 0.5 * cotangent(patch.positions[t[k]], patch.positions[a], patch.positions[b])});
    }
  // At most two triangles share an edge: the sum does not depend on their order.
  std::ranges::sort(edges, {}, [](const WeightedEdge& e) { return std::uint64_t{e.a} << 32 | e.b; });
  std::size_t kept = 0;
  for (const WeightedEdge& e : edges) {
    const bool again = kept > 0 && edges[kept - 1].a == e.a && edges[kept - 1].b == e.b;
    again ? void(edges[kept - 1].weight += e.weight) : void(edges[kept++] = e);
  }
  edges.resize(kept);
  // Tutte needs weights above 0; a range of 1e4 keeps the system well conditioned.
  for (WeightedEdge& e : edges) e.weight = uniform ? 1 : std::clamp(e.weight, 0.01, 100.0);
  return edges;
}

bool solve(const Patch& patch, const std::vector<std::uint8_t>& fixed, bool uniform, std::vector<Vec2>& uv) {
  std::vector<int> row(patch.positions.size(), -1);
  int unknowns = 0;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (!fixed[v]) row[v] = unknowns++;
  if (unknowns == 0) return true;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, 2);
  for (const auto& [a, b, w] : weights(patch, uniform)) {
    const std::uint32_t ends[2] = {a, b};
    for (int k = 0; k < 2; ++k) {
      const int i = row[ends[k]], j = row[ends[1 - k]];
      if (i < 0) continue;
      entries.emplace_back(i, i, w);
      if (j >= 0) entries.emplace_back(i, j, -w);
      if (j < 0) right.row(i) += w * uv[ends[1 - k]].transpose();
    }
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::MatrixXd x = factor.solve(right);
  if (!x.allFinite()) return false;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (row[v] >= 0) uv[v] = x.row(row[v]).transpose();
  return true;
}

/// u to the right and v to the back is a left-handed pair seen from outside: triangles must turn the other
/// way.
std::uint32_t countFlips(const Patch& patch, const std::vector<Vec2>& uv) {
  std::uint32_t flips = 0;
  for (const auto& [a, b, c] : patch.triangles) {
    const Vec2 x = uv[b] - uv[a], y = uv[c] - uv[a];
    flips += !(x.x() * y.y() - x.y() * y.x() < 0);
  }
  return flips;
}

/// Arc length from `from` along the loop to `to`, spread over a half circle; side −1: left, +1: right.
void placeHalf(const Patch& patch, std::uint32_t from, std::uint32_t to, double side, bool backwards,
               std::vector<Vec2>& uv) {
  const auto& loop = patch.boundary;
  const auto at = [&](std::uint32_t i) { return loop[i % loop.size()]; };
  const std::uint32_t count = (to + std::uint32_t(loop.size()) - from) % std::uint32_t(loop.size());
  std::vector<double> running{0};
  for (std::uint32_t i = 0; i < count; ++i)
    running.push_back(running.back() +
                      (patch.positions[at(from + i + 1)] - patch.positions[at(from + i)]).norm());
  for (std::uint32_t i = 0; i <= count; ++i) {
    double s = running.back() > 0 ? running[i] / running.back() : double(i) / std::max(1u, count);
    if (backwards) s = 1 - s;
    uv[at(from + i)] = {side * std::sin(s * std::numbers::pi), -std::cos(s * std::numbers::pi)};
  }
}

}  // namespace

Status makeDisc(Patch& patch) {
  splitFans(patch);
  Corners corners(patch);
  EdgeTable edges = buildEdges(corners.offsets, corners.corners);
  COIF_TRY(checkEdges(edges));
  const auto loops = boundaryLoops(patch, edges);
  if (loops.empty())
    return makeError(ErrorCode::Degenerate,
                     "The region is a closed surface without an edge; choose a part of it.");
  std::size_t outer = 0;
  for (std::size_t i = 1; i < loops.size(); ++i)
    if (length(patch, loops[i]) > length(patch, loops[outer])) outer = i;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (i == outer) continue;
    if (length(patch, loops[i]) > kGreatestHole * length(patch, loops[outer]))
      return makeError(
          ErrorCode::Degenerate,
          "The region is a ring: its hole is too large to bridge; choose a part of it without the hole.");
    addLid(patch, loops[i]);
  }
  if (loops.size() > 1)
    patch.notes.push_back("Holes in the region that were bridged: " + std::to_string(loops.size() - 1) + ".");
  patch.boundary = loops[outer];
  corners = Corners(patch);
  edges = buildEdges(corners.offsets, corners.corners);
  const long euler = long(patch.positions.size()) - long(edges.size()) + long(patch.triangles.size());
  if (euler != 1)
    return makeError(ErrorCode::Degenerate, "The region has " + std::to_string((1 - euler) / 2) +
                                                " handles (like a cup's); choose a part of it without them.");
  return {};
}

DiscMap mapToDisc(const Patch& patch, std::uint32_t front, std::uint32_t back) {
  DiscMap best;
  std::vector<Vec2> start(patch.positions.size(), Vec2::Zero());
  std::vector<std::uint8_t> fixed(patch.positions.size(), 0);
  for (std::uint32_t v : patch.boundary) fixed[v] = 1;
  placeHalf(patch, front, back, -1, false, start);
  placeHalf(patch, back, front, 1, true, start);
  start[patch.boundary[front]] = {0, -1};
  start[patch.boundary[back]] = {0, 1};
  if (!patch.middle.empty()) {
    std::vector<double> running{0};
    for (std::size_t i = 1; i < patch.middle.size(); ++i)
      running.push_back(running.back() +
                        (patch.positions[patch.middle[i]] - patch.positions[patch.middle[i - 1]]).norm());
    for (std::size_t i = 0; i < patch.middle.size(); ++i) {
      fixed[patch.middle[i]] = 1;
      start[patch.middle[i]] = {0, running.back() > 0 ? 2 * running[i] / running.back() - 1 : 0};
    }
  }
  best.flips = kNone;
  for (bool uniform : {false, true}) {
    std::vector<Vec2> uv = start;
    if (!solve(patch, fixed, uniform, uv)) continue;
    const std::uint32_t flips = countFlips(patch, uv);
    if (flips < best.flips) best = {std::move(uv), flips};
    if (best.flips == 0) break;
  }
  if (best.uv.empty()) best.uv = std::move(start);
  return best;
}

}  // namespace coif
