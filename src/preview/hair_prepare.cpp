#include <algorithm>
#include <cmath>

#include "coif/base/parallel.h"
#include "coif/base/random.h"
#include "preview/detail.h"
#include "preview/hair_model.h"

namespace coif::preview {
namespace {

constexpr std::size_t kCoarseStrands = 8192;
constexpr std::uint32_t kCoarseImported = 17;  // points a strand, at most
constexpr std::size_t kExamples = 48;          // a lock
constexpr std::size_t kStyledExamples = 8;     // a bundle, made again whenever the mesh moves

bool usableWidth(float width) {
  return std::isfinite(width) && width >= 0;
}
std::uint32_t seedOf(const StrandSet& strands, std::size_t s) {
  return std::uint32_t(mix64((strands.ids.empty() ? s : strands.ids[s]) + 1));
}
/// Shaders tell where a strand ends by the next one's seed.
void separateNeighbours(std::vector<Root>& roots) {
  for (std::size_t r = 1; r < roots.size(); ++r)
    roots[r].seed ^= roots[r].seed == roots[r - 1].seed ? 1u : 0u;
}
Eigen::Vector4f vec4(const Vec3f& v, float w = 0) {
  return {v.x(), v.y(), v.z(), w};
}

/// The lock of every strand, kNone to drop it. Sorts strands into the locks and counts.
struct Sorted {
  std::vector<std::uint32_t> places;  ///< of a strand in the sorted roots; kNone: dropped
  std::size_t kept = 0;
};
Sorted sortIntoLocks(std::span<const std::uint32_t> lockOf, HairModel& model) {
  Sorted sorted;
  sorted.places.assign(lockOf.size(), kNone);
  std::vector<std::uint32_t> counts(model.locks.size(), 0);
  for (const std::uint32_t lock : lockOf) {
    if (lock != kNone) ++counts[lock], ++sorted.kept;
  }
  model.members.resize(model.locks.size());
  std::uint32_t start = 0;
  for (std::size_t l = 0; l < counts.size(); ++l) {
    model.locks[l].rootStart = start;
    model.members[l].ranks.reserve(counts[l]);
    start += counts[l];
  }
  std::uint32_t rank = 0;
  for (std::size_t s = 0; s < lockOf.size(); ++s) {
    if (lockOf[s] == kNone) continue;
    auto& ranks = model.members[lockOf[s]].ranks;
    sorted.places[s] = model.locks[lockOf[s]].rootStart + std::uint32_t(ranks.size());
    ranks.push_back(rank++);
  }
  model.strands = sorted.kept;
  model.dropped = lockOf.size() - sorted.kept;
  return sorted;
}

void addBundles(const HairMesh& mesh, HairModel& model) {
  for (const Bundle& bundle : mesh.bundles()) {
    model.locks.push_back({bundle.corners, bundle.height(), std::uint32_t(model.bundleVertices.size()), 0});
    model.bundleVertices.insert(model.bundleVertices.end(), bundle.vertices.begin(), bundle.vertices.end());
  }
  model.mesh = mesh;
  for (const HairVertex& vertex : mesh.vertices()) model.rest.push_back(vertex.position);
}

std::uint32_t bundleOfStrand(const HairMesh& mesh, const StrandSet& strands, std::size_t s) {
  const std::uint32_t bundle = mesh.indexOf(BundleId(strands.rootFaces[s]));
  if (bundle == kNone || mesh.bundles()[bundle].height() == 0) return kNone;
  const std::uint64_t begin = strands.weightOffsets[s], end = strands.weightOffsets[s + 1];
  if (end - begin != mesh.bundles()[bundle].corners) return kNone;
  for (std::uint64_t w = begin; w < end; ++w) {
    if (!std::isfinite(strands.weights[w])) return kNone;
  }
  const std::uint64_t first = strands.offsets[s], last = strands.offsets[s + 1];
  if (last < first + 2 || !strands.points[first].allFinite()) return kNone;
  if (!usableWidth(widthAt(strands, first)) || !usableWidth(widthAt(strands, last - 1))) return kNone;
  return !strands.colors.empty() && !strands.colors[first].allFinite() ? kNone : bundle;
}

double liftOf(const HairMesh& mesh, std::uint32_t bundle, std::span<const float> weights, const Vec3f& root) {
  Vec3 sum = Vec3::Zero();
  const auto face = mesh.bundles()[bundle].face(0);
  for (std::size_t i = 0; i < face.size(); ++i) sum += double(weights[i]) * mesh.position(face[i]);
  return (root.cast<double>() - sum).norm();
}

void addExample(const StrandSet& strands, std::size_t s, HairModel::Members& lock) {
  if (lock.examples.size() >= kExamples) return;
  std::vector<Vec3>& example = lock.examples.emplace_back();
  for (const Vec3f& p : strands.strand(s)) example.push_back(p.cast<double>());
}

void addCoarseImported(const StrandSet& strands, std::size_t s, CoarseStrands& coarse) {
  const std::size_t begin = strands.offsets[s], last = strands.offsets[s + 1] - begin - 1;
  const std::size_t pieces = std::min<std::size_t>(last, kCoarseImported - 1);
  std::vector<Vec3> all, few;
  for (std::size_t k = 0; k <= pieces; ++k) {
    const std::size_t p = begin + k * last / pieces;
    coarse.points.push_back({strands.points[p], widthAt(strands, p)});
    few.push_back(strands.points[p].cast<double>());
  }
  for (const Vec3f& p : strands.strand(s)) all.push_back(p.cast<double>());
  const double length = lengthOf(few);
  coarse.longer.push_back(length > 0 ? float(lengthOf(all) / length) : 1.0f);
  coarse.starts.push_back(std::uint32_t(coarse.points.size()));
}

}  // namespace

Result<PreparedHair> prepareGrown(const HairMesh& mesh, const StrandSet& strands, Knots knots,
                                  const Context& context) {
  const std::size_t count = strands.strandCount();
  if (strands.rootFaces.size() != count || strands.weightOffsets.size() != count + 1) {
    return makeError(ErrorCode::InvalidArgument,
                     "these strands do not say where they grow: bundles and weights are missing");
  }
  PreparedHair hair;
  HairModel& model = hair.model;
  model.synthesised = true;
  model.colored = !strands.colors.empty();
  model.knots = knots;
  addBundles(mesh, model);
  std::vector<std::uint32_t> lockOf(count);
  parallelFor(context, count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) lockOf[s] = bundleOfStrand(mesh, strands, s);
  });
  const Sorted sorted = sortIntoLocks(lockOf, model);
  HairUpload& upload = hair.upload;
  upload.roots.resize(sorted.kept);
  upload.colors.resize(model.colored ? sorted.kept : 0);
  upload.weights.assign(strands.weights.begin(), strands.weights.end());
  for (std::size_t s = 0; s < count; ++s) {
    if (lockOf[s] == kNone) continue;
    const std::uint64_t first = strands.offsets[s], last = strands.offsets[s + 1] - 1;
    const std::uint64_t weight = strands.weightOffsets[s];
    const std::uint32_t corners = model.locks[lockOf[s]].corners;
    upload.roots[sorted.places[s]] = {strands.points[first], widthAt(strands, first), widthAt(strands, last),
                                      seedOf(strands, s),    std::uint32_t(weight),   corners};
    if (model.colored) upload.colors[sorted.places[s]] = vec4(strands.colors[first]);
    model.plainPoints = std::max(model.plainPoints, std::uint32_t(last - first + 1));
    double& lift = model.members[lockOf[s]].restLift;
    lift = std::max(lift, liftOf(mesh, lockOf[s], std::span(strands.weights).subspan(weight, corners),
                                 strands.points[first]));
    if (model.coarseRoots.roots.size() < kCoarseStrands) model.coarseRoots.add(strands, s, lockOf[s]);
    if (sorted.places[s] - model.locks[lockOf[s]].rootStart < kStyledExamples)
      model.exampleRoots.add(strands, s, lockOf[s]);
  }
  separateNeighbours(upload.roots);
  model.coarseRoots.sort(mesh.bundles().size()), model.exampleRoots.sort(mesh.bundles().size());
  model.places = sorted.places;
  std::vector<Vec3> positions = model.rest;
  model.move(positions);
  model.follow(context);
  return hair;
}

