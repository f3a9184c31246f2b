#include "coif/scalp/triangulation.h"

#include <Eigen/Geometry>

namespace coif {
namespace {

/// Twice the signed area of (a, b, c) seen along `normal`.
double turn(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  return (b - a).cross(c - a).dot(normal);
}

bool contains(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& normal) {
  return turn(a, b, p, normal) >= 0 && turn(b, c, p, normal) >= 0 && turn(c, a, p, normal) >= 0;
}

/// Beyond this ear clipping's cubic worst case could hang; such a polygon is fanned.
constexpr std::size_t kMaxEarCorners = 1000;

class PolygonSplitter {
 public:
  PolygonSplitter(const PolygonMesh& mesh, Triangulation& out) : mesh_(mesh), out_(out) {}

  void split(std::uint32_t face) {
    face_ = face;
    first_ = mesh_.faceOffsets[face];
    points_.clear();
    for (std::uint32_t v : mesh_.face(face)) points_.push_back(mesh_.positions[v]);
    // Scaled so that products of lengths neither overflow nor vanish.
    const Box box = bounds(points_);
    const double size = box.diagonal();
    if (size > 0)
      for (Vec3& p : points_) p = (p - box.lo) / size;
    normal_ = newellNormal(points_);
    if (points_.size() > kMaxEarCorners || fanIsValid()) {
      for (std::uint32_t i = 1; i + 1 < points_.size(); ++i) emit(0, i, i + 1);
    } else {
      clipEars();
    }
  }

 private:
  bool fanIsValid() const {
    for (std::size_t i = 1; i + 1 < points_.size(); ++i)
      if (turn(points_[0], points_[i], points_[i + 1], normal_) < 0) return false;
    return true;
  }

  void clipEars() {
    ring_.resize(points_.size());
    for (std::uint32_t i = 0; i < ring_.size(); ++i) ring_[i] = i;
    while (ring_.size() > 3) {
      const std::size_t ear = findEar();
      const std::size_t n = ring_.size();
      emit(ring_[(ear + n - 1) % n], ring_[ear], ring_[(ear + 1) % n]);
      ring_.erase(ring_.begin() + std::ptrdiff_t(ear));
    }
    emit(ring_[0], ring_[1], ring_[2]);
  }

  /// A convex corner whose triangle holds no other corner; a self-crossing polygon may have none: then the
  /// first.
  std::size_t findEar() const {
    const std::size_t n = ring_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t ia = ring_[(i + n - 1) % n], ib = ring_[i], ic = ring_[(i + 1) % n];
      const Vec3 &a = points_[ia], &b = points_[ib], &c = points_[ic];
      if (turn(a, b, c, normal_) <= 0) continue;
      bool empty = true;
      for (std::uint32_t j : ring_)
        if (j != ia && j != ib && j != ic && contains(a, b, c, points_[j], normal_)) {
          empty = false;
          break;
        }
      if (empty) return i;
    }
    return 0;
  }

  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    out_.triangles.push_back({first_ + a, first_ + b, first_ + c});
    out_.faces.push_back(face_);
  }

  const PolygonMesh& mesh_;
  Triangulation& out_;
  std::uint32_t face_ = 0, first_ = 0;
  Vec3 normal_ = Vec3::Zero();
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> ring_;
};

bool usable(const PolygonMesh& mesh, std::size_t f) {
  if (mesh.faceOffsets[f + 1] < mesh.faceOffsets[f] + 3 || mesh.faceOffsets[f + 1] > mesh.corners.size())
    return false;
  for (std::uint32_t v : mesh.face(f))
    if (v >= mesh.vertexCount() || !mesh.positions[v].allFinite()) return false;
  return true;
}

}  // namespace

Triangulation triangulate(const PolygonMesh& mesh) {
  Triangulation out;
  out.triangles.reserve(mesh.corners.size());
  PolygonSplitter splitter(mesh, out);
  for (std::size_t f = 0; f < mesh.faceCount(); ++f)
    if (usable(mesh, f)) splitter.split(std::uint32_t(f));
  return out;
}

}  // namespace coif
