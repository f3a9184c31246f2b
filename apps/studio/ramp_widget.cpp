#include "ramp_widget.h"

#include <algorithm>
#include <cmath>

namespace coif::studio {
namespace {

constexpr double kLeastStep = 0.01;  // from point to point
constexpr int kNone = -1;

class RampBox {
 public:
  RampBox(const ImVec2& at, const ImVec2& size, float scale) : at_(at), size_(size), pad_(7 * scale) {}
  ImVec2 toScreen(double x, double y) const {
    return {at_.x + pad_ + float(x) * (size_.x - 2 * pad_),
            at_.y + size_.y - pad_ - float(y) * (size_.y - 2 * pad_)};
  }
  RampPoint fromScreen(const ImVec2& p) const {
    const double x = double(p.x - at_.x - pad_) / double(size_.x - 2 * pad_),
                 y = double(at_.y + size_.y - pad_ - p.y) / double(size_.y - 2 * pad_);
    // Two digits: what a hand can mean.
    const auto rounded = [](double v) { return std::round(100 * std::clamp(v, 0.0, 1.0)) / 100; };
    return {rounded(x), rounded(y)};
  }
  int pointAt(const Ramp& ramp, const ImVec2& mouse, float reach) const {
    int best = kNone;
    for (int i = 0; i < int(ramp.points.size()); ++i) {
      const ImVec2 p = toScreen(ramp.points[std::size_t(i)].x, ramp.points[std::size_t(i)].y);
      const float distance = std::hypot(p.x - mouse.x, p.y - mouse.y);
      if (distance <= reach) reach = distance, best = i;
    }
    return best;
  }

 private:
  ImVec2 at_, size_;
  float pad_;
};

/// Adds a point where there is room for it between its neighbours; its number, or kNone.
int addPoint(Ramp& ramp, const RampPoint& point) {
  if (ramp.points.size() >= Ramp::kMostPoints) return kNone;
  const auto after = std::ranges::upper_bound(ramp.points, point.x, {}, &RampPoint::x);
  if (after != ramp.points.end() && after->x - point.x < kLeastStep) return kNone;
  if (after != ramp.points.begin() && point.x - (after - 1)->x < kLeastStep) return kNone;
  const auto number = after - ramp.points.begin();  // before the points move
  ramp.points.insert(after, point);
  return int(number);
}

void movePoint(Ramp& ramp, int number, RampPoint to) {
  const std::size_t i = std::size_t(number);
  const double least = i > 0 ? ramp.points[i - 1].x + kLeastStep : 0,
               most = i + 1 < ramp.points.size() ? ramp.points[i + 1].x - kLeastStep : 1;
  to.x = least <= most ? std::clamp(to.x, least, most) : ramp.points[i].x;
  ramp.points[i] = to;
}

void drawRamp(const Ramp& ramp, const RampBox& box, const ImVec2& at, const ImVec2& size, int hot,
              float scale) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg), 3 * scale);
  for (int i = 0; i <= 4; ++i) {
    const ImU32 color = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.25f);
    list.AddLine(box.toScreen(0.25 * i, 0), box.toScreen(0.25 * i, 1), color);
    list.AddLine(box.toScreen(0, 0.25 * i), box.toScreen(1, 0.25 * i), color);
  }
  const RampCurve curve(ramp);
  constexpr int kSteps = 96;
  std::vector<ImVec2> line, under{box.toScreen(0, 0)};
  for (int i = 0; i <= kSteps; ++i) {
    const double x = double(i) / kSteps;
    line.push_back(box.toScreen(x, curve(x)));
  }
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const ImVec2 quad[] = {
        line[i], line[i + 1], {line[i + 1].x, box.toScreen(0, 0).y}, {line[i].x, box.toScreen(0, 0).y}};
    list.AddConvexPolyFilled(quad, 4, ImGui::GetColorU32(ImGuiCol_SliderGrab, 0.18f));
  }
  list.AddPolyline(line.data(), int(line.size()), ImGui::GetColorU32(ImGuiCol_SliderGrab), 0, 1.8f * scale);
  for (int i = 0; i < int(ramp.points.size()); ++i) {
    const ImVec2 p = box.toScreen(ramp.points[std::size_t(i)].x, ramp.points[std::size_t(i)].y);
    list.AddCircleFilled(p, (i == hot ? 5.5f : 4.0f) * scale, ImGui::GetColorU32(ImGuiCol_Text));
    list.AddCircle(p, (i == hot ? 5.5f : 4.0f) * scale, ImGui::GetColorU32(ImGuiCol_Border));
  }
}

}  // namespace

bool editRamp(const char* id, Ramp& ramp, const ImVec2& size, float scale) {
  const ImVec2 at = ImGui::GetCursorScreenPos(), mouse = ImGui::GetIO().MousePos;
  const RampBox box(at, size, scale);
  ImGui::PushID(id);
  ImGui::InvisibleButton("box", size, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  int& held = *ImGui::GetStateStorage()->GetIntRef(ImGui::GetID("held"), kNone);
  const int hot = ImGui::IsItemHovered() ? box.pointAt(ramp, mouse, 9 * scale) : kNone;
  bool changed = false;
  if (ImGui::IsItemActivated()) {
    const bool takes = ImGui::IsMouseClicked(1) || ImGui::GetIO().KeyCtrl;
    held = kNone;
    if (takes && hot != kNone && ramp.points.size() > 1) {
      ramp.points.erase(ramp.points.begin() + hot);
      changed = true;
    } else if (!takes) {
      held = hot != kNone ? hot : addPoint(ramp, box.fromScreen(mouse));
      changed = hot == kNone && held != kNone;
    }
  }
  if (ImGui::IsItemActive() && held != kNone && held < int(ramp.points.size()) && !changed) {
    const RampPoint before = ramp.points[std::size_t(held)];
    if (ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0)
      movePoint(ramp, held, box.fromScreen(mouse));
    changed = ramp.points[std::size_t(held)] != before;
  }
  if (!ImGui::IsItemActive() && hot != kNone) {
    const RampPoint& p = ramp.points[std::size_t(hot)];
    ImGui::SetTooltip("%.0f %% of the way to the tip: %.2f", 100 * p.x, p.y);
  }
  drawRamp(ramp, box, at, size, ImGui::IsItemActive() ? held : hot, scale);
  ImGui::PopID();
  return changed;
}

}  // namespace coif::studio
