// Hair as a coarse fog: optical depth towards each light and how much of the sky is open.
#pragma once

#include <span>
#include <vector>

#include "coif/base/context.h"
#include "preview/frame_data.h"
#include "preview/hair_model.h"

namespace coif::preview {

/// A grid of cubes; index (z · ny + y) · nx + x.
struct LightVolume {
  Vec3 lo = Vec3::Zero();
  double cell = 1;
  int nx = 1, ny = 1, nz = 1;
  std::vector<Vec4f> values{Vec4f(0, 0, 0, 1)};  ///< optical depth to three lights; open part of the sky

  Vec3 extent() const { return cell * Vec3(nx, ny, nz); }
};

struct LightVolumes {
  LightVolume hairOnly;  ///< for the head's own shading
  LightVolume withHead;  ///< the head stops light too: for the hair's; x is the open part of the ground
};

/// What does not depend on the light: the extinction of each cell times its size.
struct Fog {
  LightVolume grid;                       ///< without values
  std::vector<float> hairOnly, withHead;  ///< the latter empty without a head
};

/// The extinction of a cell is Σ length · diameter · π/4 over its volume: randomly oriented fibres.
Fog makeFog(const CoarseStrands& strands, const PolygonMesh* head);

/// Optical depth a unit of length that light meets in the hair, as a mean over the hairs' places; 0 without
/// hair.
double meanExtinction(const Fog& fog);

/// What the light of the surroundings finds open, by cell: stays while lights turn about `up`.
struct Openness {
  Vec3 up = Vec3::Zero();                       ///< the sky's middle, a unit vector
  std::vector<float> sky, ground, skyPastHair;  ///< the last as if there were no head
};
Openness openSides(const Fog& fog, const Vec3& up, const Context& context);

/// Each direction is swept slice by slice from the light's side, bilinear in the slice before: soft, linear
/// in the number of cells. `lights` are unit vectors towards the light. Deterministic for any number of
/// threads.
LightVolumes makeLightVolumes(const Fog& fog, const Openness& open, const Vec3 (&lights)[3],
                              const Context& context);

/// Optical depth from each cell's centre towards `direction`, for extinction times cell size `opticalSize`.
std::vector<float> sweepOpticalDepth(const LightVolume& grid, std::span<const float> opticalSize,
                                     const Vec3& direction);

}  // namespace coif::preview
