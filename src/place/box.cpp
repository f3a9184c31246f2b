#include "place/box.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "coif/base/check.h"
#include "coif/base/parallel.h"

namespace coif::placing {

namespace {

std::vector<std::uint32_t> rootAncestors(const HairMesh& mesh) {
  const auto vertices = mesh.vertices();
  std::vector<std::uint32_t> order(vertices.size()), root(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t v) { return vertices[v].layer; });
  for (const std::uint32_t v : order) root[v] = vertices[v].layer == 0 ? v : root[vertices[v].parent];
  return root;
}

constexpr std::size_t kCellGrain = 32768;  // cells of the box a task

}  // namespace

BoxInverse::BoxInverse(const HairMesh& mesh, const PlaceSystem& system) : rootOf_(rootAncestors(mesh)) {
  numberColumns(mesh, system);
  connectColumns(mesh);
  placeUnknowns(mesh, system);
  boundReach(hopsToBoundary());

  Csr laplacian;
  std::vector<std::uint8_t> grounded(closed_.size(), 0);
  std::vector<std::uint8_t> isGround(columns_.size(), 0);
  for (std::size_t r = 0; r < columns_.size(); ++r) {  // one column of each closed component holds the rest
    const std::uint32_t component = columns_[r].component;
    if (closed_[component] && !grounded[component]) isGround[r] = grounded[component] = 1;
  }
  for (std::uint32_t r = 0; r < columns_.size(); ++r) {
    std::vector<std::pair<std::uint32_t, double>> row{{r, isGround[r] ? 1.0 : double(degree_[r])}};
    for (const std::uint32_t s : neighbours_[r]) {
      if (!isGround[r] && !isGround[s]) row.emplace_back(s, -1.0);
    }
    std::sort(row.begin(), row.end());
    for (const auto& [column, value] : row) {
      laplacian.column.push_back(column);
      laplacian.value.push_back(value);
    }
    laplacian.start.push_back(laplacian.column.size());
  }
  // A planar graph of r columns fills ~ r log r; the root layer of a hair mesh is far below any limit.
  laplacian_ = std::make_unique<SparseFactor>(laplacian,
                                              planFactor(laplacian, std::numeric_limits<double>::infinity()));
  COIF_CHECK(laplacian_->ok(), "the root Laplacian with boundary is positive definite");
}

void BoxInverse::numberColumns(const HairMesh& mesh, const PlaceSystem& system) {
  columnOf_.assign(mesh.vertices().size(), kNone);
  for (std::size_t u = 0; u < system.unknowns(); ++u) columnOf_[rootOf_[system.vertexOf(u)]] = 0;
  for (std::uint32_t& column : columnOf_) {
    if (column == kNone) continue;
    column = std::uint32_t(columns_.size());
    columns_.emplace_back();
  }
  neighbours_.resize(columns_.size());
  degree_.assign(columns_.size(), 0);
}

void BoxInverse::connectColumns(const HairMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Bundle& bundle : mesh.bundles()) {
    const auto face = bundle.face(0);
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      edges.insert(std::minmax(face[i], face[(i + 1) % bundle.corners]));
    }
  }
  for (const auto& [a, b] : edges) {
    const std::uint32_t r = columnOf_[a], s = columnOf_[b];
    if (r != kNone) ++degree_[r];
    if (s != kNone) ++degree_[s];
    if (r == kNone || s == kNone) continue;
    neighbours_[r].push_back(s);
    neighbours_[s].push_back(r);
  }
  std::vector<std::uint8_t> seen(columns_.size(), 0);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t start = 0; start < columns_.size(); ++start) {
    if (seen[start]) continue;
    bool closed = true;
    seen[start] = 1;
    stack.assign(1, start);
    while (!stack.empty()) {
      const std::uint32_t r = stack.back();
      stack.pop_back();
      columns_[r].component = std::uint32_t(closed_.size());
      closed = closed && neighbours_[r].size() == degree_[r];
      for (const std::uint32_t s : neighbours_[r]) {
        if (!seen[s]) stack.push_back(s);
        seen[s] = 1;
      }
    }
    closed_.push_back(closed);
  }
}

