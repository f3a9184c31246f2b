#include "reference.h"

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

namespace coif::placetest {

std::vector<Vec3> referencePositions(const HairMesh& mesh) {
  const std::vector<std::uint8_t> external = externalVertices(mesh);
  std::vector<std::size_t> unknown(external.size(), 0), vertex;
  for (std::size_t v = 0; v < external.size(); ++v) {
    if (!external[v]) {
      unknown[v] = vertex.size();
      vertex.push_back(v);
    }
  }
  std::set<std::array<std::uint32_t, 4>> quads;
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t k = 0; k < bundle.height(); ++k) {
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        std::uint32_t j = (i + 1) % bundle.corners;
        const bool flip = bundle.face(k)[i] > bundle.face(k)[j];
        const std::uint32_t a = flip ? j : i, b = flip ? i : j;
        quads.insert({bundle.face(k)[a], bundle.face(k)[b], bundle.face(k + 1)[a], bundle.face(k + 1)[b]});
      }
    }
  }
  const std::size_t n = vertex.size(), width = n + 3;
  std::vector<long double> m(n * width, 0);
  constexpr std::array<int, 4> kSign{-1, 1, 1, -1};
  for (const auto& q : quads) {
    for (int i = 0; i < 4; ++i) {
      if (external[q[i]]) continue;
      long double* row = m.data() + unknown[q[i]] * width;
      for (int j = 0; j < 4; ++j) {
        const long double s = kSign[i] * kSign[j];
        if (!external[q[j]]) {
          row[unknown[q[j]]] += s;
        } else {
          for (int c = 0; c < 3; ++c) row[n + std::size_t(c)] -= s * (long double)(mesh.position(q[j])[c]);
        }
      }
    }
  }
  for (std::size_t p = 0; p < n; ++p) {  // positive definite: no pivoting
    const long double pivot = m[p * width + p];
    if (!(pivot > 1e-12L)) throw std::runtime_error("the reference needs a positive definite matrix");
    for (std::size_t r = p + 1; r < n; ++r) {
      const long double f = m[r * width + p] / pivot;
      if (f == 0) continue;
      for (std::size_t c = p; c < width; ++c) m[r * width + c] -= f * m[p * width + c];
    }
  }
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position);
  for (std::size_t p = n; p-- > 0;) {
    for (std::size_t c = n; c < width; ++c) {
      long double x = m[p * width + c];
      for (std::size_t r = p + 1; r < n; ++r) x -= m[p * width + r] * m[r * width + c];
      m[p * width + c] = x / m[p * width + p];
      positions[vertex[p]][Eigen::Index(c - n)] = double(m[p * width + c]);
    }
  }
  return positions;
}

double diagonal(const HairMesh& mesh) {
  Vec3 low = mesh.position(0), high = low;
  for (const HairVertex& v : mesh.vertices()) {
    low = low.cwiseMin(v.position);
    high = high.cwiseMax(v.position);
  }
  return (high - low).norm();
}

double distance(const HairMesh& a, const HairMesh& b) {
  double worst = 0;
  for (std::uint32_t v = 0; v < a.vertices().size(); ++v) {
    worst = std::max(worst, (a.position(v) - b.position(v)).norm());
  }
  return worst / diagonal(a);
}

}  // namespace coif::placetest
