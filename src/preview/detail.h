// Level of detail: how many strands a picture draws, how wide, and with which points. Decided from bundles
// and a few strands, never by a pass over all.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "preview/hair_model.h"

namespace coif::preview {

/// As shaders/synthesis.glsl has it. Starts are relative to the batch but for columns and parameters.
struct Share {
  std::uint32_t lock, firstStrand, strands, samples;
  std::uint32_t pointStart, strandStart, parameterStart, columnStart;
  bool operator==(const Share&) const = default;
};
static_assert(sizeof(Share) == 32);

/// What is bound and drawn at once: a driver limits the size of a buffer that a shader sees.
struct Batch {
  std::uint32_t firstShare = 0, shares = 0, points = 0, strands = 0;
  bool operator==(const Batch&) const = default;
};

struct DetailPlan {
  std::vector<Share> shares;
  std::vector<Batch> batches;
  std::vector<float> parameters;  ///< of samples, 0 … height
  std::size_t strands = 0, points = 0, columns = 0;
  double widthScale = 1;
  bool lines = false;  ///< no strand is wider than a pixel: lines do
  bool thin = false;   ///< hardly a strand is wider than a few pixels

  std::size_t segments() const { return points - strands; }
  std::size_t bytes() const { return shares.size() * sizeof(Share) + parameters.size() * sizeof(float); }
  bool operator==(const DetailPlan&) const = default;
};

struct DetailOptions {
  bool lod = true;      ///< false: every strand with every point
  double fraction = 0;  ///< of the strands; 0: by their width on the screen
  std::size_t maxSegments = 1000000;
  double tolerancePx = 0.5;          ///< how far a curve may move
  double longestPx = 32;             ///< of a segment, as shading is interpolated along it
  double ribbonPx = 0.3;             ///< strands are widened to about this
  std::size_t leastStrands = 12000;  ///< below, single hairs are told apart
  bool lines = true;                 ///< where no strand is wider than a pixel
  std::size_t batchPoints = 1u << 22;
  bool operator==(const DetailOptions&) const = default;
};

/// World size of a pixel (or of a shadow map's texel) at a place.
using PixelSize = std::function<double(const Vec3&)>;

/// With lod: a prefix of the strands (they are in progressive order), so long that the mean hair is about
/// ribbonPx wide and the bound on segments holds; widened so that their summed area stays; samples shared by
/// a lock, as few as keep its columns within the tolerance. Sizes are taken in steps of 2^(1/4), so that a
/// small move of the camera leaves the plan as it was. Same result for any number of threads.
DetailPlan makePlan(const HairModel& model, const DetailOptions& options, const PixelSize& pixelAt,
                    const Context& context);

/// Numbers of segments 1, 2, 3, 4, 6, 8, 12, 16, 24 …: step 0 has 1. The first step of at least `segments`.
std::uint32_t ladderStep(std::uint32_t segments);
std::uint32_t ladderSegments(std::uint32_t step);

}  // namespace coif::preview
