// What a stack of style operators does to strands: found once, and laid on the hair mesh again wherever it
// moves.
//
// A strand's curve comes from the hair mesh. Its frame comes from the mesh too: parallel transport from the
// root, where the normal is up × tangent with "up" the mean normal of the root layer, so that neighbours
// agree across bundles. Styling keeps, for every point, an offset in that frame, and for every strand how far
// along its curve it reaches:
//   styled point p = C(p · reach) + F(p · reach) · offset_p.
// Operators are functions of the embedding (bundle, weights, place along the strand, stable id, seed): a
// small edit of the mesh changes the style a little, and the first strands of a denser set are the same
// strands. Kinds that look at the world (StyleKind::looksAtWorld) do so when the plan is made.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/surface.h"
#include "coif/strands/strand_set.h"
#include "coif/strands/strand_style.h"
#include "coif/style/style_operator.h"

namespace coif {

struct StyleOptions {
  const Surface* head = nullptr;  ///< for operators that look at it; without it they are left out
  bool runIdle = false;           ///< operators that cannot change anything run all the same
};

struct StyleOperatorReport {
  std::string name;
  bool ran = false;
  std::string leftOut;  ///< why it did not run
};

struct StyleReport {
  std::vector<StyleOperatorReport> operators;
  std::uint32_t pointsWanted = 0;  ///< a strand, for its waves and curls to look round; 0: any number does
  double seconds = 0;
};

class StylePlan {
 public:
  /// Nothing is styled.
  StylePlan() = default;

  /// `strands` as grow() made them on `mesh`, in its order. Errors: those of validate(stack); InvalidArgument
  /// for strands without ids, root faces or weights, or of another mesh; TooLarge; Cancelled. Same bytes for
  /// any number of threads. Cost: linear in points; keeps 12 bytes a point (16 with widths), 24 a strand.
  static Result<StylePlan> create(const HairMesh& mesh, const StrandSet& strands,
                                  std::span<const StyleOperator> stack, const StyleOptions& options = {},
                                  const Context& context = {});

  /// Styles the same strands, grown on the same mesh wherever its vertices are now; points and widths are
  /// replaced. Where the mesh did not move, this is what the stack computed. A plan that changes nothing
  /// leaves every byte. Rigid motion of the mesh moves the result rigidly. Errors: InvalidArgument for
  /// other strands; Cancelled. Same bytes for any number of threads.
  Status apply(const HairMesh& mesh, StrandSet& strands, const Context& context = {}) const;

  bool changesNothing() const { return offsets_.empty(); }
  const StyleReport& report() const { return report_; }
  std::uint64_t bytes() const;  ///< of all that it keeps

  /// The plan itself, for those who lay it on elsewhere (a GPU); empty when nothing changes.
  StrandStyle view() const { return {strandOffsets_, offsets_, reach_, widths_, rootTurns_}; }

 private:
  std::vector<std::uint64_t> strandOffsets_;
  std::vector<std::uint64_t> ids_;
  std::vector<Vec3f> offsets_;
  std::vector<float> reach_, widths_, rootTurns_;
  StyleReport report_;
};

/// plan and apply in one: what there is to do when the mesh stands still.
Result<StyleReport> applyStyle(const HairMesh& mesh, StrandSet& strands, std::span<const StyleOperator> stack,
                               const StyleOptions& options = {}, const Context& context = {});

/// Points a strand that the stack's waves and curls want, on the longest hair of the mesh; 0: any number.
std::uint32_t pointsWanted(std::span<const StyleOperator> stack, const HairMesh& mesh, double metersPerUnit);

}  // namespace coif
