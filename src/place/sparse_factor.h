// LDLᵀ of a sparse symmetric positive definite matrix, in a fill-reducing order (Eigen inside).
#pragma once

#include <memory>

#include "place/block.h"

namespace coif::placing {

/// What a factor would cost, without making it.
struct FactorPlan {
  std::vector<int> order;  ///< order[new] = old: approximate minimum degree
  double entries = 0;      ///< of L
  double flops = 0;        ///< Σ (entries of a column of L)²
  bool fits = true;        ///< false: counting stopped at the limit
};
/// Counts L's entries column by column, in time ~ entries, stopping past `maxEntries`.
FactorPlan planFactor(const Csr& matrix, double maxEntries);

class SparseFactor {
 public:
  SparseFactor(const Csr& matrix, const FactorPlan& plan);  ///< requires plan.fits
  ~SparseFactor();
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;
  bool ok() const;  ///< false: the matrix is not positive definite in double
  /// x ← A⁻¹ x; columns are shared out among threads.
  void solve(Block& x, const Context& context) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif::placing
