#include "coif/scalp/mesh_report.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "connectivity.h"

namespace coif {
namespace {

/// Areas below this part of the longest side squared are rounding.
constexpr double kZeroArea = 1e-12;
constexpr std::size_t kMostShellLines = 16;

class Inspector {
 public:
  explicit Inspector(const PolygonMesh& mesh) : mesh_(mesh) {}

  MeshReport run() {
    selectFaces();
    vertexFindings();
    faceFindings();
    edges_ = buildEdges(offsets_, corners_);
    makeShells();
    edgeFindings();
    vertexFans();
    boundaryLoops();
    finishShells();
    return std::move(report_);
  }

 private:
  void add(MeshFault fault, std::vector<std::uint32_t> elements, std::size_t perItem, const std::string& one,
           const std::string& many) {
    if (elements.empty()) return;
    const std::size_t count = elements.size() / perItem;
    std::string text = count == 1 ? "1 " + one : std::to_string(count) + " " + many;
    report_.findings.push_back({fault, count, std::move(elements), text + "."});
  }

  /// The sound faces, with soft offsets of their own.
  void selectFaces() {
    std::vector<std::uint32_t> bad;
    const auto& offsets = mesh_.faceOffsets;
    for (std::uint32_t f = 0; f + 1 < offsets.size(); ++f) {
      bool ok = offsets[f + 1] >= offsets[f] + 3 && offsets[f + 1] <= mesh_.corners.size();
      for (std::uint32_t c = offsets[f]; ok && c < offsets[f + 1]; ++c)
        ok = mesh_.corners[c] < mesh_.vertexCount();
      if (!ok) {
        bad.push_back(f);
        continue;
      }
      corners_.insert(corners_.end(), mesh_.corners.begin() + offsets[f],
                      mesh_.corners.begin() + offsets[f + 1]);
      offsets_.push_back(std::uint32_t(corners_.size()));
      faces_.push_back(f);
    }
    bad_ = std::move(bad);
  }

  void vertexFindings() {
    std::vector<std::uint32_t> notFinite, unreferenced, coincident;
    std::vector<std::uint8_t> used(mesh_.vertexCount(), 0);
    for (std::uint32_t v : corners_) used[v] = 1;
    const auto lowest = coincidentRepresentatives(mesh_.positions, 0);
    for (std::uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
      if (!mesh_.positions[v].allFinite()) notFinite.push_back(v);
      if (!used[v]) unreferenced.push_back(v);
      if (lowest[v] != v) coincident.push_back(v);
    }
    add(MeshFault::NonFinitePosition, std::move(notFinite), 1, "vertex has a position that is not finite",
        "vertices have positions that are not finite");
    add(MeshFault::BadFace, std::move(bad_), 1, "face names a missing vertex or has fewer than three corners",
        "faces name missing vertices or have fewer than three corners");
    unreferenced_ = std::move(unreferenced);
    coincident_ = std::move(coincident);
  }

  std::span<const std::uint32_t> face(std::size_t i) const {
    return std::span(corners_).subspan(offsets_[i], offsets_[i + 1] - offsets_[i]);
  }

  void faceFindings() {
    std::vector<std::uint32_t> repeated, zero;
    std::vector<Vec3> points;
    areas_.assign(faces_.size(), 0.0);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      std::vector<std::uint32_t> sorted(face(i).begin(), face(i).end());
      std::sort(sorted.begin(), sorted.end());
      if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) repeated.push_back(faces_[i]);
      points.clear();
      for (std::uint32_t v : face(i)) points.push_back(mesh_.positions[v]);
      double longest = 0;
      for (std::size_t k = 0; k < points.size(); ++k)
        longest = std::max(longest, (points[(k + 1) % points.size()] - points[k]).norm());
      if (longest > 0 && std::isfinite(longest))
        for (Vec3& p : points) p /= longest;
      const double relative = 0.5 * newellNormal(points).norm();
      if (!(longest > 0) || relative < kZeroArea) zero.push_back(faces_[i]);
      if (std::isfinite(longest) && std::isfinite(relative)) areas_[i] = relative * longest * longest;
    }
    add(MeshFault::RepeatedCorner, std::move(repeated), 1, "face names a vertex twice",
        "faces name a vertex twice");
    add(MeshFault::ZeroAreaFace, std::move(zero), 1, "face has no area", "faces have no area");
    add(MeshFault::UnreferencedVertex, std::move(unreferenced_), 1, "vertex belongs to no face",
        "vertices belong to no face");
    add(MeshFault::CoincidentVertices, std::move(coincident_), 1, "vertex lies exactly on another",
        "vertices lie exactly on another");
  }

