// Chains from hair meshes and from curves: both become a forest of points first.
#include <algorithm>
#include <cmath>

#include "coif/simulate/chain.h"

namespace coif {

namespace {

struct Forest {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> parents;  // before their children
};

Status checkOptions(const ChainOptions& o) {
  const auto notNegative = [](double x) { return x >= 0 && std::isfinite(x); };
  const bool fine = o.linearDensity > 0 && std::isfinite(o.linearDensity) && notNegative(o.bendingRigidity) &&
                    (!o.droop || (*o.droop > 0 && std::isfinite(*o.droop))) && notNegative(o.gravity) &&
                    notNegative(o.drag) && notNegative(o.lateral) && notNegative(o.radius) &&
                    notNegative(o.weldDistance);
  if (!fine) return makeError(ErrorCode::InvalidArgument, "a chain option is negative, zero or not finite");
  return {};
}

Status checkPositions(const Forest& forest) {
  constexpr double kMost = 1e100;  // squares stay finite
  for (std::size_t i = 0; i < forest.positions.size(); ++i) {
    if (!forest.positions[i].allFinite() || forest.positions[i].cwiseAbs().maxCoeff() > kMost)
      return makeError(ErrorCode::Degenerate, "a position is not finite or beyond 1e100",
                       "point " + std::to_string(i));
  }
  return {};
}

double diagonal(std::span<const Vec3> points) {
  if (points.empty()) return 0;
  Vec3 low = points[0], high = low;
  for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

// Nodes of one tree, depth first; a point that lies on its parent's node becomes that node.
class TreeWalk {
 public:
  TreeWalk(const Forest& forest, double weld, ChainBuild& out) : forest_(forest), weld_(weld), out_(out) {
    firstChild_.assign(forest.parents.size(), kNone);
    nextSibling_.assign(forest.parents.size(), kNone);
    for (std::size_t v = forest.parents.size(); v-- > 0;) {
      const std::uint32_t p = forest.parents[v];
      if (p == kNone) continue;
      nextSibling_[v] = firstChild_[p];
      firstChild_[p] = std::uint32_t(v);
    }
    out_.nodeOf.assign(forest.parents.size(), kNone);
  }

  void addTree(std::uint32_t root) {
    const std::size_t before = out_.chains.nodeCount();
    place(root, kNone);
    stack_.clear();
    pushChildren(root);
    while (!stack_.empty()) {
      const std::uint32_t v = stack_.back();
      stack_.pop_back();
      const std::uint32_t parent = out_.nodeOf[forest_.parents[v]];
      if ((forest_.positions[v] - out_.chains.restPositions[parent]).norm() <= weld_) {
        out_.nodeOf[v] = parent;
        ++welded_;
      } else {
        place(v, parent);
      }
      pushChildren(v);
    }
    finish(root, before);
  }

  std::size_t welded() const { return welded_; }

 private:
  void place(std::uint32_t v, std::uint32_t parent) {
    out_.nodeOf[v] = std::uint32_t(out_.chains.nodeCount());
    out_.chains.parents.push_back(parent);
    out_.chains.restPositions.push_back(forest_.positions[v]);
    out_.chains.sources.push_back(v);
  }
  // The first child comes off the stack first.
  void pushChildren(std::uint32_t v) {
    const std::size_t from = stack_.size();
    for (std::uint32_t c = firstChild_[v]; c != kNone; c = nextSibling_[c]) stack_.push_back(c);
    std::reverse(stack_.begin() + std::ptrdiff_t(from), stack_.end());
  }
  void finish(std::uint32_t root, std::size_t before) {
    ChainSet& c = out_.chains;
    if (c.nodeCount() > before + 1) {
      c.treeOffsets.push_back(std::uint32_t(c.nodeCount()));
      return;
    }
    if (firstChild_[root] != kNone) ++out_.report.droppedTrees;  // everything lay on the root
    c.parents.pop_back(), c.restPositions.pop_back(), c.sources.pop_back();
    for (std::uint32_t& node : out_.nodeOf) {
      if (node == before) node = kNone;
    }
  }

  const Forest& forest_;
  double weld_;
  ChainBuild& out_;
  std::vector<std::uint32_t> firstChild_, nextSibling_, stack_;
  std::size_t welded_ = 0;
};

double longestPath(const ChainSet& c, std::uint32_t begin, std::uint32_t end, std::vector<double>& path) {
  double longest = 0;
  path[begin] = 0;
  for (std::uint32_t i = begin + 1; i < end; ++i) {
    path[i] = path[c.parents[i]] + c.lengths[i];
    longest = std::max(longest, path[i]);
  }
  return longest;
}

// The root frame's z runs along the first link.
Mat3 frameAlong(const Vec3& direction) {
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), direction).toRotationMatrix();
}

void fillLinks(ChainSet& c, const ChainOptions& options, ChainBuildReport& report) {
  const std::size_t n = c.nodeCount();
  c.lengths.assign(n, 0);
  c.restDirections.assign(n, Vec3::UnitZ());
  c.stiffness.assign(n, 0);
  c.masses.assign(n, 0);
  c.drags.assign(n, options.drag);
  c.radii.assign(n, options.radius);
  c.freeRoots.assign(c.treeCount(), 0);
  std::vector<std::uint32_t> children(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t p = c.parents[i];
    if (p == kNone) continue;
    c.lengths[i] = (c.restPositions[i] - c.restPositions[p]).norm();
    const double half = options.linearDensity * c.lengths[i] / 2;
    c.masses[i] += half;
    c.masses[p] += half;
    report.branches += ++children[p] == 2;
  }
  std::vector<double> path(n);
  for (std::size_t t = 0; t < c.treeCount(); ++t) {
    const std::uint32_t begin = c.treeOffsets[t], end = c.treeOffsets[t + 1];
    c.rootFrames.push_back(frameAlong(c.restPositions[begin + 1] - c.restPositions[begin]));
    const double length = longestPath(c, begin, end, path);
    const double weight = options.linearDensity * options.gravity;
    const double rigidity =
        options.droop ? weight * std::pow(length, 3) / (8 * *options.droop) : options.bendingRigidity;
    for (std::uint32_t i = begin + 1; i < end; ++i) {
      const std::uint32_t p = c.parents[i];
      c.stiffness[i] =
          p == begin ? 2 * rigidity / c.lengths[i] : 2 * rigidity / (c.lengths[i] + c.lengths[p]);
    }
  }
}

void fillRestDirections(ChainSet& c) {
  std::vector<Mat3> frames(c.nodeCount());
  linkFrames(c, c.restPositions, c.rootFrames, frames);
  for (std::size_t i = 0; i < c.nodeCount(); ++i) {
    if (c.parents[i] == kNone) continue;
    c.restDirections[i] = (frames[c.parents[i]].transpose() * frames[i].col(2)).normalized();
  }
}

Result<ChainBuild> build(const Forest& forest, const ChainOptions& options) {
  COIF_TRY(checkOptions(options));
  COIF_TRY(checkPositions(forest));
  ChainBuild out;
  TreeWalk walk(forest, options.weldDistance * diagonal(forest.positions), out);
  for (std::uint32_t v = 0; v < forest.parents.size(); ++v) {
    if (forest.parents[v] == kNone) walk.addTree(v);
  }
  ChainBuildReport& report = out.report;
  fillLinks(out.chains, options, report);
  fillRestDirections(out.chains);
  report.trees = out.chains.treeCount();
  report.links = out.chains.linkCount();
  report.weldedNodes = walk.welded();
  if (report.weldedNodes > 0)
    report.notes.push_back(std::to_string(report.weldedNodes) +
                           " points lay on their parent and were welded");
  if (report.droppedTrees > 0)
    report.notes.push_back(std::to_string(report.droppedTrees) + " chains have no length and were left out");
  COIF_TRY(validate(out.chains));
  return out;
}

// The link of node `child` if it hangs on `parent`'s node, not welded away.
std::uint32_t linkNode(const ChainBuild& b, std::uint32_t parent, std::uint32_t child) {
  const std::uint32_t node = b.nodeOf[child];
  return node != kNone && b.chains.parents[node] == b.nodeOf[parent] ? node : kNone;
}

void addLaterals(const HairMesh& mesh, double stiffness, ChainBuild& b) {
  ChainSet& c = b.chains;
  std::vector<std::uint32_t> treeOf(c.nodeCount());
  for (std::uint32_t t = 0; t < c.treeCount(); ++t) {
    std::fill(treeOf.begin() + c.treeOffsets[t], treeOf.begin() + c.treeOffsets[t + 1], t);
  }
  for (const SideQuad& quad : sideQuads(mesh)) {
    const std::uint32_t i = linkNode(b, quad.a, quad.c), j = linkNode(b, quad.b, quad.d);
    if (i == kNone || j == kNone || i == j || c.parents[i] == kNone || c.parents[j] == kNone) continue;
    const auto link = [&](std::uint32_t node) -> Vec3 {
      return c.restPositions[node] - c.restPositions[c.parents[node]];
    };
    c.laterals.push_back({i, j, stiffness, c.rootFrames[treeOf[i]].transpose() * (link(j) - link(i))});
  }
}

}  // namespace

