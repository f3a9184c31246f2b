// Subdivision: positions layer by layer from OpenSubdiv, topology from the bundles.
#include <algorithm>

#include "coif/hairmesh/operations.h"
#include "hairmesh/divide.h"
#include "hairmesh/refine_layer.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

class Subdivision {
 public:
  Subdivision(HairMeshBuilder& builder, std::vector<std::uint32_t> selection, SubdivisionScheme scheme)
      : b_(builder), selection_(std::move(selection)), scheme_(scheme), chosen_(b_.bundles.size(), 0) {
    std::sort(selection_.begin(), selection_.end());
    for (const std::uint32_t j : selection_) chosen_[j] = 1;
    for (const std::uint32_t j : selection_) top_ = std::max(top_, b_.layers(j));
  }

  Result<Created> run() {
    sidePoints_.resize(b_.topology.sideCount());
    facePoints_.resize(b_.bundles.size());
    moved_.reserve(b_.vertices.size());
    for (const HairVertex& vertex : b_.vertices) moved_.push_back(vertex.position);
    for (std::uint32_t k = 0; k < top_; ++k) COIF_TRY(refine(k));
    COIF_TRY(divideSides(b_, rootEdges(),
                         [&](std::uint32_t side, std::uint32_t k) { return sidePoint(side, k); }));
    for (std::size_t v = 0; v < moved_.size(); ++v) b_.vertices[v].position = moved_[v];
    return makeChildren();
  }

 private:
  bool reaches(std::uint32_t j, std::uint32_t k) const { return chosen_[j] && k < b_.layers(j); }

  /// Points of layer k. Every fan of chosen faces at a vertex is a vertex of the local mesh.
  Status refine(std::uint32_t k) {
    const Topology& t = b_.topology;
    SmallSets fans;
    fans.reset(t.sideCount());
    for (std::uint32_t side = 0; side < t.sideCount(); ++side) {
      const std::uint32_t other = t.opposite(side);
      if (!b_.joined(side, k) || !chosen_[t.bundleOf(side)] || !chosen_[t.bundleOf(other)]) continue;
      fans.unite(side, t.next(other));
      fans.unite(t.next(side), other);
    }
    LayerMesh local;
    std::vector<int> localOf(t.sideCount(), -1);
    std::vector<std::vector<int>> copies(b_.vertices.size());  // local vertices of each vertex
    for (const std::uint32_t j : selection_) {
      if (!reaches(j, k)) continue;
      local.faceSizes.push_back(int(b_.bundles[j].corners));
      for (std::uint32_t i = 0; i < b_.bundles[j].corners; ++i) {
        int& index = localOf[fans.find(t.side(j, i))];
        const std::uint32_t v = b_.at(j, k, i);
        if (index < 0) {
          index = int(local.positions.size());
          local.positions.push_back(b_.vertices[v].position);
          copies[v].push_back(index);
        }
        local.corners.push_back(index);
      }
    }
    for (const auto& of : copies) {
      // Fans that only touch must go on touching: the vertex stays where it is.
      if (of.size() > 1) local.fixed.insert(local.fixed.end(), of.begin(), of.end());
    }
    const auto corner = [&](std::uint32_t side) { return localOf[fans.find(side)]; };
    for (std::uint32_t side = 0; side < t.sideCount(); ++side) {
      const std::uint32_t other = t.opposite(side);
      if (other == kNone || other < side || b_.joined(side, k)) continue;
      if (!reaches(t.bundleOf(side), k) || !reaches(t.bundleOf(other), k)) continue;
      const int a = corner(side), b = corner(t.next(side));
      if (a == corner(t.next(other)) && b == corner(other)) local.creases.emplace_back(a, b);  // a slit
    }
    COIF_ASSIGN(const RefinedLayer refined, refineLayer(local, scheme_));
    store(k, copies, refined);
    return {};
  }