  void makeShells() {
    const auto shellOf = faceShells(offsets_, corners_, mesh_.vertexCount());
    report_.faceShell.assign(mesh_.faceOffsets.empty() ? 0 : mesh_.faceCount(), kNone);
    const std::size_t count = shellOf.empty() ? 0 : *std::max_element(shellOf.begin(), shellOf.end()) + 1;
    report_.shells.resize(count);
    for (Shell& s : report_.shells) s.closed = s.manifold = true;
    vertexShell_.assign(mesh_.vertexCount(), kNone);
    std::vector<std::vector<Vec3>> points(count);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      Shell& s = report_.shells[shellOf[i]];
      report_.faceShell[faces_[i]] = shellOf[i];
      ++s.faceCount;
      s.area += areas_[i];
      for (std::uint32_t v : face(i)) {
        if (vertexShell_[v] != kNone) continue;
        vertexShell_[v] = shellOf[i];
        ++s.vertexCount;
        if (mesh_.positions[v].allFinite()) points[shellOf[i]].push_back(mesh_.positions[v]);
      }
    }
    for (std::size_t s = 0; s < count; ++s) report_.shells[s].box = bounds(points[s]);
  }

  void edgeFindings() {
    std::vector<std::uint32_t> nonManifold, winding;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const auto uses = edges_.edge(e);
      Shell& s = report_.shells[vertexShell_[uses[0].a]];
      ++s.edgeCount;
      if (uses.size() == 1) s.closed = false;
      if (uses.size() > 2) nonManifold.insert(nonManifold.end(), {uses[0].a, uses[0].b});
      if (uses.size() == 2 && uses[0].forward == uses[1].forward)
        winding.insert(winding.end(), {uses[0].a, uses[0].b});
      if (uses.size() > 2 || (uses.size() == 2 && uses[0].forward == uses[1].forward)) s.manifold = false;
    }
    add(MeshFault::NonManifoldEdge, std::move(nonManifold), 2, "edge has three faces or more",
        "edges have three faces or more");
    winding_ = std::move(winding);
  }

  void vertexFans() {
    fans_.emplace(cornerFans(edges_, corners_.size()));
    std::vector<std::uint32_t> first(mesh_.vertexCount(), kNone), bad;
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const std::uint32_t v = corners_[c], fan = fans_->find(c);
      if (first[v] == kNone) first[v] = fan;
      if (first[v] != fan) bad.push_back(v);
    }
    std::sort(bad.begin(), bad.end());
    bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
    for (std::uint32_t v : bad) report_.shells[vertexShell_[v]].manifold = false;
    add(MeshFault::NonManifoldVertex, std::move(bad), 1, "vertex joins faces that only touch there",
        "vertices join faces that only touch there");
    add(MeshFault::InconsistentWinding, std::move(winding_), 2, "edge is run the same way by its two faces",
        "edges are run the same way by their two faces");
  }

  /// Boundary edges meet at the ends of fans; each connected set of them is a loop.
  void boundaryLoops() {
    std::vector<std::uint32_t> boundary;
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      if (edges_.edge(e).size() == 1) boundary.push_back(e);
    DisjointSets loops(boundary.size());
    std::map<std::uint32_t, std::uint32_t> atFan;
    for (std::uint32_t i = 0; i < boundary.size(); ++i) {
      const EdgeUse& use = edges_.edge(boundary[i])[0];
      for (std::uint32_t c : {use.corner, use.nextCorner}) {
        const auto [it, isNew] = atFan.emplace(fans_->find(c), i);
        if (!isNew) loops.join(it->second, i);
      }
    }
    for (std::uint32_t i = 0; i < boundary.size(); ++i)
      if (loops.find(i) == i) ++report_.shells[vertexShell_[edges_.edge(boundary[i])[0].a]].boundaryLoops;
  }

  void finishShells() {
    std::vector<double> volume(report_.shells.size(), 0.0);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::uint32_t shell = report_.faceShell[faces_[i]];
      const Box& box = report_.shells[shell].box;
      const Vec3 centre = 0.5 * box.lo + 0.5 * box.hi;
      const Vec3 a = mesh_.positions[face(i)[0]] - centre;
      for (std::size_t k = 1; k + 1 < face(i).size(); ++k)
        volume[shell] +=
            a.dot((mesh_.positions[face(i)[k]] - centre).cross(mesh_.positions[face(i)[k + 1]] - centre));
    }
    std::vector<std::uint32_t> insideOut, open, all;
    for (std::uint32_t i = 0; i < report_.shells.size(); ++i) {
      Shell& s = report_.shells[i];
      all.push_back(i);
      if (s.closed && std::isfinite(volume[i])) s.volume = volume[i] / 6;
      if (s.closed && s.volume < 0) insideOut.push_back(i);
      if (!s.closed) open.push_back(i);
      const long euler = long(s.vertexCount) - long(s.edgeCount) + long(s.faceCount);
      if (s.manifold) s.genus = int((2 - euler - long(s.boundaryLoops)) / 2);
    }
    add(MeshFault::InsideOutShell, std::move(insideOut), 1, "closed shell is inside out",
        "closed shells are inside out");
    add(MeshFault::OpenShell, std::move(open), 1, "shell is open", "shells are open");
    if (all.size() > 1)
      add(MeshFault::SeveralShells, std::move(all), 1, "", "shells are not connected with each other");
  }

  const PolygonMesh& mesh_;
  MeshReport report_;
  std::vector<std::uint32_t> offsets_{0}, corners_, faces_, bad_, unreferenced_, coincident_, winding_;
  std::vector<std::uint32_t> vertexShell_;
  std::vector<double> areas_;
  EdgeTable edges_;
  std::optional<DisjointSets> fans_;
};

}  // namespace

