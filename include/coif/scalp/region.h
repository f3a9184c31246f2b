// The part of a mesh that may carry hair.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/scalp/head_frame.h"
#include "coif/scalp/surface.h"

namespace coif {

/// Faces, and where the choice has a smooth edge a field whose zero set is that edge.
struct Region {
  std::vector<std::uint8_t> faces;  ///< F flags: 1 inside (a face counts by the mean of its corners' field)
  std::vector<double> field;        ///< V, > 0 inside, or empty when only whole faces are known
  std::optional<HeadFrame> frame;   ///< of automaticCap
  std::vector<std::string> notes;   ///< what was assumed, a sentence each

  std::size_t count() const;                ///< faces inside
  std::vector<std::uint32_t> list() const;  ///< their indices, ascending
};

/// All of them: the mesh must pass validate() (else its error); an empty choice is an error (Degenerate) that
/// says so.
Result<Region> regionOfAll(const PolygonMesh& mesh);
/// Groups and materials by name; NotFound names the one that is missing and lists what there is.
Result<Region> regionOfGroups(const PolygonMesh& mesh, std::span<const std::string> names);
Result<Region> regionOfFaces(const PolygonMesh& mesh, std::span<const std::uint32_t> faces);
/// The side of the plane that the normal points to. The field is the distance from the plane.
Result<Region> regionOfHalfSpace(const PolygonMesh& mesh, const Vec3& point, const Vec3& normal);
/// The field is the radius less the distance from the centre.
Result<Region> regionOfSphere(const PolygonMesh& mesh, const Vec3& centre, double radius);
/// Within a distance along the surface from the surface point nearest to the seed (geodesic.h says how
/// exact).
Result<Region> regionOfGeodesicDisc(const Surface& surface, const Vec3& seed, double radius);
/// A shell (numbers as in MeshReport), or the one of the greatest area. Seams of equal positions do not part
/// shells when `throughSeams`.
Result<Region> regionOfShell(const PolygonMesh& mesh, std::optional<std::uint32_t> shell = {},
                             bool throughSeams = false);

/// Both, either, the first without the second. Fields survive where both have one (min, max).
Result<Region> intersection(const Region& a, const Region& b);
Result<Region> unionOf(const Region& a, const Region& b);
Result<Region> difference(const Region& a, const Region& b);

/// Where the hair of a person ends, as fractions of H above the chin and angles about the skull's centre.
struct CapOptions {
  HeadOptions head;
  double foreheadLine =
      0.81;                ///< height of the front hairline, of H above the chin (anthropometry: 0.79–0.83)
  double napeLine = 0.28;  ///< height of the hairline at the nape, of H
  double earClearanceRad = 0.09;    ///< above the ears and beside them
  double upperCapElevationRad = 0;  ///< the fall-back's edge where no face is found
};

/// The hair-bearing part of a head: a smooth symmetric hairline high over the forehead, past the temples,
/// above and behind the ears, down to the nape. Works on the shell that reaches highest among those with a
/// tenth of the greatest area (shells joined through seams of equal positions). The field is elevation minus
/// hairline, in radians, seen from the skull's centre; off the shell it is −π. Without a face on the profile:
/// the upper cap, and a note. Errors: those of validate() and estimateHeadFrame(); Degenerate where nothing
/// lies above the hairline.
Result<Region> automaticCap(const Surface& surface, const CapOptions& options = {});

}  // namespace coif
