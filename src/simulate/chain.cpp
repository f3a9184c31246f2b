#include "coif/simulate/chain.h"

#include <cmath>
#include <numbers>

#include "coif/strands/frames.h"

namespace coif {

namespace {

Error faultAt(std::size_t node, const std::string& what) {
  return makeError(ErrorCode::InvalidArgument, what, "node " + std::to_string(node));
}

Status checkSizes(const ChainSet& c) {
  const std::size_t n = c.nodeCount(), t = c.treeOffsets.size();
  const bool fits = t > 0 && c.treeOffsets.front() == 0 && c.treeOffsets.back() == n &&
                    c.lengths.size() == n && c.restDirections.size() == n && c.stiffness.size() == n &&
                    c.masses.size() == n && c.drags.size() == n && c.radii.size() == n &&
                    c.restPositions.size() == n && c.rootFrames.size() == t - 1 &&
                    c.freeRoots.size() == t - 1 && (c.sources.empty() || c.sources.size() == n);
  if (!fits) return makeError(ErrorCode::InvalidArgument, "the chains' arrays do not fit together");
  return {};
}

bool isFrame(const Mat3& frame) {
  return frame.allFinite() && (frame.transpose() * frame - Mat3::Identity()).norm() < 1e-6 &&
         frame.determinant() > 0;
}

// Depth first: a node's parent is the node before it, or one of that node's ancestors.
bool isDepthFirst(const ChainSet& c, std::uint32_t node) {
  for (std::uint32_t a = node - 1; a != kNone; a = c.parents[a]) {
    if (a == c.parents[node]) return true;
  }
  return false;
}

Status checkLink(const ChainSet& c, std::uint32_t i) {
  if (!(c.lengths[i] > 0) || !std::isfinite(c.lengths[i]))
    return faultAt(i, "a link's length is not positive");
  if (!(std::abs(c.restDirections[i].norm() - 1) < 1e-6))
    return faultAt(i, "a rest direction is not a unit vector");
  if (!(c.stiffness[i] >= 0) || !std::isfinite(c.stiffness[i]))
    return faultAt(i, "a joint's stiffness is negative or not finite");
  return {};
}

Status checkNode(const ChainSet& c, std::uint32_t i) {
  if (!c.restPositions[i].allFinite()) return faultAt(i, "a position is not finite");
  if (!(c.masses[i] > 0) || !std::isfinite(c.masses[i])) return faultAt(i, "a mass is not positive");
  if (!(c.drags[i] >= 0) || !std::isfinite(c.drags[i])) return faultAt(i, "a drag is negative or not finite");
  if (!(c.radii[i] >= 0) || !std::isfinite(c.radii[i]))
    return faultAt(i, "a radius is negative or not finite");
  return {};
}

Status checkLaterals(const ChainSet& c) {
  for (const LateralSpring& s : c.laterals) {
    const bool links = s.a < c.nodeCount() && s.b < c.nodeCount() && s.a != s.b && c.parents[s.a] != kNone &&
                       c.parents[s.b] != kNone;
    if (!links || !(s.stiffness >= 0) || !std::isfinite(s.stiffness) || !s.rest.allFinite())
      return faultAt(s.a, "a lateral spring does not join two links, or is not finite");
  }
  return {};
}

}  // namespace

Status validate(const ChainSet& c) {
  COIF_TRY(checkSizes(c));
  for (std::size_t t = 0; t < c.treeCount(); ++t) {
    const std::uint32_t begin = c.treeOffsets[t], end = c.treeOffsets[t + 1];
    if (begin >= end || c.parents[begin] != kNone) return faultAt(begin, "a tree does not begin with a root");
    if (!isFrame(c.rootFrames[t])) return faultAt(begin, "a root frame is not a rotation");
    for (std::uint32_t i = begin; i < end; ++i) {
      COIF_TRY(checkNode(c, i));
      if (i == begin) continue;
      if (c.parents[i] < begin || c.parents[i] >= i || !isDepthFirst(c, i))
        return faultAt(i, "the nodes of a tree are not in depth-first order");
      COIF_TRY(checkLink(c, i));
    }
  }
  return checkLaterals(c);
}

double fibreRigidity(double youngModulus, double fibreRadius, double hairs) {
  return hairs * youngModulus * std::numbers::pi * std::pow(fibreRadius, 4) / 4;
}

void linkFrames(const ChainSet& chains, std::span<const Vec3> positions, std::span<const Mat3> rootFrames,
                std::span<Mat3> out) {
  for (std::size_t t = 0; t < chains.treeCount(); ++t) {
    out[chains.treeOffsets[t]] = rootFrames[t];
    for (std::uint32_t i = chains.treeOffsets[t] + 1; i < chains.treeOffsets[t + 1]; ++i) {
      const Mat3& base = out[chains.parents[i]];
      const Frame frame =
          turnedTo({base.col(2), base.col(0), base.col(1)}, positions[i] - positions[chains.parents[i]]);
      out[i] << frame.normal, frame.binormal, frame.tangent;
    }
  }
}

}  // namespace coif