const char* name(MeshFault fault) {
  switch (fault) {
    case MeshFault::NonFinitePosition:
      return "non-finite position";
    case MeshFault::BadFace:
      return "bad face";
    case MeshFault::RepeatedCorner:
      return "repeated corner";
    case MeshFault::ZeroAreaFace:
      return "zero-area face";
    case MeshFault::UnreferencedVertex:
      return "unreferenced vertex";
    case MeshFault::CoincidentVertices:
      return "coincident vertices";
    case MeshFault::NonManifoldEdge:
      return "non-manifold edge";
    case MeshFault::NonManifoldVertex:
      return "non-manifold vertex";
    case MeshFault::InconsistentWinding:
      return "inconsistent winding";
    case MeshFault::InsideOutShell:
      return "inside-out shell";
    case MeshFault::OpenShell:
      return "open shell";
    case MeshFault::SeveralShells:
      return "several shells";
  }
  return "unknown";
}

const MeshFinding* MeshReport::find(MeshFault fault) const {
  for (const MeshFinding& f : findings)
    if (f.fault == fault) return &f;
  return nullptr;
}

std::string MeshReport::text() const {
  std::ostringstream out;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (i == kMostShellLines) {
      out << "… and " << shells.size() - i << " shells more.\n";
      break;
    }
    const Shell& s = shells[i];
    out << "Shell " << i << ": " << s.faceCount << " faces, " << s.vertexCount << " vertices, "
        << (s.closed ? "closed" : std::to_string(s.boundaryLoops) + " boundary loops");
    if (s.genus >= 0) out << ", genus " << s.genus;
    out << (s.manifold ? "" : ", not manifold") << ".\n";
  }
  for (const MeshFinding& f : findings) out << f.text << "\n";
  return out.str();
}

MeshReport inspect(const PolygonMesh& mesh) {
  return Inspector(mesh).run();
}

}  // namespace coif
