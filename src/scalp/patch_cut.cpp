#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "connectivity.h"
#include "patch.h"

namespace coif {
namespace {

/// Triangles that are being cut; vertices at equal positions are one.
class Cutter {
 public:
  explicit Cutter(const Surface& surface) : surface_(&surface) {
    const auto& positions = surface.mesh().positions;
    name_ = coincidentRepresentatives(positions, 0);
    patch_.positions = positions;
    for (std::size_t v = 0; v < name_.size(); ++v) seams_ |= name_[v] != v;
  }

  bool seams() const { return seams_; }
  std::uint32_t nameOf(std::uint32_t vertex) const { return name_[vertex]; }

  void addTriangle(std::uint32_t t) {
    const auto v = surface_->triangleVertices(t);
    const Patch::Triangle named{name_[v[0]], name_[v[1]], name_[v[2]]};
    if (named[0] == named[1] || named[1] == named[2] || named[2] == named[0]) return;
    patch_.triangles.push_back(named);
    patch_.parents.push_back(t);
    patch_.barycentrics.push_back({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
  }

  /// Splits every triangle along the zero set of `field` (by vertex; grows with new vertices, 0 on the cut).
  /// Vertices within `snap` of an edge's length of the cut are taken to be on it. Drops the negative side if
  /// asked.
  void cut(std::vector<double>& field, double snap, bool dropNegative) {
    for (const Patch::Triangle& t : patch_.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        double &a = field[t[k]], &b = field[t[(k + 1) % 3]];
        if (a * b < 0 && std::abs(a) < snap * std::abs(a - b)) a = 0;
        if (a * b < 0 && std::abs(b) < snap * std::abs(a - b)) b = 0;
      }
    Patch in = std::move(patch_);
    patch_ = {};
    patch_.positions = std::move(in.positions);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts;
    for (std::size_t t = 0; t < in.triangles.size(); ++t) {
      Polygon positive, negative;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = in.triangles[t][k], b = in.triangles[t][(k + 1) % 3];
        const Corner here{a, in.barycentrics[t][k]};
        if (field[a] >= 0) positive.push_back(here);
        if (field[a] <= 0) negative.push_back(here);
        if (field[a] * field[b] >= 0) continue;
        const auto [it, isNew] = cuts.try_emplace(std::minmax(a, b), std::uint32_t(patch_.positions.size()));
        const double s = field[a] / (field[a] - field[b]);
        if (isNew) {
          // From the lower vertex, so that both triangles agree to the bit.
          const auto [lo, hi] = std::minmax(a, b);
          const double r = field[lo] / (field[lo] - field[hi]);
          patch_.positions.push_back((1 - r) * patch_.positions[lo] + r * patch_.positions[hi]);
          field.push_back(0);
        }
        const Corner middle{it->second, (1 - s) * here.barycentric + s * in.barycentrics[t][(k + 1) % 3]};
        positive.push_back(middle);
        negative.push_back(middle);
      }
      fan(positive, in.parents[t]);
      if (!dropNegative && isNegative(in.triangles[t], field)) fan(negative, in.parents[t]);
    }
  }

  /// The component (through shared edges) of greatest area; others are noted and dropped.
  void keepLargest(std::vector<std::string>& notes) {
    const EdgeTable edges = edgeTable();
    DisjointSets sets(patch_.triangles.size());
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (const EdgeUse& use : edges.edge(e)) sets.join(edges.edge(e)[0].face, use.face);
    std::map<std::uint32_t, double> area;
    double total = 0;
    for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t) {
      area[sets.find(t)] += patch_.area(t);
      total += patch_.area(t);
    }
    if (area.size() < 2) return;
    std::uint32_t best = area.begin()->first;
    for (const auto& [root, a] : area)
      if (a > area[best]) best = root;
    if (area[best] < 0.999 * total)
      notes.push_back("The region has " + std::to_string(area.size()) +
                      " parts that are not connected; the largest was taken.");
    Patch kept;
    kept.positions = patch_.positions;
    for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t) {
      if (sets.find(t) != best) continue;
      kept.triangles.push_back(patch_.triangles[t]);
      kept.parents.push_back(patch_.parents[t]);
      kept.barycentrics.push_back(patch_.barycentrics[t]);
    }
    patch_ = std::move(kept);
  }

  Patch take() { return std::move(patch_); }
  const Patch& patch() const { return patch_; }

 private:
  struct Corner {
    std::uint32_t vertex;
    Vec3 barycentric;
  };
  using Polygon = std::vector<Corner>;

  /// A triangle that only touches the cut belongs to the positive side unless a corner is below it.
  static bool isNegative(const Patch::Triangle& t, const std::vector<double>& field) {
    return field[t[0]] < 0 || field[t[1]] < 0 || field[t[2]] < 0;
  }

  void fan(const Polygon& polygon, std::uint32_t parent) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      patch_.triangles.push_back({polygon[0].vertex, polygon[i].vertex, polygon[i + 1].vertex});
      patch_.parents.push_back(parent);
      patch_.barycentrics.push_back(
          {polygon[0].barycentric, polygon[i].barycentric, polygon[i + 1].barycentric});
    }
  }

  EdgeTable edgeTable() const {
    std::vector<std::uint32_t> offsets{0}, corners;
    for (const Patch::Triangle& t : patch_.triangles) {
      corners.insert(corners.end(), t.begin(), t.end());
      offsets.push_back(std::uint32_t(corners.size()));
    }
    return buildEdges(offsets, corners);
  }

  const Surface* surface_;
  std::vector<std::uint32_t> name_;
  Patch patch_;
  bool seams_ = false;
};

