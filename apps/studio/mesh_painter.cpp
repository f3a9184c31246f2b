#include "mesh_painter.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace coif::studio {
namespace {

constexpr ImU32 kSelected = IM_COL32(255, 170, 40, 255), kSelectedFill = IM_COL32(255, 170, 40, 80),
                kHover = IM_COL32(255, 235, 150, 255), kVertex = IM_COL32(20, 20, 24, 255),
                kPinned = IM_COL32(90, 200, 255, 255), kFrozen = IM_COL32(120, 120, 140, 255),
                kInner = IM_COL32(150, 110, 200, 255), kAdded = IM_COL32(90, 235, 120, 255),
                kAddedFill = IM_COL32(90, 235, 120, 60), kTaken = IM_COL32(245, 70, 70, 255);

ImU32 hue(float h, float saturation, float value, float alpha) {
  float r, g, b;
  ImGui::ColorConvertHSVtoRGB(std::fmod(h, 1.0f), saturation, value, r, g, b);
  return ImGui::ColorConvertFloat4ToU32({r, g, b, alpha});
}

}  // namespace

MeshPainter::MeshPainter(const Viewport& view, const HairMesh& mesh, const EditState& state)
    : view_(view), mesh_(mesh), state_(state), list_(*ImGui::GetBackgroundDrawList()) {}

/// Layers from the root's green to the tips' violet; bundles and groups far apart from their neighbours'
/// numbers.
ImU32 MeshPainter::colorOf(const FaceRef& face, float alpha, float light) const {
  constexpr float kGolden = 0.618034f;
  const Bundle& bundle = mesh_.bundles()[mesh_.indexOf(face.bundle)];
  const float h = view_.settings.color == MeshColor::Layer    ? 0.36f + 0.11f * float(face.layer)
                  : view_.settings.color == MeshColor::Bundle ? kGolden * float(std::uint32_t(face.bundle))
                                                              : 0.08f + kGolden * float(bundle.group);
  return hue(h, 0.45f, 0.95f * light, alpha);
}

void MeshPainter::line(std::uint32_t a, std::uint32_t b, ImU32 color, float width) {
  if (view_.screen()->pickable(a) && view_.screen()->pickable(b))
    list_.AddLine(at(a), at(b), color, width * view_.scale);
}

void MeshPainter::paint() {
  if (view_.settings.mesh == MeshStyle::Hidden || view_.screen() == nullptr) return;
  if (view_.settings.mesh == MeshStyle::Shaded) paintShaded();
  paintSelectedFaces();
  paintEdges();
  if (view_.settings.kind == SelectKind::Vertex || !state_.selection.vertices.empty()) paintVertices();
}

/// The painter's algorithm over the hair's outside: some hundreds of faces need no depth buffer.
void MeshPainter::paintShaded() {
  struct Item {
    double depth;
    const HullFace* face;
  };
  std::vector<Item> items;
  const auto& points = view_.screen()->vertices();
  const auto cornersOf = [&](const HullFace& f) {
    return f.side ? std::span<const std::uint32_t>(f.corners)
                  : mesh_.bundles()[mesh_.indexOf(f.face.bundle)].face(f.face.layer);
  };
  for (const HullFace& face : view_.screen()->parts().hull) {
    double depth = 0;
    bool seen = false, front = true;
    for (std::uint32_t v : cornersOf(face)) {
      depth += points[v].depth / double(cornersOf(face).size());
      seen = seen || view_.screen()->pickable(v), front = front && points[v].depth > 0;
    }
    if (seen && front) items.push_back({depth, &face});
  }
  std::ranges::sort(items, std::greater(), &Item::depth);
  std::vector<ImVec2> outline;
  for (const Item& item : items) {
    const auto corners = cornersOf(*item.face);
    Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
    for (std::uint32_t v : corners) middle += mesh_.position(v) / double(corners.size());
    outline.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t v = corners[i], next = corners[(i + 1) % corners.size()];
      normal += (mesh_.position(v) - middle).cross(mesh_.position(next) - middle);
      outline.push_back(at(v));
    }
    const double facing = normal.norm() > 0 ? -normal.normalized().dot(view_.forward()) : 0;
    const float light = float(0.35 + 0.65 * std::abs(facing));
    list_.AddConvexPolyFilled(outline.data(), int(outline.size()), colorOf(item.face->face, 0.92f, light));
    list_.AddPolyline(outline.data(), int(outline.size()), IM_COL32(15, 15, 18, 130), ImDrawFlags_Closed,
                      view_.scale);
  }
}