void BoxInverse::placeUnknowns(const HairMesh& mesh, const PlaceSystem& system) {
  std::vector<std::uint32_t> first(closed_.size(), kNone), last(closed_.size(), 0);
  const auto columnOf = [&](std::size_t u) { return columnOf_[rootOf_[system.vertexOf(u)]]; };
  const auto layerOf = [&](std::size_t u) { return mesh.vertices()[system.vertexOf(u)].layer; };
  for (std::size_t u = 0; u < system.unknowns(); ++u) {
    const std::uint32_t component = columns_[columnOf(u)].component;
    first[component] = std::min(first[component], layerOf(u));
    last[component] = std::max(last[component], layerOf(u));
  }
  std::size_t cells = 0;
  for (Column& column : columns_) {
    column.firstLayer = first[column.component];
    column.layers = last[column.component] - column.firstLayer + 1;
    maxLayers_ = std::max(maxLayers_, std::size_t(column.layers));
    cells += column.layers;
  }
  exact_ = cells == system.unknowns();
  std::vector<std::uint8_t> taken(columns_.size() * maxLayers_, 0);
  cellOf_.resize(system.unknowns());
  for (std::size_t u = 0; u < system.unknowns(); ++u) {
    const std::uint32_t r = columnOf(u);
    cellOf_[u] = r * maxLayers_ + (layerOf(u) - columns_[r].firstLayer);
    COIF_CHECK(!taken[cellOf_[u]], "two internal vertices of a layer have one root ancestor");
    taken[cellOf_[u]] = 1;
  }
  std::vector<std::size_t> levelStart(closed_.size(), 0);
  for (std::size_t c = 0; c < closed_.size(); ++c) {
    levelStart[c] = levels_.size();
    if (closed_[c]) levels_.resize(levels_.size() + last[c] - first[c] + 1);
  }
  for (std::size_t r = 0; r < columns_.size(); ++r) {
    if (!closed_[columns_[r].component]) continue;
    for (std::size_t slot = 0; slot < columns_[r].layers; ++slot) {
      Level& level = levels_[levelStart[columns_[r].component] + slot];
      level.all.push_back(r * maxLayers_ + slot);
      if (!taken[level.all.back()]) level.held.push_back(level.all.back());
    }
  }
}

std::vector<std::uint32_t> BoxInverse::hopsToBoundary() const {
  std::vector<std::uint32_t> hops(columns_.size(), kNone), queue;
  const auto spread = [&](std::size_t from) {
    for (std::size_t i = from; i < queue.size(); ++i) {
      for (const std::uint32_t s : neighbours_[queue[i]]) {
        if (hops[s] != kNone) continue;
        hops[s] = hops[queue[i]] + 1;
        queue.push_back(s);
      }
    }
  };
  for (std::uint32_t r = 0; r < columns_.size(); ++r) {
    if (neighbours_[r].size() == degree_[r]) continue;
    hops[r] = 1;
    queue.push_back(r);
  }
  spread(0);
  for (std::uint32_t r = 0; r < columns_.size();
       ++r) {  // closed components: twice an eccentricity bounds any path
    if (hops[r] != kNone) continue;
    const std::size_t from = queue.size();
    hops[r] = 0;
    queue.push_back(r);
    spread(from);
    const std::uint32_t diameter = std::max(1u, 2 * hops[queue.back()]);
    for (std::size_t i = from; i < queue.size(); ++i) hops[queue[i]] = diameter;
  }
  return hops;
}

void BoxInverse::boundReach(const std::vector<std::uint32_t>& hops) {
  for (std::size_t r = 0; r < columns_.size(); ++r) {
    const double gaps = columns_[r].layers + 1.0;
    const double middle = std::floor(gaps / 2);
    reach_ = std::max(reach_, middle * (gaps - middle) / gaps * hops[r]);
  }
}

void BoxInverse::apply(const Block& r, Block& z, const Context& context) const {
  const Eigen::Index m = r.cols();
  Block box = Block::Zero(Eigen::Index(columns_.size()), Eigen::Index(maxLayers_) * m);
  Eigen::Map<Block> cells(box.data(), Eigen::Index(columns_.size() * maxLayers_), m);
  for (std::size_t u = 0; u < cellOf_.size(); ++u)
    cells.row(Eigen::Index(cellOf_[u])) = r.row(Eigen::Index(u));
  for (const Level& level : levels_) {
    Sums sum = Sums::Zero(m);
    for (const std::size_t cell : level.all) sum += cells.row(Eigen::Index(cell));
    sum /= double(level.anchors().size());
    for (const std::size_t cell : level.anchors()) cells.row(Eigen::Index(cell)) -= sum;
  }
  laplacian_->solve(box, context);
  parallelFor(context, columns_.size(), std::max<std::size_t>(1, kCellGrain / maxLayers_),
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t column = begin; column < end; ++column) {
                  // Thomas' algorithm for tridiag(−1, 2, −1): its pivots are (k + 2) / (k + 1).
                  const Eigen::Index first = Eigen::Index(column * maxLayers_), n = columns_[column].layers;
                  for (Eigen::Index k = 1; k < n; ++k)
                    cells.row(first + k) += cells.row(first + k - 1) * (double(k) / double(k + 1));
                  for (Eigen::Index k = n - 1; k >= 0; --k) {
                    if (k + 1 < n) cells.row(first + k) += cells.row(first + k + 1);
                    cells.row(first + k) *= double(k + 1) / double(k + 2);
                  }
                }
              });
  for (const Level& level : levels_) {
    Sums sum = Sums::Zero(m);
    for (const std::size_t cell : level.anchors()) sum += cells.row(Eigen::Index(cell));
    sum /= double(level.anchors().size());
    for (const std::size_t cell : level.all) cells.row(Eigen::Index(cell)) -= sum;
  }
  z.resize(r.rows(), m);
  for (std::size_t u = 0; u < cellOf_.size(); ++u)
    z.row(Eigen::Index(u)) = cells.row(Eigen::Index(cellOf_[u]));
}

double BoxInverse::errorBound(const Sums& rz) const {
  return std::sqrt(reach_ * std::max(0.0, rz.sum()));
}

double BoxInverse::errorBound(const Block& r, const Context& context) const {
  Block z;
  apply(r, z, context);
  return errorBound(dots(r, z, context));
}

}  // namespace coif::placing
