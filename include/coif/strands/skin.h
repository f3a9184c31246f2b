// Which joints of a skeleton move a surface, and how that carries over to the hair on it.
//
// The form is that of UsdSkel's binding primvars: n influences an element, each a joint and a weight. The
// head's binding goes to the hair mesh's root vertices, up their columns, and by each strand's weights in its
// root face to the strand, so hair follows the skin that it grows on.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coif/base/context.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/scalp/surface.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// E elements with n slots each. A row's weights are not negative and add up to 1, or are all 0: not bound.
struct SkinBinding {
  std::uint32_t influences = 0;         ///< n
  std::vector<std::uint32_t> joints;    ///< E·n, or n when all elements share one row (rigid)
  std::vector<float> weights;           ///< as joints
  std::vector<std::string> jointNames;  ///< what `joints` count through; empty: the skeleton's own order
  std::string skeleton;                 ///< the skeleton's prim path
  /// Takes scene coordinates to those that the skeleton's bind pose is in (points are columns).
  Eigen::Matrix4d bindFromScene = Eigen::Matrix4d::Identity();

  bool rigid() const { return influences > 0 && joints.size() == influences; }
  std::size_t firstOf(std::size_t element) const { return rigid() ? 0 : element * influences; }
};

/// What one export carries: the binding of each of its parts.
struct StrandSkin {
  SkinBinding head;      ///< an element a vertex of the head
  SkinBinding hairMesh;  ///< an element a vertex of the hair mesh
  SkinBinding strands;   ///< an element a strand
};

/// Binds hair to the head's skeleton. Root vertices take the barycentric mean of the head at their nearest
/// point, the vertices above those of their root; a strand takes the mean of its root face's corners by its
/// `weights`. Each mean keeps the n strongest joints and is scaled to add up to 1. `head` has an element a
/// vertex of the surface's mesh. A part whose rows are all the same comes out rigid. Errors: InvalidArgument
/// (a binding that does not fit the surface; strands without root faces or weights of this mesh). Same bytes
/// for any number of threads.
Result<StrandSkin> skinHair(SkinBinding head, const Surface& surface, const HairMesh& mesh,
                            const StrandSet& strands, const Context& context = {});

/// Leaves one row where all rows are the same.
void makeRigidIfUniform(SkinBinding& binding);

}  // namespace coif
