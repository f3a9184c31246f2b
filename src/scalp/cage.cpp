#include "coif/scalp/cage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "cage_grid.h"
#include "connectivity.h"
#include "patch.h"

namespace coif {
namespace {

constexpr int kGreatestCount = 100000;

/// What a region without automaticCap has for a frame: read off its shell, or from its own mean normal.
HeadFrame frameOf(const Surface& surface, const Region& region, std::vector<std::string>& notes) {
  if (region.frame) return *region.frame;
  const PolygonMesh& mesh = surface.mesh();
  std::vector<std::uint32_t> corners = mesh.corners;
  const auto lowest = coincidentRepresentatives(mesh.positions, 0);
  for (std::uint32_t& v : corners) v = lowest[v];
  const auto shellOf = faceShells(mesh.faceOffsets, corners, mesh.vertexCount());
  const auto inside = region.list();
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.faceCount(); ++f)
    if (shellOf[f] == shellOf[inside[0]]) faces.push_back(f);
  auto frame = estimateHeadFrame(surface, faces);
  if (frame.ok()) {
    notes.insert(notes.end(), frame->notes.begin(), frame->notes.end());
    return std::move(frame).value();
  }
  notes.push_back("No head's frame was found: up and front are the mesh's own.");
  HeadFrame plain;
  if (mesh.upAxis == UpAxis::Z) {
    plain.up = Vec3::UnitZ();
    plain.forward = -Vec3::UnitY();
    plain.right = plain.forward.cross(plain.up);
  }
  const Box box = bounds(mesh.positions);
  plain.centre = 0.5 * box.lo + 0.5 * box.hi;
  plain.mirror.normal = plain.right;
  plain.mirror.point = plain.centre;
  return plain;
}

Vec3 meanNormal(const Patch& patch) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [a, b, c] : patch.triangles)
    sum += (patch.positions[b] - patch.positions[a]).cross(patch.positions[c] - patch.positions[a]);
  return sum;
}

struct Ends {
  std::uint32_t front = 0, back = 0;  // positions in the boundary loop
};

/// The front of a patch: towards the head's front as seen on the patch, or its underside where it faces the
/// front.
Vec3 frontDirection(const Patch& patch, const HeadFrame& frame) {
  Vec3 normal = meanNormal(patch);
  normal = normal.norm() > 0 ? Vec3(normal.normalized()) : frame.up;
  Vec3 front = frame.forward - frame.forward.dot(normal) * normal;
  if (front.norm() < 0.3) front = -(frame.up - frame.up.dot(normal) * normal);
  return front.normalized();
}

Ends findEnds(Patch& patch, const HeadFrame& frame) {
  const Vec3 front = frontDirection(patch, frame);
  const auto place = [&](std::uint32_t v) {
    return std::uint32_t(std::find(patch.boundary.begin(), patch.boundary.end(), v) - patch.boundary.begin());
  };
  if (!patch.middle.empty()) {
    const Vec3 along = patch.positions[patch.middle.front()] - patch.positions[patch.middle.back()];
    if (along.dot(front) < 0) std::reverse(patch.middle.begin(), patch.middle.end());
    return {place(patch.middle.front()), place(patch.middle.back())};
  }
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t v : patch.boundary) middle += patch.positions[v] / double(patch.boundary.size());
  Vec3 normal = meanNormal(patch);
  if (normal.norm() > 0) normal.normalize();
  Ends ends;
  double most = -2, least = 2;
  for (std::uint32_t i = 0; i < patch.boundary.size(); ++i) {
    Vec3 d = patch.positions[patch.boundary[i]] - middle;
    d -= d.dot(normal) * normal;
    const double c = d.norm() > 0 ? d.normalized().dot(front) : 0;
    if (c > most) most = c, ends.front = i;
    if (c < least) least = c, ends.back = i;
  }
  if (ends.front == ends.back)
    ends.back =
        (ends.front + std::uint32_t(patch.boundary.size()) / 2) % std::uint32_t(patch.boundary.size());
  return ends;
}

SurfacePoint onSurface(const Surface& surface, const Patch& patch, const PatchPoint& point,
                       const Vec3& position) {
  const std::uint32_t parent = patch.parents[point.triangle];
  if (parent == kNone) {  // on a lid
    SurfacePoint s = surface.nearest(position);
    s.distance = 0;
    return s;
  }
  Vec3 barycentric = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    barycentric += point.barycentric[k] * patch.barycentrics[point.triangle][std::size_t(k)];
  barycentric = barycentric.cwiseMax(0.0);
  return surface.at(parent, barycentric / barycentric.sum());
}

