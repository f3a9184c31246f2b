#include "coif/scalp/region.h"

#include <algorithm>
#include <cmath>

#include "coif/scalp/geodesic.h"
#include "coif/scalp/mesh_report.h"
#include "connectivity.h"

namespace coif {

std::size_t Region::count() const {
  return std::size_t(std::count(faces.begin(), faces.end(), 1));
}

std::vector<std::uint32_t> Region::list() const {
  std::vector<std::uint32_t> out;
  for (std::uint32_t f = 0; f < faces.size(); ++f)
    if (faces[f]) out.push_back(f);
  return out;
}

namespace {

Result<Region> nonEmpty(Region region) {
  if (region.count() == 0) return makeError(ErrorCode::Degenerate, "The region holds no face.");
  return region;
}

Result<Region> fromField(const PolygonMesh& mesh, std::vector<double> field) {
  Region region;
  region.faces.resize(mesh.faceCount());
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    double sum = 0;
    for (std::uint32_t v : mesh.face(f)) sum += field[v];
    region.faces[f] = sum > 0;
  }
  region.field = std::move(field);
  return nonEmpty(std::move(region));
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += (text.empty() ? "" : ", ") + n;
  return text.empty() ? "none" : text;
}

template <class Choose, class Blend>
Result<Region> combine(const Region& a, const Region& b, Choose choose, Blend blend) {
  if (a.faces.size() != b.faces.size())
    return makeError(ErrorCode::InvalidArgument, "The two regions belong to different meshes.");
  Region out;
  out.faces.resize(a.faces.size());
  for (std::size_t f = 0; f < a.faces.size(); ++f) out.faces[f] = choose(a.faces[f] != 0, b.faces[f] != 0);
  if (!a.field.empty() && a.field.size() == b.field.size()) {
    out.field.resize(a.field.size());
    for (std::size_t v = 0; v < a.field.size(); ++v) out.field[v] = blend(a.field[v], b.field[v]);
  }
  out.frame = a.frame ? a.frame : b.frame;
  out.notes = a.notes;
  out.notes.insert(out.notes.end(), b.notes.begin(), b.notes.end());
  return nonEmpty(std::move(out));
}

}  // namespace

Result<Region> regionOfAll(const PolygonMesh& mesh) {
  COIF_TRY(validate(mesh));
  Region region;
  region.faces.assign(mesh.faceCount(), 1);
  return nonEmpty(std::move(region));
}

Result<Region> regionOfGroups(const PolygonMesh& mesh, std::span<const std::string> names) {
  COIF_TRY(validate(mesh));
  Region region;
  region.faces.assign(mesh.faceCount(), 0);
  for (const std::string& name : names) {
    const auto it = std::find(mesh.groupNames.begin(), mesh.groupNames.end(), name);
    if (it == mesh.groupNames.end() || mesh.faceGroups.empty())
      return makeError(ErrorCode::NotFound,
                       "No group is called '" + name + "'; there are: " + listed(mesh.groupNames) + ".");
    const auto group = std::uint32_t(it - mesh.groupNames.begin());
    for (std::size_t f = 0; f < mesh.faceCount(); ++f)
      if (mesh.faceGroups[f] == group) region.faces[f] = 1;
  }
  return nonEmpty(std::move(region));
}

Result<Region> regionOfFaces(const PolygonMesh& mesh, std::span<const std::uint32_t> faces) {
  COIF_TRY(validate(mesh));
  Region region;
  region.faces.assign(mesh.faceCount(), 0);
  for (std::uint32_t f : faces) {
    if (f >= mesh.faceCount())
      return makeError(ErrorCode::InvalidArgument,
                       "The mesh has only " + std::to_string(mesh.faceCount()) + " faces.",
                       "face " + std::to_string(f));
    region.faces[f] = 1;
  }
  return nonEmpty(std::move(region));
}

