// Sparse LDLᵀ of the placement matrix: the reference.
#pragma once

#include <optional>

#include "place/sparse_factor.h"
#include "place/system.h"

namespace coif::placing {

/// Largest factor that a direct solve makes: 2e8 entries are 2.4 GB.
inline constexpr double kMaxFactorEntries = 2e8;

class DirectSolver {
 public:
  /// Nothing when the factor would exceed `maxEntries` or `maxFlops`.
  static std::optional<DirectSolver> make(const PlaceSystem& system, double maxEntries, double maxFlops);
  /// δ += A⁻¹ r, with one unknown of each free component standing still.
  void correct(const Block& r, Block& delta, const Context& context) const;

 private:
  DirectSolver(SparseFactor factor, std::vector<std::uint32_t> kept);
  SparseFactor factor_;
  std::vector<std::uint32_t> kept_;  ///< unknowns that the factor holds
};

}  // namespace coif::placing
