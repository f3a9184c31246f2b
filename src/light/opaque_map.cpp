#include "coif/light/opaque_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coif/base/parallel.h"
#include "coif/light/fragments.h"

namespace coif {
namespace {

constexpr double kMostPushTexels = 8;  // a surface seen at 83°: steeper ones hardly catch light

using Triangle = std::array<Vec3, 3>;  // projected

// Splits a triangle at the near plane of a point light: none, one or two remain.
void projectTriangle(const LightView& view, const std::array<Vec3, 3>& world, std::vector<Triangle>& out) {
  std::vector<Vec3> kept(world.begin(), world.end());
  if (view.perspective) {
    const double near = kNearFraction * view.depthRange;
    kept.clear();
    for (int c = 0; c < 3; ++c) {
      const Vec3 &p = world[std::size_t(c)], &q = world[std::size_t((c + 1) % 3)];
      const double zp = (p - view.eye).dot(view.forward) - near, zq = (q - view.eye).dot(view.forward) - near;
      if (zp > 0) kept.push_back(p);
      if ((zp > 0) != (zq > 0)) kept.push_back(p + zp / (zp - zq) * (q - p));
    }
  }
  for (std::size_t c = 1; c + 1 < kept.size(); ++c) {
    Triangle t{view.project(kept[0]), view.project(kept[c]), view.project(kept[c + 1])};
    if (t[0].allFinite() && t[1].allFinite() && t[2].allFinite()) out.push_back(t);
  }
}

// value = c.x + c.y x + c.z y through the triangle's corners.
struct Plane {
  Vec3 c = Vec3::Zero();
  double at(double x, double y) const { return c.x() + c.y() * x + c.z() * y; }
};

struct Setup {
  Plane u, v, depth;  ///< barycentric of corners 1 and 2; z, or 1 / z for a point light
  bool flat = true;
};

Setup setUp(const Triangle& t, bool perspective) {
  Setup s;
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0];
  const double area = e1.x() * e2.y() - e1.y() * e2.x();
  if (!(std::abs(area) > 0)) return s;
  s.flat = false;
  const auto plane = [&](double f0, double f1, double f2) {
    Plane p;
    p.c.y() = ((f1 - f0) * e2.y() - (f2 - f0) * e1.y()) / area;
    p.c.z() = ((f2 - f0) * e1.x() - (f1 - f0) * e2.x()) / area;
    p.c.x() = f0 - p.c.y() * t[0].x() - p.c.z() * t[0].y();
    return p;
  };
  s.u = plane(0, 1, 0);
  s.v = plane(0, 0, 1);
  const auto value = [&](const Vec3& p) { return perspective ? 1 / p.z() : p.z(); };
  s.depth = plane(value(t[0]), value(t[1]), value(t[2]));
  return s;
}

void draw(const Triangle& t, const LightView& view, int rowBegin, int rowEnd, std::vector<float>& depths) {
  const Setup s = setUp(t, view.perspective);
  if (s.flat) return;
  const auto range = [&](int axis, int begin, int end) {
    const auto [lo, hi] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    return std::array{int(std::ceil(std::clamp(lo - 0.5, double(begin), double(end)))),
                      int(std::ceil(std::clamp(hi - 0.5, double(begin), double(end))))};
  };
  const auto [x0, x1] = range(0, 0, view.size);
  const auto [y0, y1] = range(1, rowBegin, rowEnd);
  const double slope = 0.5 * (std::abs(s.depth.c.y()) + std::abs(s.depth.c.z()));
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const double u = s.u.at(x + 0.5, y + 0.5), v = s.v.at(x + 0.5, y + 0.5);
      if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
      const double at = s.depth.at(x + 0.5, y + 0.5);
      const double z = view.perspective ? 1 / at : at;
      const double push =
          std::min(view.perspective ? z * z * slope : slope, kMostPushTexels * view.texelAt(z));
      float& depth = depths[std::size_t(y) * std::size_t(view.size) + std::size_t(x)];
      depth = std::min(depth, float(z + push));
    }
  }
}

}  // namespace

Result<OpaqueMap> OpaqueMap::make(const PolygonMesh& mesh, const LightView& view, const Context& context) {
  COIF_TRY(validate(mesh));
  if (view.size < 1) return makeError(ErrorCode::InvalidArgument, "a map needs at least one texel");
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t c = 1; c + 1 < face.size(); ++c) {
      projectTriangle(view, {mesh.positions[face[0]], mesh.positions[face[c]], mesh.positions[face[c + 1]]},
                      triangles);
    }
  }
  OpaqueMap map;
  map.view_ = view;
  map.depths_.assign(std::size_t(view.size) * std::size_t(view.size), std::numeric_limits<float>::infinity());
  constexpr std::size_t kRows = 64;
  parallelFor(context, std::size_t(view.size), kRows, [&](std::size_t begin, std::size_t end) {
    for (const Triangle& t : triangles) draw(t, view, int(begin), int(end), map.depths_);
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the shadow map was cancelled");
  return map;
}

bool OpaqueMap::blocks(const Vec3& world) const {
  const Vec3 p = view_.project(world);
  if (!(p.z() > 0 || !view_.perspective) || !(p.x() >= 0 && p.x() < view_.size) ||
      !(p.y() >= 0 && p.y() < view_.size)) {
    return false;
  }
  return blocksTexel(std::size_t(p.y()) * std::size_t(view_.size) + std::size_t(p.x()), p.z());
}

}  // namespace coif
