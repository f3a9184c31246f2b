// The depth at which an opaque surface stops the light: an ordinary shadow map beside the hair's.
#pragma once

#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/light/light_view.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// size² depths, infinite where nothing is. A texel holds the depth of the nearest surface at its centre,
/// pushed back by what the surface's slope can make within the texel, so that a surface does not shadow
/// itself.
class OpaqueMap {
 public:
  /// Faces are fans of triangles; those that are not finite or behind the light are left out. Errors:
  /// InvalidArgument for a mesh that does not validate or a map of no texels; Cancelled.
  static Result<OpaqueMap> make(const PolygonMesh& mesh, const LightView& view, const Context& context = {});

  const LightView& view() const { return view_; }
  const std::vector<float>& depths() const { return depths_; }
  /// False outside the map.
  bool blocks(const Vec3& world) const;
  bool blocksTexel(std::size_t texel, double depth) const { return depth > double(depths_[texel]); }

 private:
  LightView view_;
  std::vector<float> depths_;
};

}  // namespace coif
