#include "io/gltf_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "coif/scalp/triangulation.h"

namespace coif::io {
namespace {

Vec3 anyPerpendicular(const Vec3& t) {
  const Vec3 axis = std::abs(t.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
  return t.cross(axis).normalized();
}

struct Frame {
  Vec3 position, tangent, normal;
};

/// A frame a point; the normal turns as little as it can while facing away from the centre. Empty without
/// length.
std::vector<Frame> framesOf(std::span<const Vec3f> points, const Vec3& centre) {
  std::vector<Frame> frames(points.size());
  Vec3 tangent = Vec3::Zero();
  for (std::size_t i = 0; i + 1 < points.size() && tangent.isZero(); ++i) {
    tangent = (points[i + 1] - points[i]).cast<double>().stableNormalized();
  }
  if (tangent.isZero()) return {};
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i].cast<double>();
    const Vec3 ahead = points[std::min(i + 1, points.size() - 1)].cast<double>();
    const Vec3 chord = ahead - points[i == 0 ? 0 : i - 1].cast<double>();
    if (!chord.isZero(0)) tangent = chord.stableNormalized();
    Vec3 away = p - centre;
    away -= away.dot(tangent) * tangent;
    constexpr double kSmall = 1e-6;  // of the distance: below it the direction is noise
    if (away.norm() <= kSmall * (p - centre).norm()) away = normal - normal.dot(tangent) * tangent;
    away = away.norm() > kSmall * kSmall ? Vec3(away.stableNormalized()) : anyPerpendicular(tangent);
    if (away.dot(normal) < 0) away = -away;
    normal = away;
    frames[i] = {p, tangent, normal};
  }
  return frames;
}

/// Σ width × length over strands [0, count): what they cover seen from the side.
double coverage(const StrandSet& set, std::size_t count) {
  double sum = 0;
  for (std::size_t s = 0; s < count; ++s) {
    for (std::size_t p = set.offsets[s]; p + 1 < set.offsets[s + 1]; ++p) {
      sum +=
          0.5 * (widthAt(set, p) + widthAt(set, p + 1)) * double((set.points[p + 1] - set.points[p]).norm());
    }
  }
  return sum;
}

Vec3 centreOfRoots(const StrandSet& set) {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    if (set.strand(s).empty()) continue;
    sum += set.strand(s)[0].cast<double>();
    ++count;
  }
  return sum / double(std::max<std::size_t>(count, 1));
}

/// Joins ring i to ring i + 1 of `columns` vertices each, two triangles a column.
void addRows(TriangleMesh& mesh, std::uint32_t first, std::size_t rows, std::uint32_t columns) {
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    for (std::uint32_t c = 0; c + 1 < columns; ++c) {
      const std::uint32_t a = first + row * columns + c, b = a + 1, d = a + columns, e = d + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, e, a, e, d});
    }
  }
}

void addVertex(TriangleMesh& mesh, const Vec3& position, const Vec3& normal, double u, double v) {
  mesh.positions.push_back(position.cast<float>());
  mesh.normals.push_back(normal.cast<float>());
  mesh.uvs.emplace_back(float(u), float(v));
}

}  // namespace

TriangleMesh strandShapes(const StrandSet& set, StrandMesh shape, std::size_t limit) {
  TriangleMesh mesh;
  const std::size_t count = std::min(limit, set.strandCount());
  const double shown = coverage(set, count);
  const double widen = shown > 0 ? coverage(set, set.strandCount()) / shown : 1;
  const Vec3 centre = centreOfRoots(set);
  constexpr int kSides = 3;
  // A convex cylinder's mean width is its perimeter / π (Cauchy); three sides of circumradius r give 3√3 r /
  // π, where the round hair has 2r.
  const double prismRadius = std::numbers::pi / (3 * std::numbers::sqrt3);
  for (std::size_t s = 0; s < count; ++s) {
    const std::vector<Frame> frames = framesOf(set.strand(s), centre);
    const auto first = std::uint32_t(mesh.positions.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto& [position, tangent, normal] = frames[i];
      const double width = widen * widthAt(set, set.offsets[s] + i);
      const double v = double(i) / double(frames.size() - 1);
      const Vec3 side = tangent.cross(normal);
      if (shape == StrandMesh::Cards) {
        addVertex(mesh, position - 0.5 * width * side, normal, 0, v);
        addVertex(mesh, position + 0.5 * width * side, normal, 1, v);
        continue;
      }
      for (int k = 0; k <= kSides; ++k) {  // the last repeats the first with u = 1
        const double angleRad = 2 * std::numbers::pi * (k % kSides) / kSides;
        const Vec3 out = std::cos(angleRad) * normal + std::sin(angleRad) * side;
        addVertex(mesh, position + width * prismRadius * out, out, double(k) / kSides, v);
      }
    }
    addRows(mesh, first, frames.size(), shape == StrandMesh::Cards ? 2 : kSides + 1);
  }
  return mesh;
}

Result<TriangleMesh> trianglesOf(const PolygonMesh& mesh) {
  std::vector<Vec3> normals = vertexNormals(mesh);
  for (Vec3& normal : normals) {
    if (normal.isZero(1e-3)) normal = Vec3::UnitY();  // no face, or faces that cancel
  }
  const bool hasUvs = !mesh.cornerUvs.empty();
  std::vector<std::uint32_t> order(mesh.corners.size());
  for (std::uint32_t c = 0; c < order.size(); ++c) order[c] = c;
  const auto key = [&](std::uint32_t c) {
    const Vec2 uv = hasUvs ? mesh.cornerUvs[c] : Vec2(0, 0);
    return std::tuple(mesh.corners[c], float(uv.x()), float(uv.y()));
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });

  TriangleMesh out;
  std::vector<std::uint32_t> vertexOf(mesh.corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t corner = order[i], v = mesh.corners[corner];
    if (i == 0 || key(order[i - 1]) != key(corner)) {
      out.positions.push_back(mesh.positions[v].cast<float>());
      if (!out.positions.back().allFinite()) {
        return makeError(ErrorCode::Degenerate, "a position is beyond the range of float",
                         "vertex " + std::to_string(v));
      }
      out.normals.push_back(normals[v].cast<float>());
      // glTF counts v downwards from the image's top.
      if (hasUvs)
        out.uvs.emplace_back(float(mesh.cornerUvs[corner].x()), float(1 - mesh.cornerUvs[corner].y()));
    }
    vertexOf[corner] = std::uint32_t(out.positions.size() - 1);
  }
  for (const auto& triangle : triangulate(mesh).triangles) {
    for (const std::uint32_t corner : triangle) out.indices.push_back(vertexOf[corner]);
  }
  return out;
}

PolygonMesh outsideOf(const HairMesh& mesh) {
  PolygonMesh out;
  for (const HairVertex& vertex : mesh.vertices()) out.positions.push_back(vertex.position);
  for (const Bundle& bundle : mesh.bundles()) {
    const auto root = bundle.face(0);
    if (bundle.height() == 0) {
      out.addFace(root);
      continue;
    }
    const std::vector<std::uint32_t> turned(root.rbegin(), root.rend());  // seen from below
    out.addFace(turned);
    out.addFace(bundle.face(bundle.height()));
  }
  for (const SideQuad& quad : sideQuads(mesh)) {
    if (quad.exposed) out.addFace(std::array{quad.a, quad.b, quad.d, quad.c});
  }
  return out;
}

}  // namespace coif::io
