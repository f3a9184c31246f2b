#include "triangle_tree.h"

#include <igl/AABB.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace coif {
namespace {

using IglTree = igl::AABB<Eigen::MatrixXd, 3>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The tree is balanced: its depth is at most log2(2^32) + 1, and a walk keeps one sibling a level.
constexpr std::size_t kMaxStack = 80;
// Below this the triangles' own solid angles cost less than the moments' memory.
constexpr std::size_t kFewTriangles = 8;

Vec3 point(const TriangleTree::Triangle& t, const Vec3& b) {
  return b[0] * t[0] + b[1] * t[1] + b[2] * t[2];
}

double boxDistance2(const Vec3& lo, const Vec3& hi, const Vec3& p) {
  return (lo - p).cwiseMax(p - hi).cwiseMax(0.0).squaredNorm();
}

/// Entry parameter of a ray into a box, infinity when it misses or enters after maxT.
double boxEntry(const Vec3& lo, const Vec3& hi, const Vec3& origin, const Vec3& inverse, double maxT) {
  double enter = 0, leave = maxT;
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(inverse[k])) {
      if (origin[k] < lo[k] || origin[k] > hi[k]) return kInfinity;
      continue;
    }
    const double a = (lo[k] - origin[k]) * inverse[k], b = (hi[k] - origin[k]) * inverse[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  // A slab may be entered one rounding late: keep boxes that are touched.
  return enter <= leave * (1 + 4e-16) + 1e-300 ? enter : kInfinity;
}

/// Watertight up to rounding: the signs of the three edge volumes decide (Plücker), so shared edges agree.
bool rayTriangle(const TriangleTree::Triangle& t, const Vec3& origin, const Vec3& direction,
                 Vec3& barycentric, double& parameter) {
  const Vec3 a = t[0] - origin, b = t[1] - origin, c = t[2] - origin;
  const double u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)), w = direction.dot(a.cross(b));
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double sum = u + v + w;
  if (sum == 0) return false;
  barycentric = Vec3(u, v, w) / sum;
  if (!barycentric.allFinite()) return false;
  parameter = (point(t, barycentric) - origin).dot(direction) / direction.squaredNorm();
  return true;
}

/// Van Oosterom and Strackee 1983, as a fraction of the sphere.
double solidAngle(const TriangleTree::Triangle& t, const Vec3& p) {
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double det = a.dot(b.cross(c));
  const double den = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  if (det == 0) return 0;  // in the triangle's plane: the mean of its two sides
  return std::atan2(det, den) / (2 * std::numbers::pi);
}

Vec3 nearestOnSegment(const TriangleTree::Triangle& t, int i, int j, const Vec3& p) {
  const Vec3 d = t[j] - t[i];
  const double length2 = d.squaredNorm();
  const double s = length2 > 0 ? std::clamp((p - t[i]).dot(d) / length2, 0.0, 1.0) : 0.0;
  Vec3 b = Vec3::Zero();
  b[i] = 1 - s;
  b[j] += s;
  return b;
}

}  // namespace

