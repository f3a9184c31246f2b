// Strands in and out: USD BasisCurves (.usda, .usdc), glTF (.gltf, .glb), cyHair (.hair); out: Alembic (.abc).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/skin.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// How glTF shows strands in viewers that draw no lines well.
enum class StrandMesh { None, Cards, Tubes };

/// One frame of a simulated cache: the time code and all points, P×3 in the order of StrandSet::points.
struct StrandFrame {
  double timeCode = 0;
  std::span<const Vec3f> points;
};

/// Everything one export carries. Pointers may be null; what a format cannot hold is said in
/// WriteReport::notes.
struct StrandExport {
  const StrandSet* strands = nullptr;  ///< required
  const HairMesh* hairMesh = nullptr;  ///< written beside the strands as an ordinary mesh (USD, glTF)
  const PolygonMesh* head = nullptr;   ///< written beside the strands (USD, glTF, Alembic)
  const StrandSkin* skin = nullptr;    ///< binds all three to the head's skeleton (USD)
  std::vector<StrandFrame> frames;     ///< time samples (USD, Alembic); empty: static
  /// World from head by frame, affine, as many as there are frames (USD, Alembic); empty: the head stands still.
  std::vector<Eigen::Matrix4d> headPoses;
  double timeCodesPerSecond = 24;
  StrandMesh mesh = StrandMesh::Cards;  ///< glTF fall-back mesh
  std::size_t meshStrandLimit = 2000;   ///< the fall-back uses this many strands (a prefix) at most, widened
  Vec3f color = Vec3f(0.09f, 0.05f, 0.03f);  ///< linear RGB where the strands have no colours
  std::string creator = "Coif";
};

struct WriteReport {
  std::uint64_t bytes = 0;
  std::vector<std::string> notes;  ///< what the format could not hold, a sentence each
};

/// Writes by the extension of `path`, atomically: a crash or a full disk leaves the old file as it was.
/// Errors: Unsupported extension, InvalidArgument (invalid strands), Unreadable (cannot write), TooLarge (a
/// format's limit: 65 536 points a strand in .hair, 4 GiB in .glb).
Result<WriteReport> saveStrands(const StrandExport& what, const std::filesystem::path& path,
                                const Context& context = {});

/// Whether this build writes .abc: COIF_WITH_ALEMBIC, where the library was found.
bool writesAlembic();

/// Reads .hair, .usda BasisCurves, .usdc BasisCurves written by Coif, and the strands of a .glb/.gltf written
/// by Coif. Errors as loadPolygonMesh.
Result<StrandSet> loadStrands(const std::filesystem::path& path);

}  // namespace coif
