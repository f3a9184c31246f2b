#include "preview/hair_model.h"

#include <algorithm>
#include <cmath>

#include "coif/strands/sampler.h"

namespace coif::preview {
namespace {

constexpr std::uint32_t kCoarsePoints = 13;

bool finiteVertices(const HairModel& model, const Lock& lock) {
  const std::size_t count = std::size_t(lock.corners) * (lock.height + 1);
  for (std::size_t i = 0; i < count; ++i) {
    if (!model.mesh.position(model.bundleVertices[lock.vertexStart + i]).allFinite()) return false;
  }
  return true;
}

void sampleCoarse(HairModel& model, const Context& context) {
  const StrandSampler sampler(model.mesh, model.coarseRoots, {kCoarsePoints, {}, model.knots},
                              model.coarseLandings, context);
  std::vector<Vec3f> points(sampler.pointCount());
  sampler.evaluate(points, context);
  CoarseStrands& coarse = model.coarse = {};
  const std::size_t strands = model.coarseRoots.size();
  for (std::size_t s = 0; s < strands; ++s) {
    const std::size_t begin = coarse.points.size();
    bool finite = true;
    for (std::uint32_t i = 0; i < kCoarsePoints; ++i) {
      const Vec3f& p = points[s * kCoarsePoints + i];
      const float t = float(i) / float(kCoarsePoints - 1);
      const float width = (1 - t) * model.coarseWidths[2 * s] + t * model.coarseWidths[2 * s + 1];
      finite = finite && p.allFinite();
      coarse.points.push_back({p, width});
    }
    if (!finite)
      coarse.points.resize(begin);
    else
      coarse.starts.push_back(std::uint32_t(coarse.points.size()));
  }
  model.finishCoarse();
}

}  // namespace

std::size_t HairUpload::bytes() const {
  return roots.size() * sizeof(Root) + weights.size() * sizeof(float) + (points.size() + colors.size()) * 16;
}

std::size_t HairModel::hidden() const {
  std::size_t count = 0;
  for (const Members& lock : members) count += lock.finite ? 0 : lock.ranks.size();
  return count;
}

std::vector<Vec3> HairModel::column(const Lock& lock, std::uint32_t corner) const {
  std::vector<Vec3> out;
  for (std::uint32_t k = 0; k <= lock.height; ++k)
    out.push_back(mesh.position(bundleVertices[lock.vertexStart + k * lock.corners + corner]));
  return out;
}

std::vector<double> HairModel::intervals(const Lock& lock) const {
  std::vector<double> lengths(lock.height, 0.0);
  for (std::uint32_t i = 0; i < lock.corners; ++i) {
    const std::vector<Vec3> points = column(lock, i);
    for (std::uint32_t k = 0; k < lock.height; ++k) lengths[k] += (points[k + 1] - points[k]).norm();
  }
  return knotIntervals(lengths, knots);
}

void HairModel::finishCoarse() {
  bool first = true;
  coarse.scale = coarse.strandCount() > 0 ? baseScale * double(strands) / double(coarse.strandCount()) : 1;
  for (CoarseStrands::Point& p : coarse.points) {
    p.width *= float(coarse.scale);
    const Vec3 d = p.position.cast<double>();
    coarse.box.lo = first ? d : Vec3(coarse.box.lo.cwiseMin(d));
    coarse.box.hi = first ? d : Vec3(coarse.box.hi.cwiseMax(d));
    first = false;
  }
}

void HairModel::move(std::span<const Vec3> positions, const Context& context) {
  for (std::size_t v = 0; v < positions.size(); ++v) mesh.setPosition(std::uint32_t(v), positions[v]);
  for (std::size_t l = 0; l < locks.size(); ++l) {
    double farthest = 0;  // the lift of a root grows by no more than its face's corners moved
    for (std::uint32_t i = 0; i < locks[l].corners; ++i) {
      const std::uint32_t v = bundleVertices[locks[l].vertexStart + i];
      farthest = std::max(farthest, (mesh.position(v) - rest[v]).norm());
    }
    members[l].maxLift = members[l].restLift + farthest;
    members[l].finite = finiteVertices(*this, locks[l]);
  }
  sampleCoarse(*this, context);
}

}  // namespace coif::preview