void MeshPainter::paintEdges() {
  const PickParts& parts = view_.screen()->parts();
  const bool shaded = view_.settings.mesh == MeshStyle::Shaded;
  if (!shaded) {
    for (std::size_t i = 0; i < parts.edges.size(); ++i) {
      const EdgeRef& edge = parts.edges[i];
      line(parts.edgeEnds[i][0], parts.edgeEnds[i][1], colorOf({edge.bundle, edge.layer}, 0.6f), 1.0f);
    }
    for (const HullFace& face : parts.hull) {
      if (face.side) line(face.corners[1], face.corners[2], colorOf(face.face, 0.4f), 1.0f);
      if (face.side) line(face.corners[0], face.corners[3], colorOf(face.face, 0.4f), 1.0f);
    }
    for (std::uint32_t v = 0; view_.settings.showInternal && v < mesh_.vertices().size(); ++v) {
      if (mesh_.vertices()[v].parent != kNone)
        line(mesh_.vertices()[v].parent, v, IM_COL32(150, 110, 200, 60), 1.0f);
    }
  }
  for (const EdgeRef& edge : state_.selection.edges) {
    const auto ends = selectedVertices(mesh_, {{}, {edge}, {}});
    line(ends[0], ends[1], kSelected, 3.0f);
  }
}

void MeshPainter::paintVertices() {
  const auto external = externalVertices(mesh_);
  for (std::uint32_t v = 0; v < mesh_.vertices().size(); ++v) {
    if (!view_.screen()->pickable(v)) continue;
    const HairVertex& vertex = mesh_.vertices()[v];
    const bool selected = std::ranges::binary_search(state_.selection.vertices, vertex.id);
    const bool frozen = std::ranges::binary_search(state_.frozen, vertex.id);
    const ImU32 color = selected        ? kSelected
                        : frozen        ? kFrozen
                        : vertex.pinned ? kPinned
                        : !external[v]  ? kInner
                                        : kVertex;
    if (selected) list_.AddCircleFilled(at(v), 5 * view_.scale, IM_COL32(30, 20, 0, 255), 12);
    list_.AddCircleFilled(at(v), (selected ? 4.0f : 2.5f) * view_.scale, color, 12);
  }
}

void MeshPainter::paintSelectedFaces() {
  if (state_.selection.faces.empty()) return;
  const auto fill = [&](std::span<const std::uint32_t> corners, ImU32 color) {
    std::vector<ImVec2> outline;
    bool seen = true;
    for (std::uint32_t v : corners) {
      outline.push_back(at(v));
      seen = seen && view_.screen()->pickable(v);
    }
    if (!seen) return;
    list_.AddConvexPolyFilled(outline.data(), int(outline.size()), color);
    list_.AddPolyline(outline.data(), int(outline.size()), kSelected, ImDrawFlags_Closed, 1.5f * view_.scale);
  };
  for (const FaceRef& face : state_.selection.faces) {
    fill(mesh_.bundles()[mesh_.indexOf(face.bundle)].face(face.layer), kSelectedFill);
  }
  // The sides of what is selected over its whole thickness: bundles, layers, groups.
  const auto has = [&](FaceRef face) { return std::ranges::binary_search(state_.selection.faces, face); };
  for (const HullFace& face : view_.screen()->parts().hull) {
    if (!face.side || !has(face.face) || !has({face.face.bundle, face.face.layer - 1})) continue;
    fill(face.corners, IM_COL32(255, 170, 40, 50));
  }
}

