#include "brush_tool.h"

#include <algorithm>
#include <cmath>

namespace coif::studio {
namespace {

constexpr double kLeastPx = 4, kMostPx = 600, kPathStepPx = 3;

/// Brushes that act on the surface under the mouse, not on what they hold.
bool followsSurface(const std::string& kind) {
  return kind == "push" || kind == "pull" || kind == "inflate" || kind == "smooth";
}

}  // namespace

Vec3 BrushTool::placeOf(const Viewport& view) const {
  const Vec2 px = view.mouse();
  SurfacePoint point;
  if (over_ != nullptr && over_->intersect(view.camera.eye, view.ray(px), 1e12, point)) return point.position;
  if (const auto hit = view.screen()->hullAt(px)) return *hit;
  // Beside the hair: as deep as the nearest vertex that is seen, or as the stroke was.
  const Vec3 like =
      !path_.empty() ? path_.back() : view.screen()->nearestSeen(px).value_or(view.camera.target);
  return view.camera.eye + (like - view.camera.eye).dot(view.forward()) * view.ray(px);
}

void BrushTool::resize(const Viewport& view, const Keys& keys, BrushSettings& settings) {
  const double moved = view.mouse().x() - resizeFrom_.x();
  if (resizing_ == Resizing::Size) {
    settings.radiusPx = std::clamp(before_ + moved, kLeastPx, kMostPx);
  } else {
    settings.strength = std::clamp(before_ + moved / 200, 0.0, 1.0);
  }
  tookKeys_ = true;
  if (keys.pressed("Escape") || ImGui::IsMouseClicked(1)) {
    (resizing_ == Resizing::Size ? settings.radiusPx : settings.strength) = before_;
    resizing_ = Resizing::No;
  } else if (keys.pressed("Enter") || ImGui::IsMouseClicked(0)) {
    resizing_ = Resizing::No;
  }
}

void BrushTool::takeKeys(const Viewport& view, const Keys& keys, BrushSettings& settings) {
  const auto begin = [&](Resizing what, double value) {
    resizing_ = what, before_ = value, resizeFrom_ = view.mouse(), tookKeys_ = true;
  };
  if (keys.pressed("F")) begin(Resizing::Size, settings.radiusPx);
  if (keys.pressed("Shift+F")) begin(Resizing::Strength, settings.strength);
  for (const auto& [key, factor] : {std::pair("[", 1 / 1.2), std::pair("]", 1.2)}) {
    if (!keys.pressed(key)) continue;
    settings.radiusPx = std::clamp(settings.radiusPx * factor, kLeastPx, kMostPx);
    tookKeys_ = true;
  }
}

CommandArguments BrushTool::stroke(const Viewport& view, const BrushSettings& settings) const {
  std::vector<double> numbers;
  for (const Vec3& p : path_) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  CommandArguments out{{"kind", smooths_ ? std::string("smooth") : settings.kind},
                       {"path", std::move(numbers)},
                       {"radius", radius_},
                       {"strength", inverted_ && !smooths_ ? -settings.strength : settings.strength}};
  if (settings.falloff != "smooth") out["falloff"] = settings.falloff;
  if (settings.through) out["through"] = view.forward();
  if (settings.onlySelected) out["selected"] = true;
  if (!settings.keepOut) out["keep_out"] = false;
  return out;
}

std::optional<BrushWork> BrushTool::update(const Viewport& view, const Keys& keys, BrushSettings& settings,
                                           const Surface* over) {
  tookKeys_ = false, over_ = over;
  if (resizing_ != Resizing::No) {
    resize(view, keys, settings);
    return std::nullopt;
  }
  const ImGuiIO& io = ImGui::GetIO();
  if (!stroking()) {
    if (!io.WantTextInput) takeKeys(view, keys, settings);
    const bool navigating = view.settings.habit == MouseHabit::Maya && io.KeyAlt;
    if (!view.hovered() || !ImGui::IsMouseClicked(0) || navigating) return std::nullopt;
    const bool turns = settings.kind != "comb" && settings.kind != "grab" && settings.kind != "smooth";
    inverted_ = io.KeyCtrl && (turns || over != nullptr), smooths_ = io.KeyShift && over == nullptr;
    path_ = {placeOf(view)};
    lastPx_ = view.mouse();
    radius_ = settings.radiusPx * view.unitsPerPixel(path_.front());
  } else if ((view.mouse() - lastPx_).norm() >= kPathStepPx) {
    const bool onSurface = over != nullptr || smooths_ || followsSurface(settings.kind);
    const double depth = (path_.front() - view.camera.eye).dot(view.forward());
    path_.push_back(onSurface ? placeOf(view) : Vec3(view.camera.eye + depth * view.ray(view.mouse())));
    lastPx_ = view.mouse();
  }
  tookKeys_ = true;
  if (keys.pressed("Escape")) {
    path_.clear();
    return std::nullopt;
  }
  BrushWork work{stroke(view, settings), !io.MouseDown[0]};
  if (work.ended) path_.clear();
  return work;
}

void BrushTool::draw(const Viewport& view, const BrushSettings& settings) const {
  if (!view.hovered() && resizing_ == Resizing::No) return;
  const ImVec2 at = view.toWindow(resizing_ == Resizing::No ? view.mouse() : resizeFrom_);
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const float radius = float(settings.radiusPx);
  list.AddCircle(at, radius + 1, IM_COL32(0, 0, 0, 120), 64, 1.5f);
  list.AddCircle(at, radius, stroking() ? IM_COL32(255, 200, 90, 255) : IM_COL32(255, 255, 255, 220), 64,
                 1.5f);
  list.AddCircle(at, radius * float(settings.strength), IM_COL32(255, 255, 255, 90), 48, 1.0f);
  list.AddCircleFilled(at, 2, IM_COL32(255, 255, 255, 200));
}

std::string BrushTool::status(const BrushSettings& settings) const {
  return settings.kind +
         " brush   (drag: brush, F or [ ]: size, Shift+F: strength, Ctrl: the other way, Shift: smooth, Esc: "
         "drop)";
}

}  // namespace coif::studio
