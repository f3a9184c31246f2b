#include "tools.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace coif::studio {
namespace {

constexpr double kClickPx = 4;  // a drag shorter than this is a click

}  // namespace

ModalTool::ModalTool(Kind kind, const Editor& editor, const Viewport& view, double softRadius)
    : kind_(kind), start_(view.mouse()), mouse_(view.mouse()), softRadius_(softRadius) {
  const auto chosen = selectedVertices(editor.mesh(), editor.state().selection);
  for (std::uint32_t v : chosen) pivot_ += editor.mesh().position(v) / double(chosen.size());
}

void ModalTool::update(const Viewport& view, const Keys& keys) {
  mouse_ = view.mouse();
  for (const auto& [key, axis] : {std::pair("X", 0), std::pair("Y", 1), std::pair("Z", 2)}) {
    if (keys.pressed(key)) axis_ = axis_ == axis ? -1 : axis;
  }
  typed_ += typedNumber();
  if (keys.pressed("Backspace") && !typed_.empty()) typed_.pop_back();
  const ImGuiIO& io = ImGui::GetIO();
  confirmed_ = keys.pressed("Enter") || (ImGui::IsMouseClicked(0) && !io.WantCaptureMouse);
  dropped_ = keys.pressed("Escape") || ImGui::IsMouseClicked(1);
}

const char* ModalTool::command() const {
  switch (kind_) {
    case Kind::Move:
      return "translate";
    case Kind::Rotate:
      return "rotate";
    case Kind::Scale:
      return "scale";
    case Kind::Extrude:
      break;
  }
  return "extrude";
}

Vec3 ModalTool::moveBy(const Viewport& view) const {
  if (!typed_.empty()) return std::strtod(typed_.c_str(), nullptr) * Vec3::Unit(axis_ < 0 ? 0 : axis_);
  const double unit = view.unitsPerPixel(pivot_);
  const Vec2 d = mouse_ - start_;
  const Vec3 free = unit * (d.x() * view.right() - d.y() * view.up());
  if (axis_ < 0) return free;
  // Along an axis as it is seen: the mouse's part along the axis's own picture.
  const Vec3 axis = Vec3::Unit(axis_);
  const Vec2 seen(axis.dot(view.right()), -axis.dot(view.up()));
  return seen.squaredNorm() > 1e-4 ? Vec3(unit * d.dot(seen) / seen.squaredNorm() * axis)
                                   : Vec3(Vec3::Zero());
}

double ModalTool::angleDeg(const Viewport& view) const {
  if (!typed_.empty()) return std::strtod(typed_.c_str(), nullptr);
  const Vec2 centre = view.screen()->project(pivot_).px, a = start_ - centre, b = mouse_ - centre;
  return -std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * 180 / std::numbers::pi;
}

CommandArguments ModalTool::arguments(const Viewport& view) const {
  CommandArguments out;
  if (kind_ == Kind::Move) {
    out["by"] = moveBy(view);
  } else if (kind_ == Kind::Rotate) {
    out["axis"] = axis_ < 0 ? Vec3(-view.forward()) : Vec3(Vec3::Unit(axis_));
    out["angle"] = angleDeg(view);
  } else if (kind_ == Kind::Scale) {
    const Vec2 centre = view.screen()->project(pivot_).px;
    const double factor = typed_.empty() ? (mouse_ - centre).norm() / std::max((start_ - centre).norm(), 1.0)
                                         : std::strtod(typed_.c_str(), nullptr);
    Vec3 factors = Vec3::Constant(factor);
    if (axis_ >= 0) factors = Vec3::Ones(), factors[axis_] = factor;
    out["factors"] = factors;
  } else {
    const double dragged = view.unitsPerPixel(pivot_) * (start_.y() - mouse_.y());
    out["distance"] = typed_.empty() ? dragged : std::strtod(typed_.c_str(), nullptr);
  }
  if (kind_ != Kind::Extrude && softRadius_ > 0) out["radius"] = softRadius_;
  return out;
}

std::string ModalTool::status() const {
  std::string text = command();
  if (axis_ >= 0) text += std::string(" along ") + "xyz"[axis_];
  if (!typed_.empty()) text += ": " + typed_;
  return text + "   (X Y Z: axis, digits: exact, Enter: done, Esc: drop)";
}

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

CommandArguments SelectTool::picked(const Viewport&, const Selection& selection) const {
  const ImGuiIO& io = ImGui::GetIO();
  const bool click = path_.size() < 2;
  return selectArguments(selection, io.KeyShift && io.KeyAlt ? "remove"
                                    : io.KeyShift            ? (click ? "toggle" : "add")
                                                             : "set");
}

std::optional<CommandArguments> SelectTool::update(const Viewport& view) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool navigating = view.settings.habit == MouseHabit::Maya && io.KeyAlt;
  if (!active_ && view.hovered() && ImGui::IsMouseClicked(0) && !navigating) {
    active_ = true, lasso_ = io.KeyCtrl;
    path_ = {view.mouse()};
  }
  if (!active_) return std::nullopt;
  const bool moved = (view.mouse() - path_.front()).norm() > kClickPx;
  if (moved || path_.size() > 1) {
    if (lasso_ && (view.mouse() - path_.back()).norm() > 2) path_.push_back(view.mouse());
    if (!lasso_) {
      const Vec2 a = path_.front(), b = view.mouse();
      path_ = {a, Vec2(b.x(), a.y()), b, Vec2(a.x(), b.y())};
    }
  }
  if (io.MouseDown[0]) return std::nullopt;
  active_ = false;
  Selection found;
  if (path_.size() >= 3) {
    found = view.screen()->inside(path_, view.settings.kind);
  } else if (view.settings.kind == SelectKind::Vertex) {
    if (const auto id = view.screen()->vertexAt(view.mouse(), 12)) found.vertices = {*id};
  } else if (view.settings.kind == SelectKind::Edge) {
    if (const auto edge = view.screen()->edgeAt(view.mouse(), 8)) found.edges = {*edge};
  } else if (const auto face = view.screen()->faceAt(view.mouse())) {
    found.faces = {*face};
  }
  const CommandArguments arguments = picked(view, found);
  path_.clear();
  return arguments;
}

void SelectTool::draw(const Viewport& view) const {
  if (!active_ || path_.size() < 2) return;
  std::vector<ImVec2> outline;
  for (const Vec2& px : path_) outline.push_back(view.toWindow(px));
  ImGui::GetForegroundDrawList()->AddPolyline(outline.data(), int(outline.size()),
                                              IM_COL32(255, 255, 255, 200), ImDrawFlags_Closed, 1.5f);
}

}  // namespace coif::studio
