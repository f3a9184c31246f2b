#include "coif/hairmesh/invariants.h"

#include <algorithm>

#include "hairmesh/builder.h"
#include "hairmesh/checks.h"

namespace coif {
namespace hairmesh {
namespace {

class Checker {
 public:
  explicit Checker(const HairMesh& mesh) : mesh_(mesh) {}

  std::vector<InvariantFault> run(const Topology* topology) {
    vertices();
    bundles();
    if (!faults_.empty()) return std::move(faults_);  // indices may mean nothing
    faces();
    if (!faults_.empty()) return std::move(faults_);
    Topology own;
    if (topology == nullptr) {
      auto built = Topology::build(mesh_.vertices().size(), mesh_.bundles(), mesh_.splits());
      if (!built.ok()) {
        fault("root", built.error().place, built.error().message);
        return std::move(faults_);
      }
      own = std::move(built).value();
      topology = &own;
    }
    splits(*topology);
    joinedEdges(*topology);
    bowTies(*topology);
    return std::move(faults_);
  }

 private:
  void fault(std::string name, std::string element, std::string message) {
    faults_.push_back({std::move(name), std::move(element), std::move(message)});
  }

  void vertices() {
    const auto all = mesh_.vertices();
    for (std::size_t v = 0; v < all.size(); ++v) {
      const HairVertex& x = all[v];
      if ((v > 0 && all[v - 1].id >= x.id) || std::uint32_t(x.id) >= mesh_.nextVertexId()) {
        fault("id", placeOf(x.id), "vertex ids do not ascend below the counter");
      }
      if (!x.position.allFinite()) fault("finite", placeOf(x.id), "the position is not finite");
      if (x.layer == 0 ? x.parent != kNone : x.parent >= all.size() || all[x.parent].layer + 1 != x.layer) {
        fault("parent", placeOf(x.id), "the parent is not one layer down");
      }
    }
  }

  void bundles() {
    const auto all = mesh_.bundles();
    for (std::size_t j = 0; j < all.size(); ++j) {
      const Bundle& b = all[j];
      if ((j > 0 && all[j - 1].id >= b.id) || std::uint32_t(b.id) >= mesh_.nextBundleId()) {
        fault("id", placeOf(b.id), "bundle ids do not ascend below the counter");
      }
      if (b.corners < 3 || b.vertices.empty() || b.vertices.size() % b.corners != 0) {
        fault("corner-count", placeOf(b.id),
              "the bundle is not made of whole faces of at least three corners");
      }
      if (b.group >= mesh_.groupNames().size()) fault("group", placeOf(b.id), "the group does not exist");
      for (const std::uint32_t v : b.vertices) {
        if (v >= mesh_.vertices().size()) {
          fault("index", placeOf(b.id),
                "a corner names vertex index " + std::to_string(v) + ", which does not exist");
          break;
        }
      }
    }
  }

  void faces() {
    std::vector<std::uint8_t> used(mesh_.vertices().size(), 0);
    for (const Bundle& b : mesh_.bundles()) {
      for (std::uint32_t k = 0; k < layerCountOf(b); ++k) face(b, k, used);
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) fault("unused", placeOf(mesh_.vertices()[v].id), "no face uses the vertex");
    }
  }

  void face(const Bundle& b, std::uint32_t k, std::vector<std::uint8_t>& used) {
    const auto corners = b.face(k);
    for (std::uint32_t i = 0; i < b.corners; ++i) {
      const HairVertex& x = mesh_.vertices()[corners[i]];
      used[corners[i]] = 1;
      if (x.layer != k) {
        fault("layer", placeOf(b.id),
              "a face of layer " + std::to_string(k) + " uses a vertex of layer " + std::to_string(x.layer));
      } else if (k > 0 && x.parent != b.face(k - 1)[i]) {
        fault("parent", placeOf(x.id),
              "the parent is not the same corner of bundle " + std::to_string(std::uint32_t(b.id)) +
                  " one layer down");
      }
      // Above, distinct parents make distinct vertices.
      for (std::uint32_t j = 0; k == 0 && j < i; ++j) {
        if (corners[i] == corners[j]) fault("face-once", placeOf(b.id), "a face has a vertex twice");
      }
    }
  }

