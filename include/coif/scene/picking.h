// What of a hair mesh lies under the mouse, in a box or in a lasso.
#pragma once

#include <array>
#include <memory>
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

/// A face of the hair's outside, as it is seen: a tip, or the exposed side of a bundle between two layers.
struct HullFace {
  FaceRef face;                            ///< of a side: the face that ends it
  std::array<std::uint32_t, 4> corners{};  ///< of a side, counter-clockwise from outside
  bool side = false;                       ///< false: the tip face itself
};

/// What of a hair mesh can be picked, which does not change while vertices move.
struct PickParts {
  std::vector<std::uint8_t> shown;  ///< by vertex
  std::vector<EdgeRef> edges;       ///< canonical, both ends shown
  std::vector<std::array<std::uint32_t, 2>> edgeEnds;
  std::vector<FaceRef> faces;
  std::vector<HullFace> hull;  ///< sides that a hidden neighbour leaves bare are part of it
};
PickParts pickParts(const HairMesh& mesh, std::span<const BundleId> hidden, bool internal);

/// The hair mesh as a picture of it shows it. Keeps references to the mesh and the occluder. Cost: linear,
/// and a ray through the occluder a vertex.
class ScreenMesh {
 public:
  ScreenMesh(const HairMesh& mesh, const Camera& camera, int width, int height,
             const PickOptions& options = {});
  /// The same with parts that are known; `before`, of the same parts and camera, spares the rays of the
  /// vertices that did not move; with `asBefore` all rays: what was hidden stays so, while something is
  /// dragged.
  ScreenMesh(const HairMesh& mesh, std::shared_ptr<const PickParts> parts, const Camera& camera, int width,
             int height, const Surface* occluder, const ScreenMesh* before = nullptr, bool asBefore = false);

  /// Where each vertex is, by index.
  std::span<const ScreenPoint> vertices() const { return points_; }
  /// Whether it can be seen and picked, by index.
  bool pickable(std::uint32_t vertex) const { return pickable_[vertex] != 0; }
  ScreenPoint project(const Vec3& world) const;

  /// The nearest within `radiusPx`; of those alike near (within a pixel) the one in front.
  std::optional<VertexId> vertexAt(const Vec2& px, double radiusPx) const;
  std::optional<EdgeRef> edgeAt(const Vec2& px, double radiusPx) const;
  /// The front one whose outline holds the pixel; `hull`: or the bundle's side that is seen there.
  std::optional<FaceRef> faceAt(const Vec2& px, bool hull = false) const;
  /// Where the ray through the pixel meets the hair's outside first.
  std::optional<Vec3> hullAt(const Vec2& px) const;
  /// Where the vertex that can be seen nearest to the pixel is; none when none is seen.
  std::optional<Vec3> nearestSeen(const Vec2& px) const;
  /// The same within `radiusPx`, not counting `except` (ascending).
  std::optional<Vec3> vertexBeside(const Vec2& px, double radiusPx, std::span<const VertexId> except) const;
  const PickParts& parts() const { return *parts_; }

  /// Elements of a kind inside a polygon (a lasso, or a box as four corners): vertices, edges with both ends,
  /// faces with their middle. Bundles, layers and groups count by the faces of their outside.
  Selection inside(std::span<const Vec2> polygon, SelectKind kind) const;
  /// Elements of a kind within `radiusPx`: one dab of a selection brush.
  Selection near(const Vec2& px, double radiusPx, SelectKind kind) const;

 private:
  template <class Test>
  Selection pickWhere(SelectKind kind, const Test& test) const;
  std::optional<HullFace> hullFaceAt(const Vec2& px) const;
  std::span<const std::uint32_t> cornersOf(const HullFace& face) const;

  const HairMesh& mesh_;
  Camera camera_;
  int width_, height_;
  Vec3 right_, up_, forward_;
  double scale_ = 1;
  std::shared_ptr<const PickParts> parts_;
  std::vector<Vec3> positions_;
  std::vector<ScreenPoint> points_;
  std::vector<std::uint8_t> pickable_, seen_;  // seen_: not behind the occluder
};

/// Even–odd rule.
bool insidePolygon(const Vec2& px, std::span<const Vec2> polygon);

}  // namespace coif