void MeshPainter::paintMask(std::span<const double> values) {
  if (view_.screen() == nullptr || values.size() != mesh_.vertices().size()) return;
  const auto& points = view_.screen()->vertices();
  const auto colorAt = [](double value) {
    const auto mix = [&](int cold, int warm) { return int(std::lround(cold + value * (warm - cold))); };
    return IM_COL32(mix(40, 250), mix(90, 150), mix(200, 40), 190);
  };
  const ImVec2 white = ImGui::GetIO().Fonts->TexUvWhitePixel;
  for (const Bundle& bundle : mesh_.bundles()) {
    const auto face = bundle.face(0);
    double twiceArea = 0;
    bool seen = false;
    for (std::uint32_t i = 0; i < bundle.corners; ++i) {
      const ScreenPoint &a = points[face[i]], &b = points[face[(i + 1) % bundle.corners]];
      twiceArea += a.px.x() * b.px.y() - a.px.y() * b.px.x();
      seen = seen || view_.screen()->pickable(face[i]);
    }
    if (!seen || twiceArea >= 0) continue;  // y down: it looks away
    // A fan of triangles, so that colours run from corner to corner.
    list_.PrimReserve(int(3 * (bundle.corners - 2)), int(bundle.corners));
    const unsigned first = list_._VtxCurrentIdx;
    for (std::uint32_t v : face) list_.PrimWriteVtx(at(v), white, colorAt(values[v]));
    for (std::uint32_t i = 1; i + 1 < bundle.corners; ++i) {
      for (unsigned corner : {0u, i, i + 1}) list_.PrimWriteIdx(ImDrawIdx(first + corner));
    }
    for (std::uint32_t i = 0; i < bundle.corners; ++i)
      list_.AddLine(at(face[i]), at(face[(i + 1) % bundle.corners]), IM_COL32(20, 22, 26, 150), view_.scale);
  }
}

void MeshPainter::paintHover(const Selection& under) {
  for (VertexId id : under.vertices)
    list_.AddCircle(at(mesh_.indexOf(id)), 7 * view_.scale, kHover, 0, 2 * view_.scale);
  for (const EdgeRef& edge : under.edges) {
    const auto ends = selectedVertices(mesh_, {{}, {edge}, {}});
    list_.AddLine(at(ends[0]), at(ends[1]), kHover, 3 * view_.scale);
  }
  const auto has = [&](FaceRef face) { return std::ranges::binary_search(under.faces, face); };
  const auto outlineOf = [&](std::span<const std::uint32_t> corners) {
    std::vector<ImVec2> outline;
    for (std::uint32_t v : corners) outline.push_back(at(v));
    list_.AddPolyline(outline.data(), int(outline.size()), kHover, ImDrawFlags_Closed, 2 * view_.scale);
  };
  for (const FaceRef& face : under.faces) {
    const Bundle& bundle = mesh_.bundles()[mesh_.indexOf(face.bundle)];
    const bool only = view_.settings.kind == SelectKind::Face;
    if (only || face.layer == bundle.height()) outlineOf(bundle.face(face.layer));
  }
  for (const HullFace& face : view_.screen()->parts().hull) {
    if (face.side && has(face.face) && view_.settings.kind > SelectKind::Face) outlineOf(face.corners);
  }
}

void MeshPainter::paintChanges(const HairMesh& before) {
  const auto isNew = [&](std::uint32_t v) { return before.indexOf(mesh_.vertices()[v].id) == kNone; };
  for (const Bundle& bundle : mesh_.bundles()) {
    const std::uint32_t was = before.indexOf(bundle.id);
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer);
      const bool fresh = was == kNone || std::ranges::any_of(face, isNew);
      if (!fresh) continue;
      std::vector<ImVec2> outline;
      for (std::uint32_t v : face) outline.push_back(at(v));
      if (layer == bundle.height())
        list_.AddConvexPolyFilled(outline.data(), int(outline.size()), kAddedFill);
      list_.AddPolyline(outline.data(), int(outline.size()), kAdded, ImDrawFlags_Closed, 1.5f * view_.scale);
    }
  }
  for (std::uint32_t v = 0; v < mesh_.vertices().size(); ++v) {
    if (!isNew(v)) continue;
    if (mesh_.vertices()[v].parent != kNone)
      list_.AddLine(at(mesh_.vertices()[v].parent), at(v), kAdded, 1.5f * view_.scale);
    list_.AddCircleFilled(at(v), 3 * view_.scale, kAdded, 12);
  }
  for (const Bundle& bundle : before.bundles()) {
    const std::uint32_t now = mesh_.indexOf(bundle.id);
    const auto gone = [&](std::uint32_t v) { return mesh_.indexOf(before.vertices()[v].id) == kNone; };
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer);
      const bool lost = now == kNone || layer > mesh_.bundles()[now].height();
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const std::uint32_t a = face[i], b = face[(i + 1) % bundle.corners];
        if (!lost && !gone(a) && !gone(b)) continue;
        list_.AddLine(view_.toWindow(view_.project(before.position(a)).px),
                      view_.toWindow(view_.project(before.position(b)).px), kTaken, 2 * view_.scale);
      }
    }
  }
}

}  // namespace coif::studio
