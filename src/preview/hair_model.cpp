#include "preview/hair_model.h"

#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/strands/sampler.h"

namespace coif::preview {
namespace {

bool finiteVertices(const HairModel& model, const Lock& lock) {
  const std::size_t count = std::size_t(lock.corners) * (lock.height + 1);
  for (std::size_t i = 0; i < count; ++i) {
    if (!model.mesh.position(model.bundleVertices[lock.vertexStart + i]).allFinite()) return false;
  }
  return true;
}

/// The strands at so many points, evenly over the spline's parameter.
std::vector<Vec3f> sampled(const HairModel& model, const SampledRoots& of, std::uint32_t points,
                           const Context& context) {
  const StrandSampler sampler(model.mesh, of.roots, {points, {}, model.knots}, of.landings, context);
  std::vector<Vec3f> out(sampler.pointCount());
  sampler.evaluate(out, context);
  return out;
}

/// Lays a style on strands of style.points points.
void layOn(const HairModel& model, const SampledRoots& of, const SampledStyle& style, std::span<Vec3f> points,
           const Context& context) {
  const std::vector<Frame> faces = rootFaceFrames(model.mesh);
  parallelFor(context, of.roots.size(), 64, [&](std::size_t begin, std::size_t end) {
    StrandCurve curve;
    for (std::size_t s = begin; s < end; ++s) {
      const auto strand = points.subspan(s * style.points, style.points);
      curve.load(strand, rootFrame(faces[of.roots.bundles[s]], strand, style.turns[s]));
      for (std::uint32_t p = 0; p < style.points; ++p) {
        const Vec3 offset = style.offsets[s * style.points + p].cast<double>();
        strand[p] = styledPoint(curve, double(p) * double(style.reach[s]), offset).cast<float>();
      }
    }
  });
}

void sampleCoarse(HairModel& model, const Context& context) {
  const SampledStyle& style = model.coarseStyle;
  std::vector<Vec3f> points = sampled(model, model.coarseRoots, kCoarsePoints, context);
  if (model.styled) layOn(model, model.coarseRoots, style, points, context);
  CoarseStrands& coarse = model.coarse = {};
  for (std::size_t s = 0; s < model.coarseRoots.roots.size(); ++s) {
    const std::size_t begin = coarse.points.size();
    bool finite = true;
    for (std::uint32_t i = 0; i < kCoarsePoints; ++i) {
      const Vec3f& p = points[s * kCoarsePoints + i];
      const float t = float(i) / float(kCoarsePoints - 1);
      const float factor = style.widths.empty() ? 1.0f : style.widths[s * kCoarsePoints + i];
      const auto& ends = model.coarseRoots.widths;
      finite = finite && p.allFinite();
      coarse.points.push_back({p, factor * ((1 - t) * ends[2 * s] + t * ends[2 * s + 1])});
    }
    if (!finite)
      coarse.points.resize(begin);
    else
      coarse.starts.push_back(std::uint32_t(coarse.points.size())),
          coarse.longer.push_back(model.members[model.coarseRoots.roots.bundles[s]].longer);
  }
  model.finishCoarse();
}

void sampleExamples(HairModel& model, const Context& context) {
  const std::uint32_t n = model.exampleStyle.points;
  std::vector<Vec3f> points = sampled(model, model.exampleRoots, n, context);
  layOn(model, model.exampleRoots, model.exampleStyle, points, context);
  for (HairModel::Members& lock : model.members) lock.examples.clear();
  for (std::size_t s = 0; s < model.exampleRoots.roots.size(); ++s) {
    auto& example = model.members[model.exampleRoots.roots.bundles[s]].examples.emplace_back();
    for (std::uint32_t p = 0; p < n; ++p) example.push_back(points[s * n + p].cast<double>());
  }
  for (HairModel::Members& lock : model.members) {
    double all = 0, few = 0;
    for (const auto& example : lock.examples) {
      std::vector<Vec3> coarse;
      for (std::uint32_t k = 0; k < kCoarsePoints; ++k)
        coarse.push_back(example[pointTaken(k, kCoarsePoints, n)]);
      all += lengthOf(example), few += lengthOf(coarse);
    }
    lock.longer = few > 0 && std::isfinite(all) ? float(all / few) : 1.0f;
  }
}

}  // namespace

double lengthOf(std::span<const Vec3> points) {
  double length = 0;
  for (std::size_t p = 1; p < points.size(); ++p) length += (points[p] - points[p - 1]).norm();
  return length;
}

std::uint32_t pointTaken(std::uint32_t k, std::uint32_t samples, std::uint32_t points) {
  return std::uint32_t((2ull * k * (points - 1) + samples - 1) / (2 * (samples - 1)));
}

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

void HairModel::move(std::span<const Vec3> positions) {
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
  moved = true;
}

void HairModel::follow(const Context& context) {
  if (moved) sample(context);
}

void HairModel::sample(const Context& context) {
  moved = false;
  if (styled) sampleExamples(*this, context);
  sampleCoarse(*this, context);
}

}  // namespace coif::preview
