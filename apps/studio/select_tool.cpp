#include "select_tool.h"

#include <algorithm>
#include <cmath>

namespace coif::studio {
namespace {

constexpr double kClickPx = 4;  // a drag shorter than this is a click
constexpr double kVertexPx = 12, kEdgePx = 8;

void merge(Selection& into, const Selection& more) {
  const auto all = [](auto& list, const auto& with) {
    list.insert(list.end(), with.begin(), with.end());
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  all(into.vertices, more.vertices), all(into.edges, more.edges), all(into.faces, more.faces);
}

}  // namespace

CommandArguments selectArguments(const Selection& selection, const std::string& mode) {
  CommandArguments out{{"mode", mode}};
  std::vector<double> vertices, edges, faces;
  for (VertexId id : selection.vertices) vertices.push_back(std::uint32_t(id));
  for (const EdgeRef& edge : selection.edges) {
    edges.insert(edges.end(), {double(std::uint32_t(edge.bundle)), double(edge.layer), double(edge.side)});
  }
  for (const FaceRef& face : selection.faces) {
    faces.insert(faces.end(), {double(std::uint32_t(face.bundle)), double(face.layer)});
  }
  if (!vertices.empty()) out["vertices"] = vertices;
  if (!edges.empty()) out["edges"] = edges;
  if (!faces.empty()) out["faces"] = faces;
  return out;
}

Selection under(const Viewport& view, const HairMesh& mesh) {
  Selection found;
  const SelectKind kind = view.settings.kind;
  if (kind == SelectKind::Vertex) {
    if (const auto id = view.screen()->vertexAt(view.mouse(), kVertexPx * view.scale)) found.vertices = {*id};
  } else if (kind == SelectKind::Edge) {
    if (const auto edge = view.screen()->edgeAt(view.mouse(), kEdgePx * view.scale)) found.edges = {*edge};
  } else if (const auto face = view.screen()->faceAt(view.mouse(), kind != SelectKind::Face)) {
    found.faces = {*face};
  }
  return widened(mesh, found, kind);
}

std::vector<Wish> SelectTool::update(const Viewport& view, const HairMesh& mesh) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool maya = view.settings.habit == MouseHabit::Maya;
  if (!active_ && view.hovered() && ImGui::IsMouseClicked(0) && !(maya && io.KeyAlt)) {
    active_ = true;
    const bool twice = ImGui::IsMouseDoubleClicked(0);
    ring_ = maya ? twice && io.KeyCtrl : io.KeyAlt && io.KeyCtrl;
    loop_ = maya ? twice && !io.KeyCtrl : io.KeyAlt && !io.KeyCtrl && !io.KeyShift;
    lasso_ = io.KeyCtrl && !ring_;
    path_ = {view.mouse()};
  }
  if (!active_) return {};
  const bool moved = (view.mouse() - path_.front()).norm() > kClickPx * view.scale;
  if (moved || path_.size() > 1) {
    if (lasso_ && (view.mouse() - path_.back()).norm() > 2) path_.push_back(view.mouse());
    if (!lasso_) {
      const Vec2 a = path_.front(), b = view.mouse();
      path_ = {a, Vec2(b.x(), a.y()), b, Vec2(a.x(), b.y())};
    }
  }
  if (io.MouseDown[0]) return {};
  active_ = false;
  return finish(view, mesh);
}

std::vector<Wish> SelectTool::finish(const Viewport& view, const HairMesh& mesh) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool click = path_.size() < 3;
  std::vector<Wish> wishes;
  if (click && (loop_ || ring_)) {
    wishes = along(view, mesh, ring_);
  } else {
    const Selection found =
        click ? under(view, mesh)
              : widened(mesh, view.screen()->inside(path_, view.settings.kind), view.settings.kind);
    const char* mode = io.KeyShift && io.KeyAlt ? "remove" : io.KeyShift ? (click ? "toggle" : "add") : "set";
    wishes = {{"select", selectArguments(found, mode)}};
  }
  path_.clear();
  return wishes;
}

std::vector<Wish> SelectTool::along(const Viewport& view, const HairMesh& mesh, bool ring) const {
  const auto edge = view.screen()->edgeAt(view.mouse(), 3 * kEdgePx * view.scale);
  if (!edge) return {};
  const Selection found{{}, ring ? edgeRing(mesh, *edge) : edgeLoop(mesh, *edge), {}};
  return {{"select", selectArguments(found, "set")}};
}

std::vector<Wish> SelectTool::paint(const Viewport& view, const HairMesh& mesh, ToolSettings& settings) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool navigating = view.settings.habit == MouseHabit::Maya && io.KeyAlt;
  if (!painting_ && view.hovered() && ImGui::IsMouseClicked(0) && !navigating) {
    painting_ = true, erasing_ = io.KeyCtrl;
    painted_ = {};
  }
  if (!painting_) return {};
  const SelectKind kind = view.settings.kind;
  merge(painted_, widened(mesh, view.screen()->near(view.mouse(), settings.paintRadiusPx, kind), kind));
  if (io.MouseDown[0]) return {};
  painting_ = false;
  if (painted_.empty()) return {};
  return {{"select", selectArguments(painted_, erasing_ ? "remove" : "add")}};
}

void SelectTool::draw(const Viewport& view, const ToolSettings& settings) const {
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  if (settings.hand == HandTool::Paint && view.hovered()) {
    list.AddCircle(view.toWindow(view.mouse()), float(settings.paintRadiusPx),
                   painting_ ? IM_COL32(255, 170, 40, 255) : IM_COL32(255, 255, 255, 200), 48, 1.5f);
  }
  if (!active_ || path_.size() < 2) return;
  std::vector<ImVec2> outline;
  for (const Vec2& px : path_) outline.push_back(view.toWindow(px));
  if (!lasso_) list.AddConvexPolyFilled(outline.data(), int(outline.size()), IM_COL32(255, 255, 255, 18));
  list.AddPolyline(outline.data(), int(outline.size()), IM_COL32(255, 255, 255, 200), ImDrawFlags_Closed,
                   1.5f);
}

}  // namespace coif::studio
