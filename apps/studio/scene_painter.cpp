#include "scene_painter.h"

#include <algorithm>
#include <cmath>

namespace coif::studio {
namespace {

constexpr std::size_t kMostHeadFaces = 60000;
constexpr int kMostLines = 80;  // of the grid, each way

ImDrawList& list() {
  return *ImGui::GetBackgroundDrawList();
}

/// A line of which a part may be behind the eye.
void line3(const Viewport& view, Vec3 a, Vec3 b, ImU32 color, float width) {
  const double near = 1e-3 * (view.camera.target - view.camera.eye).norm();
  const auto depth = [&](const Vec3& p) { return (p - view.camera.eye).dot(view.forward()); };
  double da = depth(a), db = depth(b);
  if (da < near && db < near) return;
  if (da < near) a += (near - da) / (db - da) * (b - a);
  if (db < near) b += (near - db) / (da - db) * (a - b);
  list().AddLine(view.toWindow(view.project(a).px), view.toWindow(view.project(b).px), color, width);
}

}  // namespace

void paintBackdrop(const Viewport& view, bool lightTheme) {
  const ImVec2 from = view.origin(), to{from.x + view.size().x, from.y + view.size().y};
  const ImU32 top = lightTheme ? IM_COL32(196, 200, 206, 255) : IM_COL32(88, 91, 97, 255),
              bottom = lightTheme ? IM_COL32(140, 144, 150, 255) : IM_COL32(46, 47, 50, 255);
  list().AddRectFilledMultiColor(from, to, top, top, bottom, bottom);
  if (!view.settings.beside) return;
  const ImVec2 beside = view.besideOrigin();
  list().AddRectFilledMultiColor(beside, {beside.x + view.size().x, to.y}, top, top, bottom, bottom);
}

void paintGrid(const Viewport& view, const Box& model, double step) {
  const int up = view.upAxis == UpAxis::Y ? 1 : 2, u = 0, v = view.upAxis == UpAxis::Y ? 2 : 1;
  const Vec3 size = model.hi - model.lo, middle = 0.5 * (model.lo + model.hi);
  const double ground = model.lo[up], reach = 1.5 * std::max(size[u], size[v]);
  while (2 * reach / step > kMostLines) step *= 2;
  const auto snap = [&](double x) { return step * std::round(x / step); };
  const auto point = [&](double a, double b) {
    Vec3 p;
    p[u] = a, p[v] = b, p[up] = ground;
    return p;
  };
  const double u0 = snap(middle[u] - reach), u1 = snap(middle[u] + reach), v0 = snap(middle[v] - reach),
               v1 = snap(middle[v] + reach);
  const auto color = [&](double x, ImU32 axis) {
    if (std::abs(x) < 0.5 * step) return axis;
    return std::lround(x / step) % 5 == 0 ? IM_COL32(255, 255, 255, 46) : IM_COL32(255, 255, 255, 20);
  };
  for (double x = u0; x <= u1 + 0.5 * step; x += step)
    line3(view, point(x, v0), point(x, v1), color(x, IM_COL32(90, 140, 240, 120)), 1);
  for (double x = v0; x <= v1 + 0.5 * step; x += step)
    line3(view, point(u0, x), point(u1, x), color(x, IM_COL32(235, 90, 95, 120)), 1);
}

bool canPaintHead(const Surface& head) {
  return head.mesh().faceCount() <= kMostHeadFaces;
}

void paintHead(const Viewport& view, const Surface& head, HeadStyle style) {
  const PolygonMesh& mesh = head.mesh();
  std::vector<ScreenPoint> points;
  points.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) points.push_back(view.project(p));
  std::vector<ImVec2> outline;
  const ImDrawListFlags flags = list().Flags;
  list().Flags &= ~ImDrawListFlags_AntiAliasedFill;  // soft rims would add up to lines where faces meet
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    const auto corners = mesh.face(f);
    outline.clear();
    double twiceArea = 0;
    bool front = true;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const ScreenPoint &a = points[corners[i]], &b = points[corners[(i + 1) % corners.size()]];
      twiceArea += a.px.x() * b.px.y() - a.px.y() * b.px.x();
      front = front && a.depth > 0;
      outline.push_back(view.toWindow(a.px));
    }
    if (!front || twiceArea >= 0) continue;  // counter-clockwise, y down: it looks away
    if (style == HeadStyle::Wire) {
      list().AddPolyline(outline.data(), int(outline.size()), IM_COL32(215, 190, 165, 90), ImDrawFlags_Closed,
                         1);
      continue;
    }
    const Vec3 normal = (mesh.positions[corners[1]] - mesh.positions[corners[0]])
                            .cross(mesh.positions[corners[2]] - mesh.positions[corners[0]]);
    const double facing = normal.norm() > 0 ? -normal.normalized().dot(view.forward()) : 1;
    // Glass: clear where it is looked at straight, darker towards its outline.
    const int alpha = int(30 + 90 * (1 - std::clamp(facing, 0.0, 1.0)));
    list().AddConvexPolyFilled(outline.data(), int(outline.size()), IM_COL32(214, 178, 150, alpha));
  }
  list().Flags = flags;
}

