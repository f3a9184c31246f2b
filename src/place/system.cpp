#include "place/system.h"

#include <algorithm>
#include <numeric>

namespace coif::placing {

namespace {

constexpr std::array<double, 4> kSign{-1, 1, 1, -1};  // of a, b, c, d in a quad's strain

std::uint32_t findRoot(std::vector<std::uint32_t>& parent, std::uint32_t v) {
  while (parent[v] != v) {
    parent[v] = parent[parent[v]];
    v = parent[v];
  }
  return v;
}

}  // namespace

PlaceSystem::PlaceSystem(const HairMesh& mesh) {
  const std::vector<std::uint8_t> isExternal = externalVertices(mesh);
  unknownOf_.assign(mesh.vertices().size(), kNone);
  for (std::uint32_t v = 0; v < isExternal.size(); ++v) {
    if (isExternal[v]) continue;
    unknownOf_[v] = std::uint32_t(vertexOf_.size());
    vertexOf_.push_back(v);
  }
  if (vertexOf_.empty()) return;
  const std::vector<SideQuad> quads = sideQuads(mesh);
  for (const SideQuad& q : quads) {
    const Corners corners{q.a, q.b, q.c, q.d};
    if (std::ranges::any_of(corners, [&](std::uint32_t v) { return !external(v); }))
      quads_.push_back(corners);
  }
  findFreeComponents(mesh, quads);
  assemble();
}

void PlaceSystem::findFreeComponents(const HairMesh& mesh, const std::vector<SideQuad>& quads) {
  std::vector<std::uint32_t> parent(mesh.vertices().size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (const SideQuad& q : quads) {  // every lateral edge above layer 0 is the upper edge of a quad
    const std::uint32_t c = findRoot(parent, q.c), d = findRoot(parent, q.d);
    if (c != d) parent[std::max(c, d)] = std::min(c, d);
  }
  std::vector<std::uint8_t> held(parent.size(), 0);
  for (std::uint32_t v = 0; v < parent.size(); ++v) {
    if (external(v)) held[findRoot(parent, v)] = 1;
  }
  std::vector<std::uint32_t> number(parent.size(), kNone);
  freeOf_.assign(unknowns(), kNone);
  for (std::size_t i = 0; i < unknowns(); ++i) {
    const std::uint32_t root = findRoot(parent, vertexOf_[i]);
    if (held[root]) continue;
    if (number[root] == kNone) number[root] = std::uint32_t(freeCount_++);
    freeOf_[i] = number[root];
  }
}

void PlaceSystem::assemble() {
  struct Entry {
    std::uint32_t column;
    double value;
  };
  std::vector<std::size_t> fill(unknowns() + 1, 0);
  const auto forEachEntry = [&](const auto& visit) {
    for (const Corners& q : quads_) {
      for (int i = 0; i < 4; ++i) {
        const std::uint32_t row = unknownOf_[q[i]];
        if (row == kNone) continue;
        for (int j = 0; j < 4; ++j) {
          if (unknownOf_[q[j]] != kNone) visit(row, Entry{unknownOf_[q[j]], kSign[i] * kSign[j]});
        }
      }
    }
  };
  forEachEntry([&](std::uint32_t row, const Entry&) { ++fill[row + 1]; });
  std::partial_sum(fill.begin(), fill.end(), fill.begin());
  std::vector<Entry> entries(fill.back());
  std::vector<std::size_t> next(fill.begin(), fill.end() - 1);
  forEachEntry([&](std::uint32_t row, const Entry& entry) { entries[next[row]++] = entry; });
  for (std::size_t row = 0; row < unknowns(); ++row) {
    const auto begin = entries.begin() + std::ptrdiff_t(fill[row]),
               end = entries.begin() + std::ptrdiff_t(fill[row + 1]);
    std::sort(begin, end, [](const Entry& x, const Entry& y) { return x.column < y.column; });
    for (auto e = begin; e != end; ++e) {
      if (matrix_.column.size() > matrix_.start.back() && matrix_.column.back() == e->column) {
        matrix_.value.back() += e->value;
      } else {
        matrix_.column.push_back(e->column);
        matrix_.value.push_back(e->value);
      }
    }
    matrix_.start.push_back(matrix_.column.size());
  }
}

Block PlaceSystem::strain(const Block& field) const {
  Block g(Eigen::Index(quads_.size()), field.cols());
  for (std::size_t q = 0; q < quads_.size(); ++q) {
    const auto& [a, b, c, d] = quads_[q];
    g.row(Eigen::Index(q)) = (field.row(c) - field.row(a)) - (field.row(d) - field.row(b));
  }
  return g;
}

Block PlaceSystem::residual(const Block& strain, const Block& delta) const {
  Block r = Block::Zero(Eigen::Index(unknowns()), delta.cols());
  const Sums zero = Sums::Zero(delta.cols());
  Sums g(delta.cols());
  for (std::size_t q = 0; q < quads_.size(); ++q) {
    const auto at = [&](int i) -> Sums {
      const std::uint32_t u = unknownOf_[quads_[q][i]];
      return u == kNone ? zero : Sums(delta.row(u));
    };
    g = strain.row(Eigen::Index(q)) + ((at(2) - at(0)) - (at(3) - at(1)));
    for (int i = 0; i < 4; ++i) {
      const std::uint32_t u = unknownOf_[quads_[q][i]];
      if (u != kNone) r.row(u) -= kSign[i] * g;
    }
  }
  return r;
}

void PlaceSystem::removeMeans(Block& delta) const {
  if (freeCount_ == 0) return;
  Block sum = Block::Zero(Eigen::Index(freeCount_), delta.cols());
  std::vector<double> count(freeCount_, 0);
  for (std::size_t i = 0; i < unknowns(); ++i) {
    if (freeOf_[i] == kNone) continue;
    sum.row(freeOf_[i]) += delta.row(Eigen::Index(i));
    count[freeOf_[i]] += 1;
  }
  for (std::size_t i = 0; i < unknowns(); ++i) {
    if (freeOf_[i] != kNone) delta.row(Eigen::Index(i)) -= sum.row(freeOf_[i]) / count[freeOf_[i]];
  }
}

void PlaceSystem::pinMeans(const HairMesh& mesh, const Block& field, Block& delta) const {
  if (freeCount_ == 0) return;
  removeMeans(delta);
  // Offsets from each vertex to its point on the line; only differences of nearby positions, so far offsets
  // are safe.
  Block offset = Block::Zero(Eigen::Index(unknowns()), delta.cols());
  std::vector<double> columns(unknowns(), 0);
  for (const Bundle& bundle : mesh.bundles()) {
    const double n = bundle.height();
    for (std::uint32_t k = 1; k + 1 <= bundle.height(); ++k) {
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const std::uint32_t v = bundle.face(k)[i], u = unknownOf_[v];
        if (u == kNone || freeOf_[u] == kNone) continue;
        const auto rootOffset = field.row(bundle.face(0)[i]) - field.row(v);
        const auto tipOffset = field.row(bundle.face(bundle.height())[i]) - field.row(v);
        offset.row(u) += (1 - k / n) * rootOffset + (k / n) * tipOffset;
        columns[u] += 1;
      }
    }
  }
  for (std::size_t u = 0; u < unknowns(); ++u) {
    if (columns[u] > 0) offset.row(Eigen::Index(u)) /= columns[u];
  }
  Block spread = offset;  // spread − its mean: what removeMeans leaves; the difference is the mean itself
  removeMeans(spread);
  for (std::size_t u = 0; u < unknowns(); ++u) {
    if (freeOf_[u] != kNone)
      delta.row(Eigen::Index(u)) += offset.row(Eigen::Index(u)) - spread.row(Eigen::Index(u));
  }
}

}  // namespace coif::placing
