#include "make_mesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

namespace coif::placetest {

HairMesh build(const Columns& columns, const PositionOf& position) {
  std::vector<std::size_t> cornerStart{0};
  for (const auto& face : columns.faces) cornerStart.push_back(cornerStart.back() + face.size());
  struct Side {
    std::size_t face, corner;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> edges;
  for (std::size_t f = 0; f < columns.faces.size(); ++f) {
    const auto& face = columns.faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      edges[std::minmax(face[i], face[(i + 1) % face.size()])].push_back({f, i});
    }
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> splitAt;
  for (const EdgeSplit& s : columns.splits) splitAt[{s.a, s.b}] = s.layer;

  std::vector<HairVertex> vertices;
  std::vector<Bundle> bundles(columns.faces.size());
  const std::uint32_t layers = 1 + *std::ranges::max_element(columns.heights);
  for (std::uint32_t k = 0; k < layers; ++k) {
    std::vector<std::size_t> up(cornerStart.back());
    std::iota(up.begin(), up.end(), std::size_t{0});
    const auto find = [&](std::size_t x) {
      while (up[x] != x) x = up[x] = up[up[x]];
      return x;
    };
    for (const auto& [edge, sides] : edges) {
      if (sides.size() < 2) continue;
      if (columns.heights[sides[0].face] < k || columns.heights[sides[1].face] < k) continue;
      if (const auto split = splitAt.find(edge); split != splitAt.end() && k >= split->second) continue;
      for (const std::uint32_t end : {edge.first, edge.second}) {
        std::size_t corner[2];
        for (int s = 0; s < 2; ++s) {
          const auto& face = columns.faces[sides[s].face];
          corner[s] = cornerStart[sides[s].face] + std::size_t(std::ranges::find(face, end) - face.begin());
        }
        up[find(corner[0])] = find(corner[1]);
      }
    }
    std::map<std::size_t, std::uint32_t> made;
    for (std::size_t f = 0; f < columns.faces.size(); ++f) {
      if (columns.heights[f] < k) continue;
      bundles[f].id = BundleId(f);
      bundles[f].corners = std::uint32_t(columns.faces[f].size());
      for (std::size_t i = 0; i < columns.faces[f].size(); ++i) {
        const auto [at, isNew] = made.try_emplace(find(cornerStart[f] + i), std::uint32_t(vertices.size()));
        if (isNew) {
          HairVertex v;
          v.id = VertexId(vertices.size());
          v.layer = k;
          v.parent = k == 0 ? kNone : bundles[f].face(k - 1)[i];
          v.position = position(columns.roots[columns.faces[f][i]], k, at->second);
          vertices.push_back(v);
        }
        bundles[f].vertices.push_back(at->second);
      }
    }
  }
  // Splits are named by layer-0 vertex indices, which follow first use.
  std::map<std::uint32_t, std::uint32_t> rootIndex;
  for (std::size_t f = 0; f < columns.faces.size(); ++f) {
    for (std::size_t i = 0; i < columns.faces[f].size(); ++i)
      rootIndex[columns.faces[f][i]] = bundles[f].face(0)[i];
  }
  std::vector<EdgeSplit> splits;
  for (const EdgeSplit& s : columns.splits) {
    const auto& sides = edges.at({s.a, s.b});
    if (sides.size() < 2 ||
        s.layer > std::min(columns.heights[sides[0].face], columns.heights[sides[1].face]))
      continue;
    const auto [a, b] = std::minmax(rootIndex.at(s.a), rootIndex.at(s.b));
    splits.push_back({a, b, s.layer});
  }
  std::ranges::sort(splits);
  const std::uint32_t nextVertex = std::uint32_t(vertices.size()), nextBundle = std::uint32_t(bundles.size());
  auto mesh = HairMesh::fromParts(std::move(vertices), std::move(bundles), std::move(splits), {"hair"},
                                  nextVertex, nextBundle);
  if (!mesh.ok()) throw std::runtime_error(mesh.error().text());
  return std::move(mesh).value();
}

Columns grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t height) {
  Columns c;
  for (std::uint32_t y = 0; y <= ny; ++y) {
    for (std::uint32_t x = 0; x <= nx; ++x) c.roots.emplace_back(double(x) / nx, double(y) / ny, 0);
  }
  for (std::uint32_t y = 0; y < ny; ++y) {
    for (std::uint32_t x = 0; x < nx; ++x) {
      const std::uint32_t v = y * (nx + 1) + x;
      c.faces.push_back({v, v + 1, v + nx + 2, v + nx + 1});
    }
  }
  c.heights.assign(c.faces.size(), height);
  return c;
}

Columns cube(std::uint32_t n, std::uint32_t height) {
  Columns c;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<int, 3> p) {
    const auto [at, isNew] = known.try_emplace(p, std::uint32_t(c.roots.size()));
    if (isNew) c.roots.push_back(Vec3(p[0], p[1], p[2]) * (2.0 / n) - Vec3::Ones());
    return at->second;
  };
  const int size = int(n);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
          std::vector<std::uint32_t> face;
          for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            std::array<int, 3> p{};
            p[std::size_t(axis)] = side * size;
            p[std::size_t((axis + 1) % 3)] = i + di;
            p[std::size_t((axis + 2) % 3)] = j + dj;
            face.push_back(vertex(p));
          }
          if (side == 0) std::ranges::reverse(face);
          c.faces.push_back(face);
        }
      }
    }
  }
  c.heights.assign(c.faces.size(), height);
  return c;
}

void mixHeights(Columns& columns, std::uint32_t nx, std::uint32_t patch, std::uint64_t seed) {
  const CounterRandom random(seed);
  for (std::uint32_t f = 0; f < columns.faces.size(); ++f) {
    const std::uint32_t x = f % nx / patch, y = f / nx / patch, n = columns.heights[f];
    columns.heights[f] = (n + 1) / 2 + random.below(y * nx + x, n - (n + 1) / 2 + 1);
  }
}

void splitLines(Columns& columns, std::uint32_t nx, std::uint32_t stride, std::uint32_t layer) {
  const std::uint32_t rows = std::uint32_t(columns.roots.size()) / (nx + 1);
  for (std::uint32_t y = 0; y + 1 < rows; ++y) {
    for (std::uint32_t x = stride; x < nx; x += stride) {
      columns.splits.push_back({y * (nx + 1) + x, (y + 1) * (nx + 1) + x, layer});
    }
  }
  std::ranges::sort(columns.splits);
}

PositionOf shaken(double amount, std::uint64_t seed) {
  return [=](const Vec3& root, std::uint32_t layer, std::uint32_t vertex) -> Vec3 {
    if (layer == 0) return root;
    const CounterRandom random(seed, vertex);
    return root * (1 + 0.05 * layer) + Vec3(0, 0, 0.1 * layer) +
           amount * Vec3(random.uniform(0) - 0.5, random.uniform(1) - 0.5, random.uniform(2) - 0.5);
  };
}

}  // namespace coif::placetest
