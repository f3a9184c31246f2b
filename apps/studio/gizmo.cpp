#include "gizmo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coif/scene/picking.h"

namespace coif::studio {
namespace {

constexpr float kArmPx = 84, kHitPx = 8;
constexpr ImU32 kAxisColors[] = {IM_COL32(235, 78, 84, 255), IM_COL32(120, 200, 70, 255),
                                 IM_COL32(74, 140, 245, 255)};
constexpr ImU32 kFreeColor = IM_COL32(240, 240, 240, 230), kHotColor = IM_COL32(255, 225, 90, 255);

ImU32 withAlpha(ImU32 color, int alpha) {
  return (color & ~IM_COL32_A_MASK) | (ImU32(alpha) << IM_COL32_A_SHIFT);
}

float distanceTo(const std::vector<ImVec2>& line, const ImVec2& at) {
  float best = 1e9f;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const ImVec2 a = line[i], d{line[i + 1].x - a.x, line[i + 1].y - a.y};
    const float length = d.x * d.x + d.y * d.y;
    const float t =
        length > 0 ? std::clamp(((at.x - a.x) * d.x + (at.y - a.y) * d.y) / length, 0.0f, 1.0f) : 0;
    best = std::min(best, std::hypot(at.x - a.x - t * d.x, at.y - a.y - t * d.y));
  }
  return best;
}

bool inside(const std::vector<ImVec2>& outline, const ImVec2& at) {
  std::vector<Vec2> polygon;
  for (const ImVec2& p : outline) polygon.emplace_back(p.x, p.y);
  return insidePolygon(Vec2(at.x, at.y), polygon);
}

}  // namespace

Gizmo::Gizmo(HandTool hand, const Vec3& pivot, const Mat3& axes, const Viewport& view)
    : hand_(hand), pivot_(pivot), axes_(axes), view_(view), scale_(view.scale) {
  hand == HandTool::Rotate ? addRings() : addArms(hand == HandTool::Scale);
}

void Gizmo::addArms(bool boxes) {
  const double arm = view_.unitsPerPixel(pivot_) * double(kArmPx * scale_);
  const auto at = [&](const Vec3& p) { return view_.toWindow(view_.project(p).px); };
  for (int i = 0; i < 3; ++i) {  // planes lie under the arrows
    const Vec3 a = arm * axes_.col((i + 1) % 3), b = arm * axes_.col((i + 2) % 3);
    if (std::abs(view_.forward().dot(axes_.col(i))) < 0.15) continue;  // seen from the edge
    std::vector<ImVec2> square;
    for (const auto& [s, t] :
         {std::pair(0.28, 0.28), std::pair(0.5, 0.28), std::pair(0.5, 0.5), std::pair(0.28, 0.5)})
      square.push_back(at(pivot_ + s * a + t * b));
    handles_.push_back({{Constraint::Kind::Plane, i}, std::move(square), true, false, false, kAxisColors[i]});
  }
  for (int i = 0; i < 3; ++i) {
    if (std::abs(view_.forward().dot(axes_.col(i))) > 0.985) continue;  // points at the eye
    handles_.push_back({{Constraint::Kind::Axis, i},
                        {at(pivot_ + 0.16 * arm * axes_.col(i)), at(pivot_ + arm * axes_.col(i))},
                        false,
                        !boxes,
                        boxes,
                        kAxisColors[i]});
  }
  const ImVec2 middle = at(pivot_);
  std::vector<ImVec2> circle;
  for (int k = 0; k < 16; ++k) {
    const float angle = float(k) * float(std::numbers::pi) / 8;
    circle.push_back({middle.x + 9 * scale_ * std::cos(angle), middle.y + 9 * scale_ * std::sin(angle)});
  }
  handles_.push_back({{}, std::move(circle), true, false, false, kFreeColor});
}

void Gizmo::addRings() {
  const double radius = view_.unitsPerPixel(pivot_) * double(kArmPx * scale_);
  constexpr int kSteps = 64;
  const auto circle = [&](const Vec3& u, const Vec3& v, double r, bool frontOnly) {
    std::vector<ImVec2> line;
    // From the far side on, so that the front half is one piece.
    const double start = frontOnly ? std::atan2(v.dot(view_.forward()), u.dot(view_.forward())) : 0;
    for (int k = 0; k <= kSteps; ++k) {
      const double angle = start + 2 * std::numbers::pi * k / kSteps;
      const Vec3 d = std::cos(angle) * u + std::sin(angle) * v;
      if (frontOnly && d.dot(view_.forward()) > 0.02) continue;
      line.push_back(view_.toWindow(view_.project(pivot_ + r * d).px));
    }
    return line;
  };
  handles_.push_back(
      {{}, circle(view_.right(), view_.up(), 1.15 * radius, false), false, false, false, kFreeColor});
  for (int i = 0; i < 3; ++i) {
    handles_.push_back({{Constraint::Kind::Axis, i},
                        circle(axes_.col((i + 1) % 3), axes_.col((i + 2) % 3), radius, true),
                        false,
                        false,
                        false,
                        kAxisColors[i]});
  }
}

std::optional<Constraint> Gizmo::at(const Vec2& px) const {
  const ImVec2 at = view_.toWindow(px);
  std::optional<Constraint> best;
  float nearest = kHitPx * scale_;
  for (const Handle& handle : handles_) {
    const float distance =
        handle.filled ? (inside(handle.line, at) ? 0.0f : 1e9f) : distanceTo(handle.line, at);
    if (distance <= nearest) nearest = distance, best = handle.constraint;
  }
  return best;
}

void Gizmo::draw(const std::optional<Constraint>& hot) const {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (const Handle& handle : handles_) {
    const bool isHot = hot && *hot == handle.constraint;
    const ImU32 color = isHot ? kHotColor : handle.color;
    if (handle.filled) {
      list.AddConvexPolyFilled(handle.line.data(), int(handle.line.size()),
                               withAlpha(color, isHot ? 190 : 90));
      list.AddPolyline(handle.line.data(), int(handle.line.size()), color, ImDrawFlags_Closed, 1.5f * scale_);
      continue;
    }
    list.AddPolyline(handle.line.data(), int(handle.line.size()), color, 0, (isHot ? 4.0f : 2.6f) * scale_);
    const ImVec2 end = handle.line.back(), start = handle.line.front();
    const float length = std::hypot(end.x - start.x, end.y - start.y);
    if (length < 1) continue;
    const ImVec2 d{(end.x - start.x) / length, (end.y - start.y) / length};
    const float s = 6 * scale_;
    if (handle.arrow) {
      list.AddTriangleFilled({end.x + 2.2f * s * d.x, end.y + 2.2f * s * d.y},
                             {end.x - s * d.y, end.y + s * d.x}, {end.x + s * d.y, end.y - s * d.x}, color);
    } else if (handle.box) {
      list.AddRectFilled({end.x - s, end.y - s}, {end.x + s, end.y + s}, color, 1.5f);
    }
  }
}

}  // namespace coif::studio