void measure(const Surface& surface, Cage& cage) {
  CageQuality& q = cage.quality;
  const double unit = cage.frame.height > 0 ? cage.frame.height : surface.size();
  double total = 0, least = std::numeric_limits<double>::infinity(), most = 0;
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < cage.faceCount(); ++f) {
    points.clear();
    Vec3 outward = Vec3::Zero(), middle = Vec3::Zero();
    for (std::uint32_t c = cage.faceOffsets[f]; c < cage.faceOffsets[f + 1]; ++c) {
      points.push_back(cage.positions[cage.corners[c]]);
      outward += cage.points[cage.corners[c]].normal;
    }
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double side = (points[(k + 1) % points.size()] - points[k]).norm();
      shortest = std::min(shortest, side);
      longest = std::max(longest, side);
      middle += points[k] / double(points.size());
    }
    const Vec3 normal = newellNormal(points);
    q.flips += !(normal.dot(outward) > 0);
    q.maxAspect = std::max(q.maxAspect, shortest > 0 ? longest / shortest : 1e300);
    q.maxDistance = std::max(q.maxDistance, surface.nearest(middle).distance / unit);
    const double area = 0.5 * normal.norm();
    total += area;
    least = std::min(least, area);
    most = std::max(most, area);
  }
  const double mean = total / double(cage.faceCount());
  if (mean > 0) q.minAreaRatio = least / mean, q.maxAreaRatio = most / mean;
  if (cage.mirror)
    for (std::size_t v = 0; v < cage.partner.size(); ++v)
      q.mirrorError =
          std::max(q.mirrorError,
                   (cage.mirror->reflect(cage.positions[v]) - cage.positions[cage.partner[v]]).norm() / unit);
}

Result<Cage> gridCage(const Surface& surface, const Region& region, const CageOptions& options,
                      const Context& context, Cage cage) {
  const auto stopped = [&] { return makeError(ErrorCode::Cancelled, "The cage was cancelled."); };
  PatchOptions cut;
  cut.mirror = cage.mirror;
  context.report("cutting the scalp out of the head", 0);
  COIF_ASSIGN(Patch patch, cutPatch(surface, region, cut));
  if (context.cancelled()) return stopped();
  if (cage.mirror && patch.middle.empty()) {
    cage.notes.push_back("The mirror plane does not part the region in two halves: no symmetry was kept.");
    cage.mirror.reset();
    COIF_ASSIGN(patch, cutPatch(surface, region, {}));
  }
  const Ends ends = findEnds(patch, cage.frame);
  context.report("laying the scalp flat", 0.3);
  const DiscMap map = mapToDisc(patch, ends.front, ends.back);
  if (context.cancelled()) return stopped();
  context.report("search trees of the scalp", 0.7);
  const PatchLocator locator(patch, map, context);
  if (context.cancelled()) return stopped();
  const GridSize size = chooseGrid(locator, options.count);
  const auto places = layGrid(locator, size, ends.front, ends.back, cage.mirror, options.smoothing, context);
  if (context.cancelled()) return stopped();

  cage.columns = size.columns;
  cage.rows = size.rows;
  cage.quality.mapFlips = map.flips;
  cage.notes.insert(cage.notes.end(), patch.notes.begin(), patch.notes.end());
  for (std::uint32_t j = 0; j <= size.rows; ++j)
    for (std::uint32_t i = 0; i <= size.columns; ++i) {
      const PatchPoint& place = places[cage.vertexAt(i, j)];
      cage.points.push_back(onSurface(surface, patch, place, locator.position(place)));
      cage.positions.push_back(cage.points.back().position);
      // In this form left and right differ in sign alone.
      cage.uv.emplace_back((2.0 * i - size.columns) / size.columns, (2.0 * j - size.rows) / size.rows);
      cage.grid.push_back({i, j});
      cage.boundary.push_back(i == 0 || j == 0 || i == size.columns || j == size.rows);
      if (!cage.mirror) continue;
      cage.partner.push_back(cage.vertexAt(size.columns - i, j));
      cage.onPlane.push_back(2 * i == size.columns);
    }
  for (std::uint32_t j = 0; j < size.rows; ++j)
    for (std::uint32_t i = 0; i < size.columns; ++i) {
      const auto quad = gridQuad(size, i, j);
      cage.corners.insert(cage.corners.end(), quad.begin(), quad.end());
      cage.faceOffsets.push_back(std::uint32_t(cage.corners.size()));
    }
  return cage;
}

