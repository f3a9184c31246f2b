#include "transform_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace coif::studio {
namespace {

constexpr double kSnapPx = 24, kTurnSnapDeg = 15, kScaleSnap = 0.1;

/// Where the ray through a pixel meets the plane; none where it runs along it or away from it.
std::optional<Vec3> onPlane(const Viewport& view, const Vec2& px, const Vec3& point, const Vec3& normal) {
  const Vec3 ray = view.ray(px);
  const double along = ray.dot(normal);
  if (std::abs(along) < 1e-6 * ray.norm()) return std::nullopt;
  const double t = (point - view.camera.eye).dot(normal) / along;
  return t > 0 ? std::optional<Vec3>(view.camera.eye + t * ray) : std::nullopt;
}

double rounded(double value, double step) {
  return step > 0 ? step * std::round(value / step) : value;
}

}  // namespace

TransformTool::TransformTool(HandTool hand, const Editor& editor, const Viewport& view,
                             const ToolSettings& settings, const Surface* head,
                             std::optional<Constraint> held)
    : hand_(hand),
      constraint_(held.value_or(Constraint{})),
      held_(held.has_value()),
      start_(view.mouse()),
      mouse_(view.mouse()),
      soft_(settings.soft),
      snap_(settings.snap),
      head_(head) {
  const auto chosen = selectedVertices(editor.mesh(), editor.state().selection);
  for (std::uint32_t v : chosen) {
    pivot_ += editor.mesh().position(v) / double(chosen.size());
    own_.push_back(editor.mesh().vertices()[v].id);
  }
  axes_ = selectionAxes(editor.mesh(), chosen, settings.axes);
}

void TransformTool::takeConstraint(const Keys& keys) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string key(1, "XYZ"[axis]);
    const Constraint line{Constraint::Kind::Axis, axis}, plane{Constraint::Kind::Plane, axis};
    if (keys.pressed(key)) constraint_ = constraint_ == line ? Constraint{} : line;
    if (keys.pressed("Shift+" + key)) constraint_ = constraint_ == plane ? Constraint{} : plane;
  }
}

void TransformTool::update(const Viewport& view, const Keys& keys) {
  const ImGuiIO& io = ImGui::GetIO();
  mouse_ = view.mouse();
  takeConstraint(keys);
  typed_.take(keys);
  if (soft_.radius > 0 && io.MouseWheel != 0) soft_.radius *= std::pow(1.15, double(io.MouseWheel));
  snapping_ = snap_.on != io.KeyCtrl;
  snapMark_.reset();
  if (hand_ == HandTool::Move) {
    by_ = moveBy(view);
  } else if (hand_ == HandTool::Rotate) {
    axis_ = axisOf(view);
    angleDeg_ = turnDeg(view);
  } else {
    factors_ = factors(view);
  }
  takeEnd(keys, held_);
}

Vec3 TransformTool::moveBy(const Viewport& view) {
  if (typed_.any()) {
    if (constraint_.kind == Constraint::Kind::Axis)
      return typed_.number(0) * axes_.col(constraint_.axis) + Vec3::Zero();  // no −0
    Vec3 by = Vec3::Zero();
    for (std::size_t i = 0, next = 0; i < 3; ++i) {
      if (constraint_.allows(int(i))) by[Eigen::Index(i)] = typed_.number(next++);
    }
    return axes_ * by + Vec3::Zero();
  }
  Vec3 by = Vec3::Zero();
  if (constraint_.kind == Constraint::Kind::Plane) {
    const Vec3 normal = axes_.col(constraint_.axis);
    const auto a = onPlane(view, start_, pivot_, normal), b = onPlane(view, mouse_, pivot_, normal);
    if (a && b) by = *b - *a;
  } else {
    const double unit = view.unitsPerPixel(pivot_);
    const Vec2 d = mouse_ - start_;
    by = unit * (d.x() * view.right() - d.y() * view.up());
    if (constraint_.kind == Constraint::Kind::Axis) {
      // Along an axis as it is seen: the mouse's part along the axis's own picture.
      const Vec3 axis = axes_.col(constraint_.axis);
      const Vec2 seen(axis.dot(view.right()), -axis.dot(view.up()));
      by = seen.squaredNorm() > 1e-4 ? Vec3(unit * d.dot(seen) / seen.squaredNorm() * axis)
                                     : Vec3(Vec3::Zero());
    }
  }
  return snapping_ ? snapped(view, by) : by;
}

Vec3 TransformTool::snapped(const Viewport& view, const Vec3& by) {
  Vec3 to = pivot_ + by;
  if (snap_.to == SnapTo::Grid) {
    for (int i = 0; i < 3; ++i) to[i] = rounded(to[i], snap_.step);
  } else if (snap_.to == SnapTo::Vertex) {
    const auto found = view.screen()->vertexBeside(mouse_, kSnapPx * view.scale, own_);
    if (!found) return by;
    to = *found;
  } else {
    SurfacePoint hit;
    const Vec3 ray = view.ray(mouse_).normalized();
    if (head_ == nullptr || !head_->intersect(view.camera.eye, ray, 1e12, hit)) return by;
    to = hit.position;
  }
  snapMark_ = to;
  return constraint_.apply(to - pivot_, axes_);
}

