// How much of the light reaches a point inside hair: every shadow method on the CPU behind one interface, and
// the truth.
//
// All methods see the same fragments (fragments.h), sum optical depths β and take one exponential a query,
// T = exp(−Ω). A fragment does not shadow itself. Beside the optical depth (channel 0) a map can sum further
// values a fragment in the same way, which is what dual scattering asks for.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>

#include "coif/light/deep_layers.h"
#include "coif/light/fragments.h"
#include "coif/light/opaque_map.h"

namespace coif {

enum class VisibilityMethod {
  None,               ///< T = 1 wherever no opaque surface is in the way
  Opacity,            ///< Kim & Neumann 2001: uniform slices, Ω linear between them
  DensityClustering,  ///< Mertens et al. 2004, with the bins of docs/visibility.md
  LightMap,           ///< Bertails et al. 2005: a grid along the light (light_density_map.h)
  DeepOpacity,        ///< Yuksel & Keyser 2008: layers that follow the first hair
  Occupancy,          ///< Sintorn & Assarsson 2009: a bit a slice, amounts in slabs
  Exact,              ///< all fragments of a texel sorted by depth: the truth
};

const char* name(VisibilityMethod method);

struct VisibilityOptions {
  VisibilityMethod method = VisibilityMethod::DeepOpacity;
  int slices = 128;  ///< Opacity: 1 … 4096, over the hair's own range of depth
  int clusters = 4;  ///< DensityClustering: 1 … 16
  /// DeepOpacity: 1 … 255; 0: the fewest of 3, 7, 11, 15, 23, … whose bound is met
  int layers = 7;
  /// On the CPU: sorted lists where they are no larger than three layers, if `layers` is 0; forward
  /// scattering of grey hair in one channel.
  bool leaveOut = true;
  double bound = 0.1;  ///< for layers = 0: aPosterioriBound().mean at most, unless more layers gain < 3 %
  LayerSizes sizes = LayerSizes::Linear;
  PastLastLayer past = PastLastLayer::AddToLast;
  double layerSize = 0;       ///< s; 0: chooseLayerSize
  int occupancySlices = 128;  ///< Occupancy: up to 1024, a multiple of 32 · slabs
  int slabs = 4;              ///< 1 … 32
  int gridLog2Size = 7;       ///< LightMap: 3 … 9, of cells a side
  bool filter = false;  ///< T (and sums) from the four nearest texels, bilinear; depths are never filtered
  const OpaqueMap* opaque = nullptr;  ///< same view; behind it T = 0. Must outlive the map
};

/// Further values a fragment, summed like β. `fill` writes `count` values; called from several threads.
struct ChannelSource {
  static constexpr int kMost = 15;
  int count = 0;
  std::function<void(const Fragment&, std::span<float>)> fill;
};

/// What interpolation can be wrong by in T, known from the map alone. `mean` is weighted by the light that
/// each interval takes away (what a light sees, an eye beside it sees); `worst` is over all intervals. One
/// where a method knows no bound.
struct TransmittanceBound {
  double mean = 1, worst = 1;
};

/// Queries are const and thread-safe. Points off the map or behind a point light are lit; no query is NaN.
class VisibilityMap {
 public:
  virtual ~VisibilityMap() = default;
  VisibilityMap(const VisibilityMap&) = delete;
  VisibilityMap& operator=(const VisibilityMap&) = delete;

  /// In [0, 1]; 0 behind the opaque map.
  double transmittance(const Vec3& world) const;
  /// Of the hair alone, not filtered: Ω >= 0.
  double opticalDepth(const Vec3& world) const;
  /// The same at a depth of a texel (y · size + x); 0 for the light map, which has no texels.
  double opticalDepthAt(std::size_t texel, double depth) const;
  /// All channels of the hair between light and point, filtered if the map is; out has channels() values.
  void sums(const Vec3& world, std::span<float> out) const;
  /// A texel that a query mixes, and all channels in front of the query's depth in it.
  struct Tap {
    std::size_t texel = 0;
    double weight = 0;
    std::array<double, 1 + ChannelSource::kMost> sums{};
  };
  /// Up to four of them; the weight that is missing to one belongs to texels off the map, which are lit. None
  /// for the light map.
  int tapsAt(const Vec3& world, std::array<Tap, 4>& out) const;
  /// How much of a fragment at one depth of a texel is in front of another, as the map sees it: a step, or
  /// linear through the layer that both are in.
  virtual double shareInFront(std::size_t texel, double fragmentDepth, double depth) const;
  /// Upper bound of |ΔT| there from the interval that the point is in.
  double boundAt(const Vec3& world) const;

  int channels() const { return channels_; }
  VisibilityMethod method() const { return options_.method; }
  const VisibilityOptions& options() const { return options_; }  ///< layers and layerSize as they were chosen
  const LightView& view() const { return view_; }
  /// Of the map's storage, over its texels.
  virtual double bytesPerTexel() const = 0;
  virtual TransmittanceBound aPosterioriBound() const { return {}; }

  struct Interval {
    double from = 0, to = HUGE_VAL;
  };

 protected:
  VisibilityMap(const LightView& view, const VisibilityOptions& options, int channels)
      : view_(view), options_(options), channels_(channels) {}
  /// Channel sums in front of a depth, in one texel; (x, y) is where in the texel, for methods that care.
  virtual void sumsAt(std::size_t texel, double depth, std::span<double> out) const = 0;
  /// Ω lies in it for certain.
  virtual Interval intervalAt(std::size_t, double) const { return {}; }
  /// For methods with a filter of their own.
  virtual bool ownTransmittance(const Vec3&, double&) const { return false; }

 private:
  template <class Call>
  void taps(const Vec3& projected, Call&& call) const;

  LightView view_;
  VisibilityOptions options_;
  int channels_ = 1;
};

/// Errors: InvalidArgument (options out of range, channels with LightMap), TooLarge (a map beyond 8 GiB; a
/// grid that the hair does not fit), Cancelled. Cost: one to three passes over the fragments, plus a sort for
/// Exact. Same bytes for any number of threads.
Result<std::unique_ptr<VisibilityMap>> buildVisibility(const FragmentStream& stream,
                                                       const VisibilityOptions& options,
                                                       const ChannelSource& channels = {},
                                                       const Context& context = {});

}  // namespace coif
