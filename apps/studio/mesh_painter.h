// The hair mesh over the picture: lines, faces, what is selected, what is under the mouse, what a tool would
// change.
#pragma once

#include "viewport.h"

namespace coif::studio {

class MeshPainter {
 public:
  /// Paints into the view; `screen()` must be of this mesh.
  MeshPainter(const Viewport& view, const HairMesh& mesh, const EditState& state);

  void paint();
  /// A mask on the root layer, values by vertex: blue where it is 0, to orange where it is 1.
  void paintMask(std::span<const double> values);
  /// Pre-selection: what a click would choose.
  void paintHover(const Selection& under);
  /// What a tool would add to `before` (green), or take away (red).
  void paintChanges(const HairMesh& before);

 private:
  void paintShaded();
  void paintEdges();
  void paintVertices();
  void paintSelectedFaces();
  void line(std::uint32_t a, std::uint32_t b, ImU32 color, float width);
  ImVec2 at(std::uint32_t vertex) const { return view_.toWindow(view_.screen()->vertices()[vertex].px); }
  ImU32 colorOf(const FaceRef& face, float alpha, float light = 1) const;

  const Viewport& view_;
  const HairMesh& mesh_;
  const EditState& state_;
  ImDrawList& list_;
};

}  // namespace coif::studio
