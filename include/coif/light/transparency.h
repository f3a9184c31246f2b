// Hair in front of a background as the eye sees it: the exact composition and the order-free approximations
// of it, for small pictures on the CPU. The picture is the map of the stream's view.
#pragma once

#include <functional>
#include <vector>

#include "coif/light/fragments.h"

namespace coif {

enum class TransparencyMethod {
  SortedList,        ///< the truth: fragments sorted by depth, c α Π (1 − α of those before)
  OccupancyOrdered,  ///< Sintorn & Assarsson 2009, section 3.4: Π from occupancy and slab maps
  WeightedAverage,   ///< Bavoil & Meyers 2008: the α-weighted mean colour, the mean α's composition
};

/// What occupancy-ordered blending does with the sum of its weights, a, and what that sum has to be, Λ = 1 −
/// Π (1 − α): nothing; times Λ / a; or times a / Λ, as it is printed, for the comparison.
enum class OrderNormalisation { None, Corrected, AsPrinted };

struct TransparencyOptions {
  TransparencyMethod method = TransparencyMethod::SortedList;
  OrderNormalisation normalisation = OrderNormalisation::Corrected;
  int occupancySlices = 128, slabs = 4;  ///< as VisibilityOptions
};

/// Hair over a background b is color + (1 − alpha) b.
struct HairPixels {
  int size = 0;
  std::vector<Vec3f> color;  ///< size², premultiplied
  std::vector<float> alpha;  ///< size²
};

/// `color` gives a fragment's colour; called from several threads. Sums in double. Errors: as
/// buildVisibility. Cost: one pass for the average, three for occupancy, one and a sort for the list. Same
/// bytes for any number of threads.
Result<HairPixels> blendHair(const FragmentStream& stream, const std::function<Vec3f(const Fragment&)>& color,
                             const TransparencyOptions& options = {}, const Context& context = {});

}  // namespace coif
