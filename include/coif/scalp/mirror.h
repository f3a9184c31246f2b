// The mirror plane of a head: found, refined and judged, or given by the artist.
#pragma once

#include <optional>
#include <span>

#include "coif/base/result.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/scalp/surface.h"

namespace coif {

/// Points x with normal·(x − point) = 0; the normal has unit length.
struct MirrorPlane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();
  double residual = 0;  ///< RMS distance of mirrored surface points from the surface, of the mesh's diagonal
  bool accepted = false;  ///< residual <= MirrorOptions::threshold, or given by the artist

  double side(const Vec3& p) const { return normal.dot(p - point); }
  Vec3 reflect(const Vec3& p) const { return p - 2 * side(p) * normal; }
};

struct MirrorOptions {
  /// A plane worse than this is returned with accepted = false. 0.01: laser scans of heads measure 0.002 to
  /// 0.005, a head against a wrong plane 0.02 and more.
  double threshold = 0.01;
  /// The plane should hold this direction (a head's up): candidates farther than 30° from it are left out.
  std::optional<Vec3> contains;
  int samples = 1200;  ///< surface points in the last rounds, >= 16
};

/// Candidates: axis planes and principal planes through the centroid of the surface's area. Each is refined
/// by iterative closest points between the surface and its mirror image (the best reflection of matched
/// points is the least eigenvector of their cross-covariance), the worst fifth of matches left out so that a
/// missing ear does not tilt it; the best is refined further. Of planes alike within 10 % the first wins:
/// across x, z, principal, y. faces: the part of the mesh to judge (a shell, a head); empty: all. Errors:
/// Degenerate where the faces have no area or are not finite; InvalidArgument for a bad normal. Accuracy: on
/// an exactly symmetric mesh the plane is good to 1e-6 of the diagonal. Deterministic. Cost: about 100 ×
/// samples nearest-point queries.
Result<MirrorPlane> findMirrorPlane(const Surface& surface, std::span<const std::uint32_t> faces = {},
                                    const MirrorOptions& options = {});

/// The artist's own plane, with its residual measured; always accepted.
Result<MirrorPlane> givenMirrorPlane(const Surface& surface, const Vec3& point, const Vec3& normal,
                                     std::span<const std::uint32_t> faces = {});

}  // namespace coif
