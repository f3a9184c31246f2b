#include "place/sparse_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "coif/base/parallel.h"

namespace coif::placing {

namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Factorisation = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>>;
constexpr std::size_t kColumnGrain = 48;  // right-hand sides a task: six cache lines wide

// Lower triangle of the matrix with row `order[i]` moved to row i; empty order: as it is.
Sparse lowerOf(const Csr& matrix, const std::vector<int>& order) {
  const int n = int(matrix.rows());
  std::vector<int> position(order.size());
  for (int i = 0; i < int(order.size()); ++i) position[std::size_t(order[std::size_t(i)])] = i;
  Sparse lower(n, n);
  lower.reserve(Eigen::Index(matrix.value.size() / 2 + matrix.rows()));
  std::vector<std::pair<int, double>> column;
  for (int j = 0; j < n; ++j) {
    const std::size_t old = order.empty() ? std::size_t(j) : std::size_t(order[std::size_t(j)]);
    column.clear();
    for (std::size_t e = matrix.start[old]; e < matrix.start[old + 1]; ++e) {
      const int i = order.empty() ? int(matrix.column[e]) : position[matrix.column[e]];
      if (i >= j) column.emplace_back(i, matrix.value[e]);
    }
    std::sort(column.begin(), column.end());
    lower.startVec(j);
    for (const auto& [i, value] : column) lower.insertBack(i, j) = value;
  }
  lower.finalize();
  return lower;
}

// Column counts by walking the elimination tree row by row (Liu 1986).
void countEntries(const Csr& matrix, double maxEntries, FactorPlan& plan) {
  const std::size_t n = matrix.rows();
  std::vector<int> position(n), parent(n, -1), seen(n, -1);
  for (std::size_t i = 0; i < n; ++i) position[std::size_t(plan.order[i])] = int(i);
  std::vector<double> count(n, 1);
  plan.entries = double(n);
  for (int row = 0; row < int(n); ++row) {
    seen[std::size_t(row)] = row;
    const std::size_t old = std::size_t(plan.order[std::size_t(row)]);
    for (std::size_t e = matrix.start[old]; e < matrix.start[old + 1]; ++e) {
      for (int j = position[matrix.column[e]]; j < row && seen[std::size_t(j)] != row;
           j = parent[std::size_t(j)]) {
        if (parent[std::size_t(j)] < 0) parent[std::size_t(j)] = row;
        seen[std::size_t(j)] = row;
        count[std::size_t(j)] += 1;
        plan.entries += 1;
      }
    }
    if (plan.entries > maxEntries) {
      plan.fits = false;
      return;
    }
  }
  for (const double c : count) plan.flops += c * c;
}

}  // namespace

FactorPlan planFactor(const Csr& matrix, double maxEntries) {
  FactorPlan plan;
  if (matrix.rows() == 0) return plan;
  const Sparse lower = lowerOf(matrix, {});
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), order);
  plan.order.assign(order.indices().data(), order.indices().data() + order.size());
  countEntries(matrix, maxEntries, plan);
  return plan;
}

struct SparseFactor::Impl {
  std::vector<int> order;
  Factorisation ldlt;
};

SparseFactor::SparseFactor(const Csr& matrix, const FactorPlan& plan) : impl_(std::make_unique<Impl>()) {
  impl_->order = plan.order;
  if (matrix.rows() > 0) impl_->ldlt.compute(lowerOf(matrix, plan.order));
}
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

bool SparseFactor::ok() const {
  return impl_->order.empty() ||
         (impl_->ldlt.info() == Eigen::Success && impl_->ldlt.vectorD().minCoeff() > 0);
}

void SparseFactor::solve(Block& x, const Context& context) const {
  const Eigen::Index n = Eigen::Index(impl_->order.size());
  if (n == 0) return;
  const Sparse& lower = impl_->ldlt.matrixL().nestedExpression();
  const auto& diagonal = impl_->ldlt.vectorD();
  parallelFor(context, std::size_t(x.cols()), kColumnGrain, [&](std::size_t begin, std::size_t end) {
    const Eigen::Index first = Eigen::Index(begin), width = Eigen::Index(end - begin);
    Block y(n, width);
    for (Eigen::Index i = 0; i < n; ++i) {
      y.row(i) = x.row(impl_->order[std::size_t(i)]).segment(first, width);
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Sparse::InnerIterator it(lower, j); it; ++it) {
        if (it.row() > j) y.row(it.row()) -= it.value() * y.row(j);
      }
    }
    for (Eigen::Index j = n - 1; j >= 0; --j) {
      y.row(j) /= diagonal[j];
      for (Sparse::InnerIterator it(lower, j); it; ++it) {
        if (it.row() > j) y.row(j) -= it.value() * y.row(it.row());
      }
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      x.row(impl_->order[std::size_t(i)]).segment(first, width) = y.row(i);
    }
  });
}

}  // namespace coif::placing