  void splits(const Topology& topology) {
    const auto all = mesh_.splits();
    for (std::size_t s = 0; s < all.size(); ++s) {
      const std::string element = "vertices " + std::to_string(all[s].a) + " and " + std::to_string(all[s].b);
      const bool ordered = all[s].a < all[s].b &&
                           (s == 0 || std::pair(all[s - 1].a, all[s - 1].b) < std::pair(all[s].a, all[s].b));
      if (!ordered) fault("split", element, "splits are not sorted, or an edge has two");
      const std::uint32_t side = topology.findEdge(mesh_.bundles(), all[s].a, all[s].b);
      const std::uint32_t layers =
          std::min(layersAt(topology, side), layersAt(topology, topology.opposite(side)));
      if (all[s].layer == 0 || all[s].layer >= layers) {
        fault("split", element, "the split layer is not between 1 and the lower of the two heights");
      }
    }
  }

  std::uint32_t layersAt(const Topology& topology, std::uint32_t side) const {
    return layerCountOf(mesh_.bundles()[topology.bundleOf(side)]);
  }
  std::uint32_t vertexAt(const Topology& topology, std::uint32_t side, std::uint32_t layer) const {
    return mesh_.bundles()[topology.bundleOf(side)].face(layer)[topology.cornerOf(side)];
  }

  void joinedEdges(const Topology& t) {
    for (std::uint32_t side = 0; side < t.sideCount(); ++side) {
      const std::uint32_t other = t.opposite(side);
      if (other == kNone || other < side) continue;
      for (std::uint32_t k = 0; t.joined(mesh_.bundles(), side, k); ++k) {
        if (vertexAt(t, side, k) != vertexAt(t, t.next(other), k) ||
            vertexAt(t, t.next(side), k) != vertexAt(t, other, k)) {
          fault("joined", placeOf(mesh_.bundles()[t.bundleOf(side)].id),
                "side " + std::to_string(t.cornerOf(side)) + " is shared on layer " + std::to_string(k) +
                    " but its two sides have other vertices");
          break;
        }
      }
    }
  }

  void bowTies(const Topology& t) {
    std::vector<std::uint32_t> fans, fanOf(mesh_.vertices().size(), kNone);
    std::vector<std::uint8_t> several(mesh_.vertices().size(), 0);
    for (std::uint32_t root = 0; root < t.vertexCount(); ++root) {
      const auto corners = t.around(root);
      // Below the first split and the lowest tip the faces form the one fan of the root layer.
      std::uint32_t top = 0, whole = kNone;
      for (const std::uint32_t c : corners) {
        top = std::max(top, layersAt(t, c));
        whole = std::min({whole, layersAt(t, c), t.split(c), t.split(t.prev(c))});
      }
      for (std::uint32_t k = whole; k < top; ++k) {
        fanLabels(t, mesh_.bundles(), root, k, fans);
        for (std::uint32_t i = 0; i < corners.size(); ++i) {
          if (fans[i] == kNone) continue;
          const std::uint32_t v = vertexAt(t, corners[i], k);
          if (fanOf[v] == kNone) fanOf[v] = fans[i];
          if (fanOf[v] != fans[i]) several[v] = 1;
        }
      }
    }
    for (std::size_t v = 0; v < several.size(); ++v) {
      const HairVertex& x = mesh_.vertices()[v];
      if (x.welded && !several[v])
        fault("bow-tie", placeOf(x.id), "the vertex is marked welded but holds one fan");
      if (several[v] && !x.welded) {
        fault("bow-tie", placeOf(x.id), "several fans of faces touch in the vertex and no weld declares it");
      }
    }
  }

  const HairMesh& mesh_;
  std::vector<InvariantFault> faults_;
};

}  // namespace

std::vector<InvariantFault> checkWithTopology(const HairMesh& mesh, const Topology* topology) {
  return Checker(mesh).run(topology);
}

}  // namespace hairmesh

std::vector<InvariantFault> checkInvariants(const HairMesh& mesh) {
  return hairmesh::checkWithTopology(mesh, nullptr);
}

}  // namespace coif