/// The region's own polygons, vertices at equal positions joined.
Result<Cage> exactCage(const Surface& surface, const Region& region, Cage cage) {
  const PolygonMesh& mesh = surface.mesh();
  const auto lowest = coincidentRepresentatives(mesh.positions, 0);
  std::vector<std::uint32_t> number(mesh.vertexCount(), kNone), source;
  bool seams = false;
  for (std::uint32_t f : region.list()) {
    for (std::uint32_t v : mesh.face(f)) {
      std::uint32_t& n = number[lowest[v]];
      seams |= lowest[v] != v;
      if (n == kNone) {
        n = std::uint32_t(source.size());
        source.push_back(lowest[v]);
      }
      cage.corners.push_back(n);
    }
    cage.faceOffsets.push_back(std::uint32_t(cage.corners.size()));
  }
  if (seams) cage.notes.push_back("Vertices at equal positions were treated as joined.");
  cage.points.resize(source.size());
  for (std::uint32_t t = 0; t < surface.triangleCount(); ++t) {
    if (!region.faces[surface.triangleFace(t)]) continue;
    const auto v = surface.triangleVertices(t);
    for (int k = 0; k < 3; ++k) {
      SurfacePoint& point = cage.points[number[lowest[v[std::size_t(k)]]]];
      if (point.face == kNone) point = surface.at(t, Vec3::Unit(k));
    }
  }
  const EdgeTable edges = buildEdges(cage.faceOffsets, cage.corners);
  cage.boundary.assign(source.size(), 0);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges.edge(e).size() == 1) cage.boundary[edges.edge(e)[0].a] = cage.boundary[edges.edge(e)[0].b] = 1;
  for (const SurfacePoint& p : cage.points) cage.positions.push_back(p.position);
  cage.mirror.reset();

  PatchOptions whole;
  whole.wholeFaces = true;
  auto patch = cutPatch(surface, region, whole);
  if (!patch.ok()) {
    cage.notes.push_back("No map to the disc: " + patch.error().message);
    return cage;
  }
  const Ends ends = findEnds(*patch, cage.frame);
  const DiscMap map = mapToDisc(*patch, ends.front, ends.back);
  cage.quality.mapFlips = map.flips;
  const PatchLocator locator(*patch, map);
  for (const Vec3& p : cage.positions) {
    const PatchPoint place = locator.nearest(p);
    Vec2 uv = Vec2::Zero();
    for (int k = 0; k < 3; ++k)
      uv += place.barycentric[k] * map.uv[patch->triangles[place.triangle][std::size_t(k)]];
    cage.uv.push_back(uv);
  }
  return cage;
}

}  // namespace

Result<Cage> buildCage(const PolygonMesh& mesh, const Surface& surface, const Region& region,
                       const CageOptions& options, const Context& context) {
  COIF_TRY(validate(mesh));
  if (surface.mesh().faceCount() != mesh.faceCount() || region.faces.size() != mesh.faceCount() ||
      (!region.field.empty() && region.field.size() != mesh.vertexCount()))
    return makeError(ErrorCode::InvalidArgument, "Mesh, surface and region do not belong together.");
  if (region.count() == 0) return makeError(ErrorCode::Degenerate, "The region holds no face.");
  for (std::size_t v = 0; v < region.field.size(); ++v)
    if (!std::isfinite(region.field[v]))
      return makeError(ErrorCode::InvalidArgument, "The region's field is not finite.",
                       "vertex " + std::to_string(v));
  if (!options.exact && (options.count < 2 || options.count > kGreatestCount))
    return makeError(ErrorCode::InvalidArgument,
                     "A cage has 2 to 100000 quads, not " + std::to_string(options.count) + ".");
  if (!(surface.size() > 0) || !std::isfinite(surface.size()))
    return makeError(ErrorCode::Degenerate, "The mesh has no size.");

  Cage cage;
  cage.notes = region.notes;
  cage.frame = frameOf(surface, region, cage.notes);
  if (options.useMirror) {
    cage.mirror = options.mirror ? *options.mirror : cage.frame.mirror;
    if (options.mirror) cage.mirror->accepted = true;
    if (!cage.mirror->accepted) cage.mirror.reset();
  }
  COIF_ASSIGN(Cage built, options.exact ? exactCage(surface, region, std::move(cage))
                                        : gridCage(surface, region, options, context, std::move(cage)));
  // Region and cut may have seen the same seams.
  std::vector<std::string> notes;
  for (std::string& n : built.notes)
    if (std::find(notes.begin(), notes.end(), n) == notes.end()) notes.push_back(std::move(n));
  built.notes = std::move(notes);
  measure(surface, built);
  return built;
}

}  // namespace coif