Vec3 nearestOnTriangle(const TriangleTree::Triangle& t, const Vec3& p) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  const double area2 = n.squaredNorm();
  const double longest2 =
      std::max({(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  // Thinner than rounding: its edges say all.
  if (area2 > 1e-28 * longest2 * longest2) {
    const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const Vec3 w(n.dot(b.cross(c)), n.dot(c.cross(a)), n.dot(a.cross(b)));
    if (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) {
      const double sum = w.sum();
      if (sum > 0) return w / sum;
    }
  }
  Vec3 best = nearestOnSegment(t, 0, 1, p);
  double bestDistance = (point(t, best) - p).squaredNorm();
  for (int i = 1; i < 3; ++i) {
    const Vec3 b = nearestOnSegment(t, i, (i + 1) % 3, p);
    const double d = (point(t, b) - p).squaredNorm();
    if (d < bestDistance) {
      bestDistance = d;
      best = b;
    }
  }
  return best;
}

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  if (triangles_.empty()) return;
  const auto count = Eigen::Index(triangles_.size());
  Eigen::MatrixXd V(3 * count, 3);
  Eigen::MatrixXi F(count, 3);
  for (Eigen::Index t = 0; t < count; ++t)
    for (int k = 0; k < 3; ++k) {
      V.row(3 * t + k) = triangles_[std::size_t(t)][std::size_t(k)].transpose();
      F(t, k) = int(3 * t + k);
    }
  IglTree tree;
  tree.init(V, F);
  nodes_.reserve(2 * triangles_.size());
  copyTree(&tree);
  std::vector<std::uint32_t> below;
  gather(0, below);
}

std::uint32_t TriangleTree::copyTree(const void* opaque) {
  const auto& tree = *static_cast<const IglTree*>(opaque);
  const auto index = std::uint32_t(nodes_.size());
  nodes_.emplace_back();
  if (tree.is_leaf()) nodes_[index].triangle = std::uint32_t(tree.m_primitive);
  const std::uint32_t left = tree.m_left ? copyTree(tree.m_left) : kNone;
  const std::uint32_t right = tree.m_right ? copyTree(tree.m_right) : kNone;
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

TriangleTree::Far TriangleTree::farField(std::span<const std::uint32_t> triangles) const {
  Far far;
  double area = 0;
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t i : triangles) {
    const Triangle& t = triangles_[i];
    const double a = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
    area += a;
    far.centre += a * (t[0] + t[1] + t[2]) / 3;
    middle += (t[0] + t[1] + t[2]) / (3 * double(triangles.size()));
  }
  far.centre = area > 0 ? Vec3(far.centre / area) : middle;
  for (std::uint32_t i : triangles) {
    const Triangle& t = triangles_[i];
    const Vec3 normal = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
    const Vec3 d[3] = {t[0] - far.centre, t[1] - far.centre, t[2] - far.centre};
    const Vec3 sum = d[0] + d[1] + d[2];
    Mat3 square = sum * sum.transpose();
    for (const Vec3& x : d) {
      square += x * x.transpose();
      far.radius = std::max(far.radius, x.norm());
    }
    far.dipole += normal;
    far.moment += sum / 3 * normal.transpose();
    for (int k = 0; k < 3; ++k) far.second[std::size_t(k)] += normal[k] / 12 * square;
  }
  return far;
}

void TriangleTree::gather(std::uint32_t index, std::vector<std::uint32_t>& below) {
  const std::size_t first = below.size();
  Node& node = nodes_[index];
  node.lo = Vec3::Constant(kInfinity);
  node.hi = -node.lo;
  if (node.triangle != kNone) {
    below.push_back(node.triangle);
    for (const Vec3& p : triangles_[node.triangle]) {
      node.lo = node.lo.cwiseMin(p);
      node.hi = node.hi.cwiseMax(p);
    }
    return;
  }
  for (std::uint32_t child : {node.left, node.right}) {
    gather(child, below);
    node.lo = node.lo.cwiseMin(nodes_[child].lo);
    node.hi = node.hi.cwiseMax(nodes_[child].hi);
  }
  if (below.size() - first < kFewTriangles) return;
  node.far = std::uint32_t(far_.size());
  far_.push_back(farField(std::span(below).subspan(first)));
}

TriangleTree::Hit TriangleTree::nearest(const Vec3& p) const {
  Hit best;
  double best2 = kInfinity;
  if (empty()) {
    best.distance = kInfinity;
    return best;
  }
  std::array<std::pair<double, std::uint32_t>, kMaxStack> stack;
  std::size_t top = 0;
  stack[top++] = {boxDistance2(nodes_[0].lo, nodes_[0].hi, p), 0};
  while (top > 0) {
    const auto [distance2, index] = stack[--top];
    if (distance2 > best2) continue;
    const Node& node = nodes_[index];
    if (node.triangle != kNone) {
      const Vec3 b = nearestOnTriangle(triangles_[node.triangle], p);
      const double d2 = (point(triangles_[node.triangle], b) - p).squaredNorm();
      if (d2 < best2 || (d2 == best2 && node.triangle < best.triangle)) {
        best2 = d2;
        best = {node.triangle, b, 0};
      }
      continue;
    }
    const double l = boxDistance2(nodes_[node.left].lo, nodes_[node.left].hi, p);
    const double r = boxDistance2(nodes_[node.right].lo, nodes_[node.right].hi, p);
    stack[top++] = l <= r ? std::pair{r, node.right} : std::pair{l, node.left};
    stack[top++] = l <= r ? std::pair{l, node.left} : std::pair{r, node.right};
  }
  best.distance = std::sqrt(best2);
  return best;
}

TriangleTree::Hit TriangleTree::intersect(const Vec3& origin, const Vec3& direction, double maxT) const {
  Hit best;
  best.distance = maxT;
  if (empty() || !(direction.squaredNorm() > 0)) return best;
  const Vec3 inverse = direction.cwiseInverse();
  std::array<std::uint32_t, kMaxStack> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (boxEntry(node.lo, node.hi, origin, inverse, best.distance) == kInfinity) continue;
    if (node.triangle == kNone) {
      stack[top++] = node.right;
      stack[top++] = node.left;
      continue;
    }
    Vec3 b;
    double t = 0;
    if (!rayTriangle(triangles_[node.triangle], origin, direction, b, t) || !(t > 0)) continue;
    if (t < best.distance || (t == best.distance && node.triangle < best.triangle))
      best = {node.triangle, b, t};
  }
  return best;
}

double TriangleTree::windingNumber(const Vec3& p, double beta) const {
  if (empty()) return 0;
  double sum = 0;
  std::array<std::uint32_t, kMaxStack> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (node.triangle != kNone) {
      sum += solidAngle(triangles_[node.triangle], p);
      continue;
    }
    const Far* far = node.far == kNone ? nullptr : &far_[node.far];
    const Vec3 r = far == nullptr ? p : Vec3(far->centre - p);
    const double d2 = r.squaredNorm();
    if (far == nullptr || d2 <= beta * beta * far->radius * far->radius) {
      stack[top++] = node.right;
      stack[top++] = node.left;
      continue;
    }
    const double d = std::sqrt(d2), inverse3 = 1 / (d2 * d) / (4 * std::numbers::pi);
    // Taylor series of r/|r|³ about the centre: its value, gradient and second derivatives on the moments.
    double trace = 0, cubic = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 sr = far->second[std::size_t(k)] * r;
      trace += far->second[std::size_t(k)].trace() * r[k] + 2 * sr[k];
      cubic += r[k] * r.dot(sr);
    }
    sum += inverse3 * (far->dipole.dot(r) + far->moment.trace() - 3 * r.dot(far->moment * r) / d2 +
                       (7.5 * cubic / d2 - 1.5 * trace) / d2);
  }
  return sum;
}

}  // namespace coif