Result<PreparedHair> prepareImported(const StrandSet& strands, std::size_t maxPoints,
                                     const Context& context) {
  PreparedHair hair;
  HairModel& model = hair.model;
  model.colored = !strands.colors.empty();
  std::size_t count = strands.strandCount();
  while (count > 0 && strands.offsets[count] > maxPoints) {
    count = std::min<std::size_t>(
        count - 1, std::size_t(std::upper_bound(strands.offsets.begin(), strands.offsets.end(), maxPoints) -
                               strands.offsets.begin() - 1));
  }
  if (count > 0) model.baseScale = double(strands.strandCount()) / double(count);
  // A lock for every step of the ladder, so that no strand is padded by more than half.
  std::vector<std::uint32_t> lockOf(count, kNone);
  parallelFor(context, count, 2048, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      if (drawable(strands, s)) lockOf[s] = ladderStep(std::uint32_t(strands.strand(s).size() - 1));
    }
  });
  std::uint32_t steps = 0;
  for (const std::uint32_t lock : lockOf) steps = lock == kNone ? steps : std::max(steps, lock + 1);
  model.locks.resize(steps);
  const Sorted sorted = sortIntoLocks(lockOf, model);
  HairUpload& upload = hair.upload;
  upload.roots.resize(sorted.kept);
  const std::size_t points = strands.offsets[count];
  upload.points.resize(points);
  upload.colors.resize(model.colored ? points : 0);
  parallelFor(context, points, 1 << 15, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      upload.points[p] = vec4(strands.points[p], widthAt(strands, p));
      if (model.colored) upload.colors[p] = vec4(strands.colors[p]);
    }
  });
  const std::size_t stride = std::max<std::size_t>(sorted.kept / (4 * kExamples), 1);
  for (std::size_t s = 0; s < count; ++s) {
    if (lockOf[s] == kNone) continue;
    const std::uint64_t first = strands.offsets[s], last = strands.offsets[s + 1] - 1;
    upload.roots[sorted.places[s]] = {strands.points[first],  widthAt(strands, first),
                                      widthAt(strands, last), seedOf(strands, s),
                                      std::uint32_t(first),   std::uint32_t(last - first + 1)};
    HairModel::Members& lock = model.members[lockOf[s]];
    lock.mostPoints = std::max(lock.mostPoints, std::uint32_t(last - first + 1));
    if (s % stride == 0 || lock.examples.empty()) addExample(strands, s, lock);
    if (model.coarse.strandCount() < kCoarseStrands) addCoarseImported(strands, s, model.coarse);
  }
  separateNeighbours(upload.roots);
  model.finishCoarse();
  return hair;
}

}  // namespace coif::preview
