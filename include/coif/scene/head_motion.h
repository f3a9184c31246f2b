// Ways to move a head so that its hair shows how it hangs: what a play button needs where no motion is given.
#pragma once

#include <vector>

#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/simulate/collider.h"

namespace coif {

enum class HeadMove { Still, Shake, Nod, Turn };

/// "still", "shake", "nod", "turn".
inline constexpr const char* kHeadMoveNames[] = {"still", "shake", "nod", "turn"};

struct HeadMoveSettings {
  HeadMove move = HeadMove::Still;
  double angleDeg = 25;       ///< greatest turn to a side; of Turn nothing: it goes round
  double timesPerSecond = 1;  ///< periods a second, > 0; rounds a second of Turn
  bool operator==(const HeadMoveSettings&) const = default;
};

/// Poses of the head relative to the model, frame by frame, the first at rest. Shake and Turn are about the
/// up axis through the middle of the roots, Nod about the axis from ear to ear (x) at their lower end. The
/// swing grows from nothing over half a second, so that no velocity jumps. Errors: InvalidArgument for values
/// that are not finite or a rate outside (0, 20].
Result<std::vector<RigidPose>> headPoses(const HeadMoveSettings& settings, const HairMesh& mesh,
                                         UpAxis upAxis, std::size_t frames, double framesPerSecond);

}  // namespace coif
