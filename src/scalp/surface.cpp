#include "coif/scalp/surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "coif/base/check.h"
#include "coif/base/parallel.h"
#include "coif/scalp/triangulation.h"
#include "triangle_tree.h"

namespace coif {
namespace {

// Far field beyond this many radii; the error it leaves is measured in surface_test.cpp.
constexpr double kWindingBeta = 3;

}  // namespace

struct Surface::Impl {
  PolygonMesh mesh;
  Triangulation triangulation;
  std::vector<Vec3> vertexNormals;
  TriangleTree tree;  // in units of the bounding box's diagonal, about its middle
  Vec3 centre = Vec3::Zero();
  double scale = 1;
  double size = 0;

  Vec3 toTree(const Vec3& p) const { return (p - centre) / scale; }

  std::uint32_t vertex(std::uint32_t triangle, int corner) const {
    return mesh.corners[triangulation.triangles[triangle][std::size_t(corner)]];
  }

  void build(const Context& context) {
    context.report("triangles of the head", 0.2);
    triangulation = triangulate(mesh);
    size = bounds(mesh.positions).diagonal();
    const std::size_t count = triangulation.triangles.size();
    Box box;
    if (count > 0) box.lo = box.hi = mesh.positions[vertex(0, 0)];
    for (std::uint32_t t = 0; t < count; ++t) {
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = mesh.positions[vertex(t, k)];
        box.lo = box.lo.cwiseMin(p), box.hi = box.hi.cwiseMax(p);
      }
    }
    centre = 0.5 * box.lo + 0.5 * box.hi;
    if (const double d = box.diagonal(); d > 0 && std::isfinite(d)) scale = d;
    context.report("normals of the head", 0.35);
    std::vector<TriangleTree::Triangle> triangles(count);
    vertexNormals.assign(mesh.vertexCount(), Vec3::Zero());
    for (std::size_t t = 0; t < count; ++t) {
      for (int k = 0; k < 3; ++k)
        triangles[t][std::size_t(k)] = toTree(mesh.positions[vertex(std::uint32_t(t), k)]);
      const Vec3 n = (triangles[t][1] - triangles[t][0]).cross(triangles[t][2] - triangles[t][0]);
      for (int k = 0; k < 3; ++k) vertexNormals[vertex(std::uint32_t(t), k)] += n;
    }
    for (Vec3& n : vertexNormals)
      if (const double length = n.norm(); length > 0) n /= length;
    context.report("search tree of the head", 0.5);
    if (!context.cancelled()) tree = TriangleTree(std::move(triangles), context);
  }

  Vec3 faceNormal(std::uint32_t triangle) const {
    const Vec3 a = toTree(mesh.positions[vertex(triangle, 0)]);
    const Vec3 n = (toTree(mesh.positions[vertex(triangle, 1)]) - a)
                       .cross(toTree(mesh.positions[vertex(triangle, 2)]) - a);
    const double length = n.norm();
    return length > 0 ? Vec3(n / length) : Vec3::UnitZ();
  }

  SurfacePoint at(std::uint32_t triangle, const Vec3& barycentric) const {
    SurfacePoint s;
    s.triangle = triangle;
    s.face = triangulation.faces[triangle];
    s.barycentric = barycentric;
    for (int k = 0; k < 3; ++k) {
      s.position += barycentric[k] * mesh.positions[vertex(triangle, k)];
      s.normal += barycentric[k] * vertexNormals[vertex(triangle, k)];
    }
    const double length = s.normal.norm();
    // Opposite vertex normals may cancel (a folded or zero-area face).
    s.normal = length > 1e-6 ? Vec3(s.normal / length) : faceNormal(triangle);
    return s;
  }
};

Surface::Surface(const PolygonMesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->mesh = mesh;
  impl_->build({});
}
Surface::Surface(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Result<Surface> Surface::create(PolygonMesh mesh, const Context& context) {
  auto impl = std::make_unique<Impl>();
  impl->mesh = std::move(mesh);
  impl->build(context);
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped while the head was read");
  return Surface(std::move(impl));
}
Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

SurfacePoint Surface::nearest(const Vec3& point) const {
  const Vec3 p = impl_->toTree(point);
  SurfacePoint s;
  s.position = point;
  s.normal = Vec3::UnitZ();
  s.distance = std::numeric_limits<double>::infinity();
  if (impl_->tree.empty() || !p.allFinite()) return s;
  const TriangleTree::Hit hit = impl_->tree.nearest(p);
  if (hit.triangle == kNone) return s;
  s = impl_->at(hit.triangle, hit.barycentric);
  s.distance = hit.distance * impl_->scale;
  return s;
}

bool Surface::intersect(const Vec3& origin, const Vec3& direction, double maxT, SurfacePoint& hit) const {
  const double length = direction.norm();
  const Vec3 o = impl_->toTree(origin);
  if (!(length > 0) || !std::isfinite(length) || !o.allFinite()) return false;
  const TriangleTree::Hit h = impl_->tree.intersect(o, direction / length, maxT * length / impl_->scale);
  if (h.triangle == kNone) return false;
  hit = impl_->at(h.triangle, h.barycentric);
  hit.distance = h.distance * impl_->scale;
  return true;
}

double Surface::windingNumber(const Vec3& point) const {
  const Vec3 p = impl_->toTree(point);
  return p.allFinite() ? impl_->tree.windingNumber(p, kWindingBeta) : 0;
}

double Surface::signedDistance(const Vec3& point) const {
  const double d = nearest(point).distance;
  return windingNumber(point) > 0.5 ? -d : d;
}

bool Surface::uv(const SurfacePoint& point, Vec2& uv) const {
  if (impl_->mesh.cornerUvs.empty() || point.triangle >= triangleCount()) return false;
  uv = Vec2::Zero();
  for (int k = 0; k < 3; ++k)
    uv += point.barycentric[k] *
          impl_->mesh.cornerUvs[impl_->triangulation.triangles[point.triangle][std::size_t(k)]];
  return true;
}

void Surface::windingNumbers(const Context& context, std::span<const Vec3> points,
                             std::span<double> out) const {
  COIF_CHECK(points.size() == out.size(), "one winding number a point");
  parallelFor(context, points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = windingNumber(points[i]);
  });
}

SurfacePoint Surface::at(std::uint32_t triangle, const Vec3& barycentric) const {
  COIF_CHECK(triangle < triangleCount(), "a triangle of this surface");
  return impl_->at(triangle, barycentric);
}

std::array<std::uint32_t, 3> Surface::triangleVertices(std::uint32_t triangle) const {
  COIF_CHECK(triangle < triangleCount(), "a triangle of this surface");
  return {impl_->vertex(triangle, 0), impl_->vertex(triangle, 1), impl_->vertex(triangle, 2)};
}

std::uint32_t Surface::triangleFace(std::uint32_t triangle) const {
  COIF_CHECK(triangle < triangleCount(), "a triangle of this surface");
  return impl_->triangulation.faces[triangle];
}

std::size_t Surface::triangleCount() const {
  return impl_->triangulation.triangles.size();
}
const PolygonMesh& Surface::mesh() const {
  return impl_->mesh;
}
double Surface::size() const {
  return impl_->size;
}

}  // namespace coif
