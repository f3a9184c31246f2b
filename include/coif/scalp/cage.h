// A coarse cage of quads on the hair-bearing part of a head: the root layer of a hair mesh.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/scalp/region.h"
#include "coif/scalp/surface.h"

namespace coif {

struct CageOptions {
  int count = 200;  ///< quads wanted, 2 … 100 000; the grid comes as near as an even number of columns allows
  bool exact = false;                 ///< the region's own polygons instead of a grid (count is ignored)
  std::optional<MirrorPlane> mirror;  ///< else the region's, else found; used only where it is accepted
  bool useMirror = true;
  int smoothing = 200;  ///< greatest number of smoothing rounds
};

struct CageQuality {
  double minAreaRatio = 0, maxAreaRatio = 0;  ///< of the mean face area
  double maxAspect = 0;                       ///< longest over shortest side, of the worst face
  std::uint32_t flips = 0;                    ///< faces whose normal points into the head
  double maxDistance =
      0;  ///< face middle to the head, of the head's height H (0: without a head's height, of the size)
  double mirrorError = 0;      ///< greatest distance of a vertex from its partner's mirror image, of H
  std::uint32_t mapFlips = 0;  ///< folded triangles of the disc map that the grid started from
};

/// V vertices on the head's surface and F faces, wound outward, one disc: V − E + F = 1.
/// The arrays are those that HairMesh::fromRoot takes.
struct Cage {
  std::vector<Vec3> positions;                ///< V
  std::vector<std::uint32_t> faceOffsets{0};  ///< F + 1
  std::vector<std::uint32_t> corners;
  std::vector<SurfacePoint> points;  ///< V: where on the head; position equals positions[v]
  std::vector<Vec2> uv;  ///< V: u −1 left … +1 right, v −1 front … +1 back; exact: in the unit disc, or empty
  std::vector<std::array<std::uint32_t, 2>> grid;  ///< V: (column i, row j), or empty when exact
  std::uint32_t columns = 0, rows = 0;             ///< faces across (even) and front to back; 0 when exact
  std::vector<std::uint8_t> boundary;              ///< V flags: on the hairline
  std::vector<std::uint32_t> partner;              ///< V: the mirrored vertex (itself on the plane), or empty
  std::vector<std::uint8_t> onPlane;               ///< V flags: held on the mirror plane; or empty
  HeadFrame frame;
  std::optional<MirrorPlane> mirror;  ///< the plane that was used
  CageQuality quality;
  std::vector<std::string> notes;

  std::size_t faceCount() const { return faceOffsets.size() - 1; }
  /// The grid's vertex in column i <= columns, row j <= rows.
  std::uint32_t vertexAt(std::uint32_t i, std::uint32_t j) const { return j * (columns + 1) + i; }
};

/// The region is cut out along its field's zero set (or, for whole faces, along a smoothed edge), its
/// greatest disc is mapped to the unit disc (harmonic with positive weights, boundary by arc length, the
/// mirror line straight), an n × m grid is laid into the disc and back onto the head, and its vertices are
/// smoothed on the surface towards equal areas; hairline vertices stay evenly spread on the hairline, those
/// of the middle column on the mirror plane. Small holes are bridged (note); vertices at equal positions
/// count as one (note). Errors: InvalidArgument for options out of range or a region of another mesh;
/// Degenerate for a region that is empty, closed, a ring, has a handle or edges of three faces: each says
/// what and what to do. Accuracy: every vertex is on the head's surface to rounding. Deterministic. Cost:
/// about 0.2 s for 200 quads on 18 k triangles, one thread.
Result<Cage> buildCage(const PolygonMesh& mesh, const Surface& surface, const Region& region,
                       const CageOptions& options = {}, const Context& context = {});

}  // namespace coif
