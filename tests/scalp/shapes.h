// Meshes with known answers.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "coif/base/random.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif::test {

inline void addFace(PolygonMesh& mesh, std::initializer_list<std::uint32_t> vertices) {
  mesh.addFace(std::span(vertices.begin(), vertices.size()));
}

/// Unit cube [0, 1]³ of quads.
inline PolygonMesh cube() {
  PolygonMesh m;
  for (int i = 0; i < 8; ++i) m.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  addFace(m, {0, 2, 3, 1});
  addFace(m, {4, 5, 7, 6});
  addFace(m, {0, 1, 5, 4});
  addFace(m, {2, 6, 7, 3});
  addFace(m, {0, 4, 6, 2});
  addFace(m, {1, 3, 7, 5});
  return m;
}

/// Icosahedron, subdivided `levels` times and pushed to the unit sphere: 20·4^levels triangles.
inline PolygonMesh sphere(int levels) {
  PolygonMesh m;
  const double g = std::numbers::phi;
  for (double s : {-1.0, 1.0})
    for (double t : {-g, g}) {
      m.positions.emplace_back(s, t, 0);
      m.positions.emplace_back(0, s, t);
      m.positions.emplace_back(t, 0, s);
    }
  for (Vec3& p : m.positions) p.normalize();
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        const auto near = [&](std::uint32_t i, std::uint32_t j) {
          return (m.positions[i] - m.positions[j]).norm() < 1.1;
        };
        if (!near(a, b) || !near(b, c) || !near(c, a)) continue;
        const bool outward = m.positions[a].dot(m.positions[b].cross(m.positions[c])) > 0;
        faces.push_back(outward ? std::array{a, b, c} : std::array{a, c, b});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, isNew] = middles.try_emplace(std::minmax(a, b), std::uint32_t(m.positions.size()));
      if (isNew) m.positions.push_back((m.positions[a] + m.positions[b]).normalized());
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    faces = std::move(finer);
  }
  for (const auto& t : faces) m.addFace(t);
  return m;
}

/// (n × m quads) over [0, 1]² in the plane z = height(x, y), seen from +z; UV = (x, y).
inline PolygonMesh sheet(int n, int m, const std::function<double(double, double)>& height = {}) {
  PolygonMesh mesh;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n, y = double(j) / m;
      mesh.positions.emplace_back(x, y, height ? height(x, y) : 0);
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = std::uint32_t(j * (n + 1) + i), c = std::uint32_t(a + n + 1);
      addFace(mesh, {a, a + 1, c + 1, c});
      for (std::uint32_t v : {a, a + 1, c + 1, c}) mesh.cornerUvs.push_back(mesh.positions[v].head<2>());
    }
  return mesh;
}

inline PolygonMesh torus(int n, int m, double tube = 0.4) {
  PolygonMesh mesh;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      mesh.positions.emplace_back((1 + tube * std::cos(b)) * std::cos(a),
                                  (1 + tube * std::cos(b)) * std::sin(a), tube * std::sin(b));
    }
  const auto at = [&](int i, int j) { return std::uint32_t(i % n * m + j % m); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) addFace(mesh, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  return mesh;
}

/// Every face with vertices of its own, as a reader that splits along seams leaves it.
inline PolygonMesh exploded(const PolygonMesh& in) {
  PolygonMesh out = in;
  out.positions.clear();
  for (std::uint32_t& v : out.corners) {
    out.positions.push_back(in.positions[v]);
    v = std::uint32_t(out.positions.size() - 1);
  }
  return out;
}

inline Vec3 randomPoint(std::uint64_t i, double reach) {
  const CounterRandom r(42, i);
  return reach * Vec3(2 * r.uniform(0) - 1, 2 * r.uniform(1) - 1, 2 * r.uniform(2) - 1);
}

}  // namespace coif::test
