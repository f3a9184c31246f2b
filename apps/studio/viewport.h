// The view: camera by mouse, the picture behind, the hair mesh over it, what is under the mouse.
#pragma once

#include <imgui.h>

#include <memory>
#include <optional>
#include <vector>

#include "coif/preview/preview.h"
#include "coif/scene/editor.h"
#include "coif/scene/navigation.h"
#include "coif/scene/picking.h"

namespace coif::studio {

enum class MeshStyle { Hidden, Wire, Shaded, XRay };
enum class MeshColor { Layer, Bundle, Group };
enum class HeadStyle { Shaded, Wire, XRay };
enum class MouseHabit { Blender, Maya };

struct ViewSettings {
  MeshStyle mesh = MeshStyle::Wire;
  MeshColor color = MeshColor::Layer;
  HeadStyle headStyle = HeadStyle::Shaded;
  bool showInternal = false, showHead = true, showStrands = true, grid = true, axes = true;
  bool beside = false;  ///< the mesh at the left, the strands alone at the right
  bool turntable = false;
  PreviewShading shading = PreviewShading::Studio;
  bool shadows = true;
  SelectKind kind = SelectKind::Vertex;
  MouseHabit habit = MouseHabit::Blender;
};

class Viewport {
 public:
  ViewSettings settings;
  Camera camera;
  UpAxis upAxis = UpAxis::Y;
  float scale = 1;  ///< of the display: what is drawn and grabbed is so much larger

  /// Places the view in the window, in pixels; call first in a frame.
  void place(const ImVec2& origin, const ImVec2& size);
  /// Projects `mesh` anew where it, the camera or the settings changed. `revision` names the mesh's state.
  /// `dragged`: what the head hides is not looked for again until that is over.
  void update(const HairMesh& mesh, std::uint64_t revision, const EditState& state, const Surface* head,
              bool dragged);
  /// Orbit, pan and, with `zooms`, the wheel; true while the camera moves.
  bool navigate(bool zooms);
  /// Box of everything, or of the selection when there is one.
  void frame(const HairMesh& mesh, const Selection& selection);

  /// Turns the camera about its target to stand there; degrees.
  void lookFrom(double azimuthDeg, double elevationDeg);
  bool parallel() const { return camera.fovDeg < 1; }
  void setParallel(bool on);

  /// The picture, twice where the strands stand beside the mesh.
  void drawPicture(std::uint32_t texture) const;
  bool hovered() const { return hovered_; }
  Vec2 mouse() const;  ///< in the view's own pixels
  const ScreenMesh* screen() const { return screen_.get(); }
  int width() const { return int(size_.x); }
  int height() const { return int(size_.y); }
  double aspect() const { return size_.y > 0 ? double(size_.x) / double(size_.y) : 1; }
  const ImVec2& origin() const { return origin_; }
  const ImVec2& besideOrigin() const { return besideOrigin_; }
  const ImVec2& size() const { return size_; }
  ImVec2 toWindow(const Vec2& px) const { return {origin_.x + float(px.x()), origin_.y + float(px.y())}; }
  /// Scene units a pixel, at the depth of a point.
  double unitsPerPixel(const Vec3& at) const;
  /// From the eye through a pixel; its part along forward() is 1.
  Vec3 ray(const Vec2& px) const;
  ScreenPoint project(const Vec3& world) const;
  Vec3 right() const, up() const, forward() const;

 private:
  ImVec2 origin_{0, 0}, size_{1, 1};
  ImVec2 besideOrigin_{0, 0};
  bool hovered_ = false;
  std::unique_ptr<ScreenMesh> screen_;
  std::uint64_t shownKey_ = 0, lens_ = 0;
  std::shared_ptr<const PickParts> parts_;  // of partsMesh_, with these hidden
  HairMesh partsMesh_;
  std::vector<BundleId> partsHidden_;
  bool partsInternal_ = false, hiddenAsBefore_ = false;
};

}  // namespace coif::studio
