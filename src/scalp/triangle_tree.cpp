#include "triangle_tree.h"

#include <igl/AABB.h>

#include <algorithm>
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
constexpr std::uint32_t kFewTriangles = 8;

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

namespace {

/// Triangles below, in the order of the leaves.
void gather(const IglTree& tree, std::vector<std::uint32_t>& out) {
  if (tree.is_leaf()) out.push_back(std::uint32_t(tree.m_primitive));
  if (tree.m_left) gather(*tree.m_left, out);
  if (tree.m_right) gather(*tree.m_right, out);
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles, const Context& context)
    : moments_(std::make_unique<Moments>()) {
  const auto count = Eigen::Index(triangles.size());
  if (count == 0) return;
  IglTree tree;
  {
    Eigen::MatrixXd V(3 * count, 3);
    Eigen::MatrixXi F(count, 3);
    for (Eigen::Index t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k) {
        V.row(3 * t + k) = triangles[std::size_t(t)][std::size_t(k)].transpose();
        F(t, k) = int(3 * t + k);
      }
    if (context.cancelled()) return;
    tree.init(V, F);
  }
  if (context.cancelled()) return;
  number_.reserve(triangles.size()), nodes_.reserve(triangles.size());
  copyTree(&tree);
  triangles_.reserve(triangles.size());
  for (const std::uint32_t t : number_) triangles_.push_back(triangles[t]);
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children come after their parents
    Node& node = nodes_[n];
    node.lo = Vec3::Constant(kInfinity), node.hi = -node.lo;
    if (node.right != kNone) {
      node.lo = nodes_[n + 1].lo.cwiseMin(nodes_[node.right].lo);
      node.hi = nodes_[n + 1].hi.cwiseMax(nodes_[node.right].hi);
    } else {
      for (std::uint32_t t = node.first; t < node.first + node.count; ++t)
        for (const Vec3& p : triangles_[t]) node.lo = node.lo.cwiseMin(p), node.hi = node.hi.cwiseMax(p);
    }
  }
}

void TriangleTree::copyTree(const void* opaque) {
  const auto& tree = *static_cast<const IglTree*>(opaque);
  const auto index = std::uint32_t(nodes_.size()), first = std::uint32_t(number_.size());
  nodes_.emplace_back().first = first;
  // Leaves of up to four: as quick to look at as two more boxes.
  const auto isLeaf = [](const IglTree* t) { return t == nullptr || t->is_leaf(); };
  const auto isPair = [&](const IglTree* t) {
    return isLeaf(t) || (isLeaf(t->m_left) && isLeaf(t->m_right));
  };
  if (tree.is_leaf() || (isPair(tree.m_left) && isPair(tree.m_right))) {
    gather(tree, number_);
    std::sort(number_.begin() + first, number_.end());
  } else {
    copyTree(tree.m_left);
    nodes_[index].right = std::uint32_t(nodes_.size());
    copyTree(tree.m_right);
  }
  nodes_[index].count = std::uint32_t(number_.size()) - first;
}

TriangleTree::Far TriangleTree::sumOf(const Node& node) const {
  Far far;
  Vec3 middle = Vec3::Zero();
  const auto triangles = std::span(triangles_).subspan(node.first, node.count);
  for (const Triangle& t : triangles) {
    const double a = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
    far.area += a;
    far.centre += a * (t[0] + t[1] + t[2]) / 3;
    middle += (t[0] + t[1] + t[2]) / (3 * double(node.count));
  }
  far.centre = far.area > 0 ? Vec3(far.centre / far.area) : middle;
  for (const Triangle& t : triangles) {
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

/// Moments about another centre: d + e for d. Exact but for rounding.
TriangleTree::Far TriangleTree::joined(const Far& a, const Far& b, const Node& node) const {
  Far far;
  far.area = a.area + b.area;
  far.centre = far.area > 0 ? Vec3((a.area * a.centre + b.area * b.centre) / far.area)
                            : Vec3(0.5 * (a.centre + b.centre));
  const Vec3 farthest = (node.hi - far.centre).cwiseMax(far.centre - node.lo);
  for (const Far* part : {&a, &b}) {
    const Vec3 e = part->centre - far.centre;
    far.radius = std::max(far.radius, e.norm() + part->radius);
    far.dipole += part->dipole;
    far.moment += part->moment + e * part->dipole.transpose();
    for (int k = 0; k < 3; ++k) {
      const Vec3 first = part->moment.col(k);
      far.second[std::size_t(k)] += part->second[std::size_t(k)] + first * e.transpose() +
                                    e * first.transpose() + part->dipole[k] * (e * e.transpose());
    }
  }
  far.radius = std::min(far.radius, farthest.norm());
  return far;
}

void TriangleTree::findMoments() const {
  std::vector<std::uint32_t>& of = moments_->of;
  of.assign(nodes_.size(), kNone);
  std::uint32_t count = 0;
  for (std::size_t n = nodes_.size(); n-- > 0;)
    if (nodes_[n].count >= kFewTriangles) of[n] = count++;
  moments_->far.resize(count);
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    if (of[n] == kNone) continue;
    const std::uint32_t left = of[n + 1], right = of[nodes_[n].right];
    const bool known = left != kNone && right != kNone;
    moments_->far[of[n]] =
        known ? joined(moments_->far[left], moments_->far[right], nodes_[n]) : sumOf(nodes_[n]);
  }
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
    if (node.right == kNone) {
      for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
        const Vec3 b = nearestOnTriangle(triangles_[t], p);
        const double d2 = (point(triangles_[t], b) - p).squaredNorm();
        if (d2 < best2 || (d2 == best2 && number_[t] < best.triangle)) {
          best2 = d2;
          best = {number_[t], b, 0};
        }
      }
      continue;
    }
    const std::uint32_t left = index + 1;
    const double l = boxDistance2(nodes_[left].lo, nodes_[left].hi, p);
    const double r = boxDistance2(nodes_[node.right].lo, nodes_[node.right].hi, p);
    stack[top++] = l <= r ? std::pair{r, node.right} : std::pair{l, left};
    stack[top++] = l <= r ? std::pair{l, left} : std::pair{r, node.right};
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
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    if (boxEntry(node.lo, node.hi, origin, inverse, best.distance) == kInfinity) continue;
    if (node.right != kNone) {
      stack[top++] = node.right;
      stack[top++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      Vec3 b;
      double t = 0;
      if (!rayTriangle(triangles_[i], origin, direction, b, t) || !(t > 0)) continue;
      if (t < best.distance || (t == best.distance && number_[i] < best.triangle)) best = {number_[i], b, t};
    }
  }
  return best;
}

double TriangleTree::windingNumber(const Vec3& p, double beta) const {
  if (empty()) return 0;
  std::call_once(moments_->found, [this] { findMoments(); });
  double sum = 0;
  std::array<std::uint32_t, kMaxStack> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    if (node.right == kNone) {
      for (std::uint32_t t = node.first; t < node.first + node.count; ++t)
        sum += solidAngle(triangles_[t], p);
      continue;
    }
    const std::uint32_t of = moments_->of[index];
    const Far* far = of == kNone ? nullptr : &moments_->far[of];
    const Vec3 r = far == nullptr ? p : Vec3(far->centre - p);
    const double d2 = r.squaredNorm();
    if (far == nullptr || d2 <= beta * beta * far->radius * far->radius) {
      stack[top++] = node.right;
      stack[top++] = index + 1;
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
