#include "viewport.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "coif/base/random.h"

namespace coif::studio {
namespace {

constexpr double kLeastFramed = 0.04;  // half a framed box, of the whole mesh

/// Whether the two can share what is known of picking: all but where vertices are.
bool sameTopology(const HairMesh& a, const HairMesh& b) {
  const auto alike = [](const HairVertex& v, const HairVertex& w) {
    return v.id == w.id && v.parent == w.parent && v.pinned == w.pinned;
  };
  return std::ranges::equal(a.bundles(), b.bundles()) && std::ranges::equal(a.splits(), b.splits()) &&
         std::ranges::equal(a.vertices(), b.vertices(), alike);
}

}  // namespace

void Viewport::place(const ImVec2& origin, const ImVec2& size) {
  origin_ = origin;
  const float width = settings.beside ? std::floor(0.5f * size.x) : size.x;
  size_ = {std::max(width, 1.0f), std::max(size.y, 1.0f)};
  besideOrigin_ = {origin.x + size.x - width, origin.y};
  hovered_ = !ImGui::GetIO().WantCaptureMouse &&
             ImGui::IsMouseHoveringRect(origin_, {origin_.x + size_.x, origin_.y + size_.y}, false);
}

void Viewport::update(const HairMesh& mesh, std::uint64_t revision, const EditState& state,
                      const Surface* head, bool dragged) {
  std::uint64_t lens = 0;
  for (const Vec3& v : {camera.eye, camera.target, camera.up, Vec3(camera.fovDeg, size_.x, size_.y)}) {
    for (double x : v) lens = hashCombine(lens, std::bit_cast<std::uint64_t>(x));
  }
  const Surface* occluder =
      settings.mesh == MeshStyle::XRay || !settings.showHead || settings.headStyle == HeadStyle::XRay
          ? nullptr
          : head;
  lens = hashCombine(lens, occluder != nullptr ? 1 : 0);
  const std::uint64_t key = hashCombine(hashCombine(revision, lens), std::uint64_t(settings.showInternal));
  const bool settles = hiddenAsBefore_ && !dragged;
  if (screen_ && key == shownKey_ && !settles) return;
  shownKey_ = key;
  const bool known = parts_ && partsInternal_ == settings.showInternal && partsHidden_ == state.hidden &&
                     sameTopology(mesh, partsMesh_);
  if (!known) {
    parts_ = std::make_shared<PickParts>(pickParts(mesh, state.hidden, settings.showInternal));
    partsMesh_ = mesh, partsHidden_ = state.hidden, partsInternal_ = settings.showInternal;
  }
  const bool sameView = known && screen_ && lens == lens_;
  lens_ = lens;
  const ScreenMesh* before = sameView && !settles ? screen_.get() : nullptr;
  hiddenAsBefore_ = dragged && before != nullptr;
  screen_ = std::make_unique<ScreenMesh>(mesh, parts_, camera, width(), height(), occluder, before,
                                         hiddenAsBefore_);
}

Vec2 Viewport::mouse() const {
  const ImVec2 at = ImGui::GetIO().MousePos;
  return Vec2(at.x - origin_.x, at.y - origin_.y);
}

Vec3 Viewport::forward() const {
  return (camera.target - camera.eye).normalized();
}
Vec3 Viewport::right() const {
  return forward().cross(camera.up).normalized();
}
Vec3 Viewport::up() const {
  return right().cross(forward());
}

double Viewport::unitsPerPixel(const Vec3& at) const {
  const double depth = std::max((at - camera.eye).dot(forward()), 1e-9);
  return 2 * depth * std::tan(0.5 * camera.fovDeg * std::numbers::pi / 180) / height();
}

Vec3 Viewport::ray(const Vec2& px) const {
  const double unit = 2 * std::tan(0.5 * camera.fovDeg * std::numbers::pi / 180) / height();
  return forward() + unit * ((px.x() - 0.5 * width()) * right() + (0.5 * height() - px.y()) * up());
}

ScreenPoint Viewport::project(const Vec3& world) const {
  const Vec3 d = world - camera.eye;
  const double depth = d.dot(forward());
  const double pixels =
      0.5 * height() / std::tan(0.5 * camera.fovDeg * std::numbers::pi / 180) / std::max(depth, 1e-300);
  return {Vec2(0.5 * width() + pixels * d.dot(right()), 0.5 * height() - pixels * d.dot(up())), depth};
}

bool Viewport::navigate(bool zooms) {
  const ImGuiIO& io = ImGui::GetIO();
  const Camera before = camera;
  const bool maya = settings.habit == MouseHabit::Maya;
  const bool turning = maya ? io.KeyAlt && io.MouseDown[0] : io.MouseDown[2] && !io.KeyShift && !io.KeyCtrl;
  const bool shifting = maya ? io.KeyAlt && io.MouseDown[2] : io.MouseDown[2] && io.KeyShift;
  const bool zooming = maya ? io.KeyAlt && io.MouseDown[1] : io.MouseDown[2] && io.KeyCtrl;
  if (!io.WantCaptureMouse) {
    if (turning) camera = orbit(camera, upAxis, -0.4 * io.MouseDelta.x, 0.4 * io.MouseDelta.y);
    if (shifting) camera = pan(camera, io.MouseDelta.x, io.MouseDelta.y, height());
    if (zooming) camera = dolly(camera, std::exp(0.005 * io.MouseDelta.y));
    if (zooms && hovered_ && io.MouseWheel != 0 && !io.KeyCtrl)
      camera = dolly(camera, std::pow(0.88, io.MouseWheel));
  }
  return !camera.eye.isApprox(before.eye, 0) || !camera.target.isApprox(before.target, 0);
}

void Viewport::frame(const HairMesh& mesh, const Selection& selection) {
  std::vector<Vec3> points;
  for (std::uint32_t v : selectedVertices(mesh, selection)) points.push_back(mesh.position(v));
  std::vector<Vec3> all;
  for (const HairVertex& vertex : mesh.vertices()) all.push_back(vertex.position);
  if (points.empty()) points = all;
  if (points.empty()) return;
  Box box = bounds(points);
  // A vertex alone has no size: its surroundings are framed.
  const Vec3 least = Vec3::Constant(kLeastFramed * (bounds(all).hi - bounds(all).lo).norm());
  const Vec3 middle = 0.5 * (box.lo + box.hi), half = (0.5 * (box.hi - box.lo)).cwiseMax(least);
  box = {middle - half, middle + half};
  const double fov = camera.fovDeg;
  const Camera framed =
      frameBox(box, upAxis, azimuthDegOf(camera, upAxis), elevationDegOf(camera, upAxis), aspect());
  camera = withLens(framed, fov);
}

void Viewport::lookFrom(double azimuthDeg, double elevationDeg) {
  camera = orbit(camera, upAxis, azimuthDeg - azimuthDegOf(camera, upAxis),
                 elevationDeg - elevationDegOf(camera, upAxis));
}

void Viewport::setParallel(bool on) {
  if (on != parallel()) camera = withLens(camera, on ? kParallelFovDeg : 30);
}

void Viewport::drawPicture(std::uint32_t texture) const {
  if (texture == 0) return;
  ImGui::GetBackgroundDrawList()->AddImage(ImTextureID(std::uintptr_t(texture)), origin_,
                                           {origin_.x + size_.x, origin_.y + size_.y});
  if (settings.beside) {
    ImGui::GetBackgroundDrawList()->AddImage(ImTextureID(std::uintptr_t(texture)), besideOrigin_,
                                             {besideOrigin_.x + size_.x, besideOrigin_.y + size_.y});
  }
}

}  // namespace coif::studio