namespace {

struct AxisBall {
  double depth;
  ImVec2 at;
  float radius;
  int axis;
  bool positive;
};

struct AxisCross {
  ImVec2 middle;
  std::vector<AxisBall> balls;  // far ones first
};

AxisCross axisCross(const Viewport& view, float scale) {
  const float arm = 30 * scale;
  AxisCross out{{view.origin().x + view.size().x - 46 * scale, view.origin().y + 48 * scale}, {}};
  if (view.size().x < 200 * scale || view.size().y < 160 * scale) return out;  // the view comes first
  for (int i = 0; i < 6; ++i) {
    const bool positive = i % 2 == 0;
    const Vec3 d = (positive ? 1.0 : -1.0) * Vec3::Unit(i / 2);
    const ImVec2 at{out.middle.x + arm * float(d.dot(view.right())),
                    out.middle.y - arm * float(d.dot(view.up()))};
    out.balls.push_back({d.dot(view.forward()), at, (positive ? 8.5f : 6.0f) * scale, i / 2, positive});
  }
  std::ranges::sort(out.balls, std::greater(), &AxisBall::depth);
  return out;
}

const AxisBall* ballAt(const Viewport& view, const AxisCross& cross) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const AxisBall* hot = nullptr;
  for (const AxisBall& ball : cross.balls) {
    if (view.hovered() && std::hypot(mouse.x - ball.at.x, mouse.y - ball.at.y) <= ball.radius) hot = &ball;
  }
  return hot;
}

}  // namespace

const char* axisAt(const Viewport& view, float scale) {
  const AxisCross cross = axisCross(view, scale);
  const AxisBall* ball = ballAt(view, cross);
  if (ball == nullptr) return nullptr;
  // Looking along -x shows the model's right, as the View menu names it; y and z change places with the up
  // axis.
  const bool yUp = view.upAxis == UpAxis::Y;
  const char* names[3][2] = {{"view_right", "view_left"},
                             {yUp ? "view_top" : "view_back", yUp ? "view_bottom" : "view_front"},
                             {yUp ? "view_front" : "view_top", yUp ? "view_back" : "view_bottom"}};
  return names[ball->axis][ball->positive ? 0 : 1];
}

void paintAxes(const Viewport& view, float scale) {
  const AxisCross cross = axisCross(view, scale);
  const AxisBall* hot = ballAt(view, cross);
  constexpr ImU32 kColors[] = {IM_COL32(235, 78, 84, 255), IM_COL32(120, 200, 70, 255),
                               IM_COL32(74, 140, 245, 255)};
  for (const AxisBall& ball : cross.balls) {
    const ImU32 color = kColors[ball.axis], faint = (color & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 80);
    if (ball.positive) list().AddLine(cross.middle, ball.at, color, 2 * scale);
    list().AddCircleFilled(ball.at, ball.radius,
                           &ball == hot    ? IM_COL32_WHITE
                           : ball.positive ? color
                                           : faint);
    if (!ball.positive) {
      list().AddCircle(ball.at, ball.radius, color, 0, 1.2f * scale);
      continue;
    }
    const char letter[2] = {"XYZ"[ball.axis], 0};
    const ImVec2 size = ImGui::CalcTextSize(letter);
    list().AddText({ball.at.x - 0.5f * size.x, ball.at.y - 0.5f * size.y}, IM_COL32(20, 20, 20, 255), letter);
  }
}

}  // namespace coif::studio
