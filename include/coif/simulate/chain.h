// Chains and trees of rigid links, from the hair mesh's root-to-tip edges or from curves.
//
// Nodes are hair-mesh vertices, links are parent→child edges; where a layer splits, the chain becomes a tree
// (Yuksel et al. 2009, section 4). A joint spring of energy κ(1 − u·t) holds each link's direction u at t:
// the rest direction, carried from the root by parallel transport along the links, so that curved rest shapes
// are held and nothing twists. Units are the caller's own, consistently (NodeView says the same).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"
#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// Two links of neighbouring chains, the sides of a side quad: ½ k |(d_b − d_a) − rest|², with d the link
/// vectors and rest turned with the root frame of a's tree.
struct LateralSpring {
  std::uint32_t a = 0, b = 0;  ///< nodes at the links' outer ends
  double stiffness = 0;
  Vec3 rest = Vec3::Zero();  ///< in the root frame of a's tree
};

/// Trees of N nodes, structure of arrays. Tree t has nodes [treeOffsets[t], treeOffsets[t + 1]), its root
/// first, every other node after its parent with its first child directly behind it (depth first). Arrays
/// have N entries unless said otherwise; those of a root's link are unused.
struct ChainSet {
  std::vector<std::uint32_t> treeOffsets{0};  ///< T + 1
  std::vector<std::uint32_t> parents;         ///< node index; kNone for roots
  std::vector<double> lengths;                ///< of the link from the parent
  std::vector<Vec3> restDirections;           ///< unit, in the parent link's frame (its z is the link)
  std::vector<double> stiffness;              ///< κ of the joint at the link's base (energy a radian²)
  std::vector<double> masses, drags, radii;   ///< drag: force −drag · mass · velocity
  std::vector<Vec3> restPositions;            ///< where the nodes were at build
  std::vector<Mat3> rootFrames;               ///< T rotations, world from root frame, at build
  std::vector<std::uint8_t> freeRoots;        ///< T flags: 1 = the root moves freely, without a joint
  std::vector<LateralSpring> laterals;
  std::vector<std::uint32_t> sources;  ///< vertex or point a node was made from; may be empty

  std::size_t nodeCount() const { return parents.size(); }
  std::size_t treeCount() const { return treeOffsets.size() - 1; }
  std::size_t linkCount() const { return nodeCount() - treeCount(); }
};

/// Refuses arrays of the wrong length, orders other than depth first, values that are not finite, lengths or
/// masses that are not positive, stiffness or drag that is negative. Names the node.
Status validate(const ChainSet& chains);

/// What a link weighs and how stiffly it is held.
struct ChainOptions {
  double linearDensity = 1;  ///< mass a unit length of chain, > 0
  /// Flexural rigidity E·I of the chain; joints get EI/ℓ, the root joint 2EI/ℓ (half a link follows it).
  double bendingRigidity = 0;
  /// Artistic instead: a chain held level at its root droops by this fraction of its length under its weight
  /// (EI = w L³ / 8 droop, small deflections), whatever its length. > 0.
  std::optional<double> droop = std::nullopt;
  double gravity = 9.81;       ///< that droop refers to
  double drag = 0;             ///< per unit time, >= 0
  double lateral = 0;          ///< stiffness of side quads, >= 0; 0: none are made
  double radius = 0;           ///< thickness of hair around a node, for collisions
  double weldDistance = 1e-9;  ///< links at most this fraction of the bounding-box diagonal long are welded
};

/// E·I of a round fibre, E π r⁴ / 4; times the number of hairs a chain stands for.
double fibreRigidity(double youngModulus, double fibreRadius, double hairs = 1);

struct ChainBuildReport {
  std::size_t trees = 0, links = 0;
  std::size_t branches = 0;        ///< nodes with more than one child
  std::size_t weldedNodes = 0;     ///< nodes that lay on their parent and were joined to it
  std::size_t droppedTrees = 0;    ///< roots without any link of a length
  std::vector<std::string> notes;  ///< a sentence each
};

struct ChainBuild {
  ChainSet chains;
  std::vector<std::uint32_t> nodeOf;  ///< node of each vertex or point; kNone: belongs to no link
  ChainBuildReport report;
};

/// One tree a root vertex that carries anything. Node masses are half of each adjacent link's. Errors:
/// Degenerate for a position that is not finite; InvalidArgument for options outside their range. Linear
/// cost.
Result<ChainBuild> chainsFromMesh(const HairMesh& mesh, const ChainOptions& options = {});

/// One chain a polyline: points of curve c are [offsets[c], offsets[c + 1]). Errors as chainsFromMesh, and
/// InvalidArgument for offsets that do not ascend or do not fit.
Result<ChainBuild> chainsFromCurves(std::span<const Vec3> points, std::span<const std::uint64_t> offsets,
                                    const ChainOptions& options = {});

/// Moves the mesh's vertices to where their nodes are; vertices without a node stay.
void moveMesh(HairMesh& mesh, const ChainBuild& build, std::span<const Vec3> positions);

/// Frames of the links at `positions` (N; entry of a root: its root frame), by parallel transport from
/// `rootFrames` (T). Columns: normal, binormal, link direction.
void linkFrames(const ChainSet& chains, std::span<const Vec3> positions, std::span<const Mat3> rootFrames,
                std::span<Mat3> out);

}  // namespace coif
