// Density clustering of one line of sight (Mertens et al. 2004, section 3.2 and 3.3, corrected).
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace coif {

/// Where a cluster's optical depth rises from nothing to all of it. from == to: a step.
struct ClusterBin {
  float from = 0, to = 0;
};

/// The nearest of the means; those that are NaN (empty clusters) are passed over.
inline std::size_t nearestMean(std::span<const float> means, double d) {
  std::size_t best = 0;
  double least = HUGE_VAL;
  for (std::size_t j = 0; j < means.size(); ++j) {
    const double away = std::abs(d - double(means[j]));
    if (away < least) least = away, best = j;
  }
  return best;
}

/// Bins [μ ± √3 σ], cut at the midpoints between neighbouring means and at the ends of the range, [0, 1].
/// Means ascend, NaN for empty clusters, whose bins mean nothing.
void clusterBins(std::span<const float> means, std::span<const float> deviations, std::span<ClusterBin> bins);

}  // namespace coif
