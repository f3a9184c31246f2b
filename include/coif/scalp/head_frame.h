// Where is up, front and the crown: the frame in which hairlines and cages are described.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/scalp/mirror.h"
#include "coif/scalp/surface.h"

namespace coif {

/// Right-handed: right = forward × up, the head's own right-hand side. Lengths in mesh units.
struct HeadFrame {
  Vec3 centre =
      Vec3::Zero();  ///< of the skull: on the mirror plane, midway front to back at the brow's height
  Vec3 up = Vec3::UnitY(), forward = Vec3::UnitZ(), right = -Vec3::UnitX();
  double height = 0;                 ///< H: chin to crown
  double depth = 0;                  ///< brow to back of the head
  double halfWidth = 0;              ///< of the skull, above the ears
  double earTop = 0;                 ///< elevation of the ears' upper edge seen from the centre, radians
  double earFront = 0, earBack = 0;  ///< their azimuths from the front, radians
  bool faceFound = false;  ///< a profile with a face and a receding nape; else forward is a convention
  bool earsFound = false;  ///< else earTop, earFront and earBack are 0
  MirrorPlane mirror;      ///< its normal is along `right`
  std::vector<std::string> notes;

  /// From the centre: azimuth in [−π, π] (0 front, positive to the right), elevation in [−π/2, π/2].
  Vec2 angles(const Vec3& point) const;
};

struct HeadOptions {
  std::optional<Vec3> up;             ///< else the mesh's upAxis
  std::optional<Vec3> forward;        ///< else from the profile
  std::optional<MirrorPlane> mirror;  ///< else found
};

/// Reads a frame off the profile of a head-like shell (its faces; others are ignored); neck, shoulders and
/// ears may hang on it. Depth and width come from cross-sections walking down from the crown to where the
/// skull stops growing; the face is the side that reaches farther out in the lower half; the chin is where it
/// recedes below three quarters. What is not found is said in `notes` and replaced by proportions (H = 1.1
/// depth). Accuracy: on three test heads H is within 8 % of the measured chin. Errors: Degenerate for a shell
/// without area or height; InvalidArgument for directions that are zero or parallel.
Result<HeadFrame> estimateHeadFrame(const Surface& surface, std::span<const std::uint32_t> shellFaces,
                                    const HeadOptions& options = {});

}  // namespace coif
