#include "viewport.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <set>

#include "coif/base/random.h"

namespace coif::studio {
namespace {

constexpr ImU32 kSelected = IM_COL32(255, 170, 40, 255), kHover = IM_COL32(255, 235, 150, 255),
                kVertex = IM_COL32(20, 20, 24, 255), kPinned = IM_COL32(90, 200, 255, 255),
                kFrozen = IM_COL32(120, 120, 140, 255);

/// One colour a layer, from the root's green to the tips' violet.
ImU32 layerColor(std::uint32_t layer, float alpha) {
  float r, g, b;
  ImGui::ColorConvertHSVtoRGB(std::fmod(0.36f + 0.11f * float(layer), 1.0f), 0.45f, 0.95f, r, g, b);
  return ImGui::ColorConvertFloat4ToU32({r, g, b, alpha});
}

}  // namespace

void Viewport::place(const ImVec2& origin, const ImVec2& size) {
  origin_ = origin;
  size_ = {std::max(size.x, 1.0f), std::max(size.y, 1.0f)};
  hovered_ = !ImGui::GetIO().WantCaptureMouse &&
             ImGui::IsMouseHoveringRect(origin_, {origin_.x + size_.x, origin_.y + size_.y}, false);
}

void Viewport::update(const HairMesh& mesh, std::uint64_t revision, const EditState& state,
                      const Surface* head) {
  std::uint64_t key =
      hashCombine(revision, std::uint64_t(settings.showInternal) + 2 * std::uint64_t(settings.mesh));
  for (const Vec3& v : {camera.eye, camera.target, Vec3(camera.fovDeg, size_.x, size_.y)}) {
    for (double x : v) key = hashCombine(key, std::bit_cast<std::uint64_t>(x));
  }
  if (screen_ && key == shownKey_) return;
  shownKey_ = key;
  PickOptions options;
  options.hidden = state.hidden;
  options.internal = settings.showInternal;
  options.occluder = settings.mesh == MeshStyle::XRay ? nullptr : head;
  screen_ = std::make_unique<ScreenMesh>(mesh, camera, width(), height(), options);
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

bool Viewport::navigate() {
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
    if (hovered_ && io.MouseWheel != 0 && !io.KeyCtrl) camera = dolly(camera, std::pow(0.88, io.MouseWheel));
  }
  return !camera.eye.isApprox(before.eye, 0) || !camera.target.isApprox(before.target, 0);
}

void Viewport::frame(const HairMesh& mesh, const Selection& selection) {
  std::vector<Vec3> points;
  for (std::uint32_t v : selectedVertices(mesh, selection)) points.push_back(mesh.position(v));
  if (points.empty()) {
    for (const HairVertex& vertex : mesh.vertices()) points.push_back(vertex.position);
  }
  if (points.empty()) return;
  const double fov = camera.fovDeg;
  const Camera framed = frameBox(bounds(points), upAxis, azimuthDegOf(camera, upAxis),
                                 elevationDegOf(camera, upAxis), aspect());
  camera = withLens(framed, fov);
}

void Viewport::drawPicture(std::uint32_t texture) const {
  if (texture == 0) return;
  ImGui::GetBackgroundDrawList()->AddImage(ImTextureID(std::uintptr_t(texture)), origin_,
                                           {origin_.x + size_.x, origin_.y + size_.y});
}

void Viewport::drawMesh(const HairMesh& mesh, const EditState& state) const {
  if (settings.mesh == MeshStyle::Hidden || !screen_) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect(origin_, {origin_.x + size_.x, origin_.y + size_.y});
  drawFaces(list, mesh, state);
  drawEdges(list, mesh, state);
  if (settings.kind == SelectKind::Vertex) drawVertices(list, mesh, state);
  drawHover(list, mesh);
  list.PopClipRect();
}

void Viewport::drawFaces(ImDrawList& list, const HairMesh& mesh, const EditState& state) const {
  for (const FaceRef& face : state.selection.faces) {
    const auto corners = mesh.bundles()[mesh.indexOf(face.bundle)].face(face.layer);
    std::vector<ImVec2> outline;
    bool seen = true;
    for (std::uint32_t v : corners) {
      outline.push_back(toWindow(screen_->vertices()[v].px));
      seen = seen && screen_->pickable(v);
    }
    if (seen) list.AddConvexPolyFilled(outline.data(), int(outline.size()), IM_COL32(255, 170, 40, 90));
  }
}

void Viewport::drawEdges(ImDrawList& list, const HairMesh& mesh, const EditState& state) const {
  const auto vertices = mesh.vertices();
  const auto line = [&](std::uint32_t a, std::uint32_t b, ImU32 color, float width) {
    if (!screen_->pickable(a) || !screen_->pickable(b)) return;
    list.AddLine(toWindow(screen_->vertices()[a].px), toWindow(screen_->vertices()[b].px), color, width);
  };
  std::set<std::pair<std::uint32_t, std::uint32_t>> drawn;
  for (const Bundle& bundle : mesh.bundles()) {
    if (std::ranges::binary_search(state.hidden, bundle.id)) continue;
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      if (!settings.showInternal && layer > 0 && layer < bundle.height()) continue;
      const auto face = bundle.face(layer);
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const auto edge = std::minmax(face[i], face[(i + 1) % bundle.corners]);
        if (drawn.insert(edge).second) line(edge.first, edge.second, layerColor(layer, 0.55f), 1.0f);
      }
    }
  }
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    if (vertices[v].parent != kNone) line(vertices[v].parent, v, layerColor(vertices[v].layer, 0.35f), 1.0f);
  }
  for (const EdgeRef& edge : state.selection.edges) {
    const auto ends = selectedVertices(mesh, {{}, {edge}, {}});
    line(ends[0], ends[1], kSelected, 2.5f);
  }
}

void Viewport::drawVertices(ImDrawList& list, const HairMesh& mesh, const EditState& state) const {
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (!screen_->pickable(v)) continue;
    const HairVertex& vertex = mesh.vertices()[v];
    const bool selected = std::ranges::binary_search(state.selection.vertices, vertex.id);
    const bool frozen = std::ranges::binary_search(state.frozen, vertex.id);
    list.AddCircleFilled(toWindow(screen_->vertices()[v].px), selected ? 4.0f : 2.5f,
                         selected        ? kSelected
                         : frozen        ? kFrozen
                         : vertex.pinned ? kPinned
                                         : kVertex);
  }
}

void Viewport::drawHover(ImDrawList& list, const HairMesh& mesh) const {
  if (!hovered_ || ImGui::IsAnyMouseDown()) return;
  if (settings.kind == SelectKind::Vertex) {
    if (const auto id = screen_->vertexAt(mouse(), 12)) {
      list.AddCircle(toWindow(screen_->vertices()[mesh.indexOf(*id)].px), 6, kHover, 0, 2);
    }
  } else if (settings.kind == SelectKind::Edge) {
    if (const auto edge = screen_->edgeAt(mouse(), 8)) {
      const auto ends = selectedVertices(mesh, {{}, {*edge}, {}});
      list.AddLine(toWindow(screen_->vertices()[ends[0]].px), toWindow(screen_->vertices()[ends[1]].px),
                   kHover, 3);
    }
  } else if (const auto face = screen_->faceAt(mouse())) {
    std::vector<ImVec2> outline;
    for (std::uint32_t v : mesh.bundles()[mesh.indexOf(face->bundle)].face(face->layer)) {
      outline.push_back(toWindow(screen_->vertices()[v].px));
    }
    list.AddPolyline(outline.data(), int(outline.size()), kHover, ImDrawFlags_Closed, 2.5f);
  }
}

}  // namespace coif::studio
