// What of a hair mesh lies under the mouse, in a box or in a lasso.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coif/light/camera.h"
#include "coif/scalp/surface.h"
#include "coif/scene/selection.h"

namespace coif {

/// A pixel position, from the top left of a picture of width × height, x right, y down.
struct ScreenPoint {
  Vec2 px = Vec2::Zero();
  double depth = 0;  ///< along the view; <= 0: behind the camera
};

struct PickOptions {
  std::span<const BundleId> hidden = {};  ///< ascending; their elements are not there
  bool internal = false;                  ///< inner vertices, and faces and edges below tips, can be picked
  const Surface* occluder = nullptr;      ///< the head: what is behind it cannot be picked; null: x-ray
};

/// The hair mesh as a picture of it shows it. Keeps references to the mesh and the occluder. Cost: linear,
/// and a ray through the occluder a vertex.
class ScreenMesh {
 public:
  ScreenMesh(const HairMesh& mesh, const Camera& camera, int width, int height,
             const PickOptions& options = {});

  /// Where each vertex is, by index.
  std::span<const ScreenPoint> vertices() const { return points_; }
  /// Whether it can be seen and picked, by index.
  bool pickable(std::uint32_t vertex) const { return pickable_[vertex] != 0; }
  ScreenPoint project(const Vec3& world) const;

  /// The nearest within `radiusPx`; of those alike near (within a pixel) the one in front.
  std::optional<VertexId> vertexAt(const Vec2& px, double radiusPx) const;
  std::optional<EdgeRef> edgeAt(const Vec2& px, double radiusPx) const;
  /// The front one whose outline holds the pixel.
  std::optional<FaceRef> faceAt(const Vec2& px) const;

  /// Elements of a kind inside a polygon (a lasso, or a box as four corners): vertices, edges with both ends,
  /// faces with their middle.
  Selection inside(std::span<const Vec2> polygon, SelectKind kind) const;
  /// Elements of a kind within `radiusPx`: one dab of a selection brush.
  Selection near(const Vec2& px, double radiusPx, SelectKind kind) const;

 private:
  template <class Test>
  Selection pickWhere(SelectKind kind, const Test& test) const;

  const HairMesh& mesh_;
  Camera camera_;
  int width_, height_;
  Vec3 right_, up_, forward_;
  double scale_ = 1;
  std::vector<ScreenPoint> points_;
  std::vector<std::uint8_t> pickable_;
  std::vector<EdgeRef> edges_;
  std::vector<FaceRef> faces_;
};

/// Even–odd rule.
bool insidePolygon(const Vec2& px, std::span<const Vec2> polygon);

}  // namespace coif