Result<ChainBuild> chainsFromMesh(const HairMesh& mesh, const ChainOptions& options) {
  Forest forest;
  for (const HairVertex& v : mesh.vertices()) {
    forest.positions.push_back(v.position);
    forest.parents.push_back(v.parent);
  }
  COIF_ASSIGN(ChainBuild out, build(forest, options));
  if (options.lateral > 0) addLaterals(mesh, options.lateral, out);
  return out;
}

Result<ChainBuild> chainsFromCurves(std::span<const Vec3> points, std::span<const std::uint64_t> offsets,
                                    const ChainOptions& options) {
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != points.size() ||
      !std::ranges::is_sorted(offsets) || points.size() >= kNone)
    return makeError(ErrorCode::InvalidArgument, "offsets do not ascend from 0 to the number of points");
  Forest forest;
  forest.positions.assign(points.begin(), points.end());
  forest.parents.resize(points.size());
  for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
    for (std::uint64_t p = offsets[c]; p < offsets[c + 1]; ++p)
      forest.parents[p] = p == offsets[c] ? kNone : std::uint32_t(p - 1);
  }
  return build(forest, options);
}

void moveMesh(HairMesh& mesh, const ChainBuild& build, std::span<const Vec3> positions) {
  for (std::uint32_t v = 0; v < build.nodeOf.size(); ++v) {
    if (build.nodeOf[v] != kNone) mesh.setPosition(v, positions[build.nodeOf[v]]);
  }
}

}  // namespace coif