Result<Region> regionOfHalfSpace(const PolygonMesh& mesh, const Vec3& point, const Vec3& normal) {
  COIF_TRY(validate(mesh));
  if (!point.allFinite() || !normal.allFinite() || !(normal.norm() > 0))
    return makeError(ErrorCode::InvalidArgument,
                     "A half-space needs a finite point and a normal of some length.");
  const Vec3 unit = normal.normalized();
  std::vector<double> field;
  for (const Vec3& p : mesh.positions) field.push_back(unit.dot(p - point));
  return fromField(mesh, std::move(field));
}

Result<Region> regionOfSphere(const PolygonMesh& mesh, const Vec3& centre, double radius) {
  COIF_TRY(validate(mesh));
  if (!centre.allFinite() || !(radius > 0) || !std::isfinite(radius))
    return makeError(ErrorCode::InvalidArgument, "A sphere needs a finite centre and a radius above 0.");
  std::vector<double> field;
  for (const Vec3& p : mesh.positions) field.push_back(radius - (p - centre).norm());
  return fromField(mesh, std::move(field));
}

Result<Region> regionOfGeodesicDisc(const Surface& surface, const Vec3& seed, double radius) {
  COIF_TRY(validate(surface.mesh()));
  if (!seed.allFinite() || !(radius > 0) || !std::isfinite(radius))
    return makeError(ErrorCode::InvalidArgument, "A disc needs a finite seed and a radius above 0.");
  const SurfacePoint source = surface.nearest(seed);
  if (source.face == kNone) return makeError(ErrorCode::Degenerate, "The mesh has no face to start from.");
  COIF_ASSIGN(std::vector<double> field, geodesicDistances(surface, std::span(&source, 1)));
  // Vertices that no path reaches must stay finite.
  const double far = radius + 10 * surface.size();
  for (double& d : field) d = radius - std::min(d, far);
  return fromField(surface.mesh(), std::move(field));
}

Result<Region> regionOfShell(const PolygonMesh& mesh, std::optional<std::uint32_t> shell, bool throughSeams) {
  COIF_TRY(validate(mesh));
  std::vector<std::uint32_t> corners = mesh.corners;
  if (throughSeams) {
    const auto lowest = coincidentRepresentatives(mesh.positions, 0);
    for (std::uint32_t& v : corners) v = lowest[v];
  }
  const auto shellOf = faceShells(mesh.faceOffsets, corners, mesh.vertexCount());
  std::vector<double> area;
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    points.clear();
    for (std::uint32_t v : mesh.face(f)) points.push_back(mesh.positions[v]);
    area.resize(std::max<std::size_t>(area.size(), shellOf[f] + 1), 0.0);
    area[shellOf[f]] += newellNormal(points).norm();
  }
  if (area.empty()) return makeError(ErrorCode::Degenerate, "The mesh has no face.");
  if (shell && *shell >= area.size())
    return makeError(ErrorCode::NotFound, "The mesh has only " + std::to_string(area.size()) + " shells.",
                     "shell " + std::to_string(*shell));
  const std::uint32_t chosen =
      shell ? *shell : std::uint32_t(std::max_element(area.begin(), area.end()) - area.begin());
  Region region;
  for (std::uint32_t s : shellOf) region.faces.push_back(s == chosen);
  if (!shell && area.size() > 1)
    region.notes.push_back("Of " + std::to_string(area.size()) + " shells the largest was taken.");
  return nonEmpty(std::move(region));
}

Result<Region> intersection(const Region& a, const Region& b) {
  return combine(
      a, b, [](bool x, bool y) { return x && y; }, [](double x, double y) { return std::min(x, y); });
}

Result<Region> unionOf(const Region& a, const Region& b) {
  return combine(
      a, b, [](bool x, bool y) { return x || y; }, [](double x, double y) { return std::max(x, y); });
}

Result<Region> difference(const Region& a, const Region& b) {
  return combine(
      a, b, [](bool x, bool y) { return x && !y; }, [](double x, double y) { return std::min(x, -y); });
}

}  // namespace coif