/// ±1 by faces, averaged at vertices and then along edges a few times: a smooth edge along stepped faces.
std::vector<double> smoothedIndicator(const PolygonMesh& mesh, const Region& region, const Cutter& cutter) {
  std::vector<double> field(mesh.vertexCount(), 0.0), weight(mesh.vertexCount(), 0.0);
  for (std::size_t f = 0; f < mesh.faceCount(); ++f)
    for (std::uint32_t v : mesh.face(f)) {
      field[cutter.nameOf(v)] += region.faces[f] ? 1 : -1;
      weight[cutter.nameOf(v)] += 1;
    }
  for (std::size_t v = 0; v < field.size(); ++v)
    if (weight[v] > 0) field[v] /= weight[v];
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sum(field.size(), 0.0);
    std::fill(weight.begin(), weight.end(), 0.0);
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
      const auto face = mesh.face(f);
      for (std::size_t k = 0; k < face.size(); ++k) {
        const std::uint32_t a = cutter.nameOf(face[k]), b = cutter.nameOf(face[(k + 1) % face.size()]);
        sum[a] += field[b];
        sum[b] += field[a];
        weight[a] += 1;
        weight[b] += 1;
      }
    }
    for (std::size_t v = 0; v < field.size(); ++v)
      if (weight[v] > 0) field[v] = 0.5 * field[v] + 0.5 * sum[v] / weight[v];
  }
  return field;
}

double totalArea(const Patch& patch) {
  double sum = 0;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) sum += patch.area(t);
  return sum;
}

/// The path of edges on the plane, from edge to edge of the patch; empty unless it is the only one and
/// simple.
std::vector<std::uint32_t> middlePath(const Patch& patch, const MirrorPlane& plane, double tolerance) {
  std::vector<std::uint8_t> on(patch.positions.size(), 0), rim(patch.positions.size(), 0);
  for (std::size_t v = 0; v < on.size(); ++v) on[v] = std::abs(plane.side(patch.positions[v])) <= tolerance;
  for (std::uint32_t v : patch.boundary) rim[v] = 1;
  std::map<std::uint32_t, std::vector<std::uint32_t>> next;
  for (const Patch::Triangle& t : patch.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (!on[a] || !on[b]) continue;
      next[a].push_back(b);
      next[b].push_back(a);
    }
  std::uint32_t start = kNone;
  int ends = 0;
  for (auto& [v, list] : next) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    if (list.size() > 2 || (list.size() == 1 && !rim[v]) || (list.size() == 2 && rim[v])) return {};
    if (list.size() != 1) continue;
    if (start == kNone) start = v;
    ++ends;
  }
  if (ends != 2) return {};
  std::vector<std::uint32_t> path{start};
  for (std::uint32_t previous = kNone; path.size() < next.size() + 1;) {
    const std::uint32_t here = path.back();
    std::uint32_t onward = kNone;
    for (std::uint32_t n : next[here])
      if (n != previous) onward = n;
    if (onward == kNone) break;
    previous = here;
    path.push_back(onward);
  }
  // A closed loop of plane edges besides the path would part the patch again.
  return path.size() == next.size() ? path : std::vector<std::uint32_t>{};
}

}  // namespace

double Patch::area(std::size_t t) const {
  const auto& [a, b, c] = triangles[t];
  return 0.5 * (positions[b] - positions[a]).cross(positions[c] - positions[a]).norm();
}

Result<Patch> cutPatch(const Surface& surface, const Region& region, const PatchOptions& options) {
  const PolygonMesh& mesh = surface.mesh();
  Cutter whole(surface);
  Cutter cutter = whole;
  for (std::uint32_t t = 0; t < surface.triangleCount(); ++t) {
    if (region.faces[surface.triangleFace(t)]) whole.addTriangle(t);
    cutter.addTriangle(t);
  }
  if (whole.patch().triangles.empty() || !(totalArea(whole.patch()) > 0))
    return makeError(ErrorCode::Degenerate, "The region holds no face with an area.");
  std::vector<std::string> notes;
  if (whole.seams()) notes.push_back("Vertices at equal positions were treated as joined.");
  if (!options.wholeFaces) {
    std::vector<double> field = region.field;
    if (field.size() != mesh.vertexCount()) {
      field = smoothedIndicator(mesh, region, cutter);
    } else {
      for (std::uint32_t v = 0; v < field.size(); ++v)
        if (cutter.nameOf(v) != v) field[cutter.nameOf(v)] = std::max(field[cutter.nameOf(v)], field[v]);
    }
    // A hundredth of an edge is invisible, and keeps slivers out.
    cutter.cut(field, 0.01, true);
    cutter.keepLargest(notes);
    const double area = totalArea(cutter.patch());
    Cutter largest = whole;
    std::vector<std::string> unused;
    largest.keepLargest(unused);
    // Regions of a few faces vanish when smoothed.
    if (region.field.empty() && area < 0.7 * totalArea(largest.patch())) {
      notes.push_back("The region is too small to smooth its edge: whole faces were taken.");
      cutter = std::move(whole);
    }
  } else {
    cutter = std::move(whole);
  }
  if (options.mirror) {
    const double tolerance = 1e-9 * surface.size();
    std::vector<double> side;
    for (const Vec3& p : cutter.patch().positions) {
      const double s = options.mirror->side(p);
      side.push_back(std::abs(s) <= tolerance ? 0 : s);
    }
    cutter.cut(side, 0, false);
  }
  cutter.keepLargest(notes);
  Patch patch = cutter.take();
  patch.notes = std::move(notes);
  COIF_TRY(makeDisc(patch));
  if (options.mirror) patch.middle = middlePath(patch, *options.mirror, 2e-9 * surface.size());
  return patch;
}

}  // namespace coif