  void store(std::uint32_t k, const std::vector<std::vector<int>>& copies, const RefinedLayer& refined) {
    for (std::size_t v = 0; v < copies.size(); ++v) {
      if (!copies[v].empty()) moved_[v] = refined.vertices[std::size_t(copies[v][0])];
    }
    std::size_t corner = 0, face = 0;
    for (const std::uint32_t j : selection_) {
      if (!reaches(j, k)) continue;
      for (std::uint32_t i = 0; i < b_.bundles[j].corners; ++i) {
        sidePoints_[b_.topology.side(j, i)].push_back(refined.sides[corner++]);
      }
      if (!refined.faces.empty()) facePoints_[j].push_back(refined.faces[face]);
      ++face;
    }
  }

  /// Every root edge of a chosen bundle once; named by a chosen side.
  std::vector<std::uint32_t> rootEdges() const {
    std::vector<std::uint32_t> sides;
    for (const std::uint32_t j : selection_) {
      for (std::uint32_t i = 0; i < b_.bundles[j].corners; ++i) {
        const std::uint32_t side = b_.topology.side(j, i), other = b_.topology.opposite(side);
        if (other == kNone || !chosen_[b_.topology.bundleOf(other)] || side < other) sides.push_back(side);
      }
    }
    return sides;
  }

  Vec3 sidePoint(std::uint32_t side, std::uint32_t k) {
    if (k < sidePoints_[side].size()) return sidePoints_[side][k];
    // Beyond the chosen bundles: the middle of the edge between its ends' new places.
    return 0.5 * (moved_[b_.at(side, k)] + moved_[b_.at(b_.topology.next(side), k)]);
  }

  /// Each chosen bundle now has its corners and side vertices in turn.
  Result<Created> makeChildren() {
    Created created;
    const auto splits = b_.splits();
    for (const std::uint32_t j : selection_) {
      const Bundle parent = b_.bundles[j];
      const std::uint32_t n = parent.corners / 2, layers = layerCountOf(parent);
      std::vector<std::uint32_t> centres;
      for (std::uint32_t k = 0; k < facePoints_[j].size(); ++k) {
        centres.push_back(b_.addVertex(facePoints_[j][k], k == 0 ? kNone : centres[k - 1], k));
      }
      const bool loop = scheme_ == SubdivisionScheme::Loop;
      for (std::uint32_t child = 0; child < n + (loop ? 1 : 0); ++child) {
        std::vector<std::uint32_t> rows;
        for (std::uint32_t k = 0; k < layers; ++k) {
          const auto face = parent.face(k);
          if (child == n) {
            rows.insert(rows.end(), {face[1], face[3], face[5]});
            continue;
          }
          rows.insert(rows.end(), {face[2 * child], face[2 * child + 1]});
          if (!loop) rows.push_back(centres[k]);
          rows.push_back(face[(2 * child + 2 * n - 1) % (2 * n)]);
        }
        const std::uint32_t fresh = b_.addBundle(loop ? 3 : 4, parent.group, std::move(rows));
        created.bundles.push_back(b_.bundles[fresh].id);
      }
      b_.bundles[j].vertices.clear();
    }
    COIF_TRY(b_.retopologise(splits));
    return created;
  }

  HairMeshBuilder& b_;
  std::vector<std::uint32_t> selection_;
  SubdivisionScheme scheme_;
  std::vector<std::uint8_t> chosen_;
  std::uint32_t top_ = 0;
  std::vector<std::vector<Vec3>> sidePoints_, facePoints_;  // by side or bundle, then layer
  std::vector<Vec3> moved_;
};

}  // namespace

Result<Created> subdivide(HairMesh& mesh, std::span<const BundleId> bundles, SubdivisionScheme scheme) {
  std::vector<BundleId> ids(bundles.begin(), bundles.end());
  if (ids.empty()) {
    for (const Bundle& bundle : mesh.bundles()) ids.push_back(bundle.id);
  }
  COIF_ASSIGN(auto selection, selectBundles(mesh, ids));
  if (scheme == SubdivisionScheme::Loop) {
    for (const std::uint32_t j : selection) {
      if (mesh.bundles()[j].corners != 3) {
        return refuse("Loop subdivision needs triangles", placeOf(mesh.bundles()[j].id));
      }
    }
  }
  COIF_ASSIGN(HairMeshBuilder b, HairMeshBuilder::from(mesh));
  COIF_ASSIGN(Created created, Subdivision(b, std::move(selection), scheme).run());
  return commitCreated(b, mesh, std::move(created));
}

}  // namespace coif
