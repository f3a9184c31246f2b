#include "place/direct.h"

#include "coif/base/check.h"

namespace coif::placing {

namespace {

// The matrix without one unknown of each free component; `kept` lists the others.
Csr grounded(const PlaceSystem& system, std::vector<std::uint32_t>& kept) {
  std::vector<std::uint32_t> number(system.unknowns(), kNone);
  std::vector<std::uint8_t> done(system.freeCount(), 0);
  for (std::uint32_t u = 0; u < system.unknowns(); ++u) {
    const std::uint32_t component = system.freeOf(u);
    if (component != kNone && !done[component]) {
      done[component] = 1;
      continue;
    }
    number[u] = std::uint32_t(kept.size());
    kept.push_back(u);
  }
  Csr matrix;
  const Csr& full = system.matrix();
  for (const std::uint32_t u : kept) {
    for (std::size_t e = full.start[u]; e < full.start[u + 1]; ++e) {
      if (number[full.column[e]] == kNone) continue;
      matrix.column.push_back(number[full.column[e]]);
      matrix.value.push_back(full.value[e]);
    }
    matrix.start.push_back(matrix.column.size());
  }
  return matrix;
}

}  // namespace

DirectSolver::DirectSolver(SparseFactor factor, std::vector<std::uint32_t> kept)
    : factor_(std::move(factor)), kept_(std::move(kept)) {}

std::optional<DirectSolver> DirectSolver::make(const PlaceSystem& system, double maxEntries,
                                               double maxFlops) {
  std::vector<std::uint32_t> kept;
  const Csr matrix = grounded(system, kept);
  const FactorPlan plan = planFactor(matrix, maxEntries);
  if (!plan.fits || plan.flops > maxFlops) return std::nullopt;
  SparseFactor factor(matrix, plan);
  COIF_CHECK(factor.ok(), "the placement matrix without its free translations is positive definite");
  return DirectSolver(std::move(factor), std::move(kept));
}

void DirectSolver::correct(const Block& r, Block& delta, const Context& context) const {
  Block x(Eigen::Index(kept_.size()), r.cols());
  for (std::size_t i = 0; i < kept_.size(); ++i) x.row(Eigen::Index(i)) = r.row(kept_[i]);
  factor_.solve(x, context);
  for (std::size_t i = 0; i < kept_.size(); ++i) delta.row(kept_[i]) += x.row(Eigen::Index(i));
}

}  // namespace coif::placing