Vec3 TransformTool::axisOf(const Viewport& view) const {
  return constraint_.kind == Constraint::Kind::Free ? Vec3(-view.forward())
                                                    : Vec3(axes_.col(constraint_.axis));
}

double TransformTool::turnDeg(const Viewport& view) const {
  if (typed_.any()) return typed_.number(0);
  const Vec2 centre = view.project(pivot_).px, a = start_ - centre, b = mouse_ - centre;
  // Pixels have y down; an axis that points away from the eye turns the other way.
  const double seen = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * 180 / std::numbers::pi;
  const double turn = axis_.dot(view.forward()) > 0 ? seen : -seen;
  return snapping_ ? rounded(turn, kTurnSnapDeg) : turn;
}

Vec3 TransformTool::factors(const Viewport& view) const {
  double factor = 1;
  if (typed_.any()) {
    factor = typed_.number(0);
  } else {
    const Vec2 centre = view.project(pivot_).px;
    Vec2 a = start_ - centre, b = mouse_ - centre;
    if (held_ && constraint_.kind == Constraint::Kind::Axis) {
      const Vec3 axis = axes_.col(constraint_.axis);
      const Vec2 seen = Vec2(axis.dot(view.right()), -axis.dot(view.up())).normalized();
      factor = b.dot(seen) / std::max(std::abs(a.dot(seen)), 1.0);
    } else if (held_ && constraint_.kind == Constraint::Kind::Free) {
      factor = std::exp((b.x() - a.x() - b.y() + a.y()) / 150);  // the middle handle begins at no distance
    } else {
      factor = b.norm() / std::max(a.norm(), 1.0);
    }
    if (snapping_) factor = rounded(factor, kScaleSnap);
  }
  Vec3 out = Vec3::Ones();
  for (int i = 0; i < 3; ++i) {
    if (constraint_.allows(i)) out[i] = factor;
  }
  return out;
}

std::string TransformTool::command() const {
  return hand_ == HandTool::Move ? "translate" : hand_ == HandTool::Rotate ? "rotate" : "scale";
}

CommandArguments TransformTool::arguments() const {
  CommandArguments out;
  if (hand_ == HandTool::Move) {
    out["by"] = by_;
  } else if (hand_ == HandTool::Rotate) {
    out["axis"] = axis_, out["angle"] = angleDeg_;
  } else {
    out["factors"] = factors_;
    const bool even = constraint_.kind == Constraint::Kind::Free;
    if (!even && axes_ != Mat3::Identity()) out["axes"] = std::vector<double>(axes_.data(), axes_.data() + 9);
  }
  soft_.addTo(out);
  return out;
}

std::string TransformTool::label() const {
  char text[120];
  if (hand_ == HandTool::Move) {
    std::snprintf(text, sizeof text, "%.4g, %.4g, %.4g", by_.x(), by_.y(), by_.z());
  } else if (hand_ == HandTool::Rotate) {
    std::snprintf(text, sizeof text, "%.1f°", angleDeg_);
  } else {
    std::snprintf(text, sizeof text, "× %.3g, %.3g, %.3g", factors_.x(), factors_.y(), factors_.z());
  }
  return text;
}

std::string TransformTool::status() const {
  std::string text = kHandToolNames[int(hand_)];
  const char axis = "XYZ"[constraint_.axis];
  if (constraint_.kind == Constraint::Kind::Axis) text += std::string(" along ") + axis;
  if (constraint_.kind == Constraint::Kind::Plane) text += std::string(" without ") + axis;
  if (axes_ != Mat3::Identity()) text += " (own axes)";
  if (typed_.any()) text += ": " + typed_.text();
  return text + "   (X Y Z: axis, Shift: plane, digits: exact, Ctrl: snap, wheel: soft radius, Esc: drop)";
}

void TransformTool::draw(const Viewport& view) const {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const double unit = view.unitsPerPixel(pivot_);
  const ImVec2 middle = view.toWindow(view.project(pivot_).px);
  if (soft_.radius > 0)
    list.AddCircle(middle, float(soft_.radius / unit), IM_COL32(255, 255, 255, 140), 64, 1.5f * view.scale);
  for (int i = 0; i < 3 && constraint_.kind != Constraint::Kind::Free; ++i) {
    if (!constraint_.allows(i)) continue;
    constexpr ImU32 kColors[] = {IM_COL32(235, 78, 84, 150), IM_COL32(120, 200, 70, 150),
                                 IM_COL32(74, 140, 245, 150)};
    const Vec3 reach = 2000 * unit * axes_.col(i);
    list.AddLine(view.toWindow(view.project(pivot_ - reach).px),
                 view.toWindow(view.project(pivot_ + reach).px), kColors[i], 1.2f * view.scale);
  }
  if (snapMark_) {
    const ImVec2 at = view.toWindow(view.project(*snapMark_).px);
    list.AddCircle(at, 7 * view.scale, IM_COL32(255, 225, 90, 255), 4, 2.5f * view.scale);
  }
}

}  // namespace coif::studio
