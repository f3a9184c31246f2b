#include "coif/strands/roots.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "coif/base/check.h"
#include "coif/base/parallel.h"
#include "coif/scalp/polygon_mesh.h"
#include "coif/strands/root_face.h"
#include "root_offsets.h"
#include "root_sequence.h"

namespace coif {
namespace {

constexpr double kLeastLength = 1e-9;  // of the mesh's box

constexpr std::size_t kMostRoots = std::size_t{1} << 31;

/// What a bundle offers to roots.
struct Ground {
  double weight = 0;      ///< density · area; 0: carries none
  double zeroWeight = 0;  ///< the same where only its length is missing
  bool barren = false, triangulated = false;
  std::uint8_t corners = 0;
};

std::vector<Vec3> rootCorners(const HairMesh& mesh, const Bundle& bundle) {
  std::vector<Vec3> corners;
  for (const std::uint32_t v : bundle.face(0)) corners.push_back(mesh.position(v));
  return corners;
}

bool hasLength(const HairMesh& mesh, const Bundle& bundle, double least) {
  for (std::uint32_t i = 0; i < bundle.corners; ++i) {
    const Vec3& root = mesh.position(bundle.face(0)[i]);
    for (std::uint32_t k = 1; k <= bundle.height(); ++k) {
      if ((mesh.position(bundle.face(k)[i]) - root).norm() > least) return true;
    }
  }
  return false;
}

Status checkOptions(const HairMesh& mesh, const RootOptions& options) {
  if (options.count > kMostRoots) {
    return makeError(ErrorCode::TooLarge, std::to_string(options.count) + " strands are more than 2^31");
  }
  if (!options.density.empty() && options.density.size() != mesh.bundles().size()) {
    return makeError(ErrorCode::InvalidArgument, "there are " + std::to_string(options.density.size()) +
                                                     " densities for " +
                                                     std::to_string(mesh.bundles().size()) + " bundles");
  }
  for (std::size_t b = 0; b < options.density.size(); ++b) {
    if (!(options.density[b] >= 0) || !std::isfinite(options.density[b])) {
      return makeError(ErrorCode::InvalidArgument, "a density must be zero or more",
                       "bundle " + std::to_string(b));
    }
  }
  for (const HairVertex& vertex : mesh.vertices()) {
    if (!vertex.position.allFinite()) {
      return makeError(ErrorCode::Degenerate, "a position of the hair mesh is not finite",
                       "vertex " + std::to_string(std::uint32_t(vertex.id)));
    }
  }
  return {};
}

/// One claim on the merged order.
struct Claim {
  double key;
  std::uint32_t bundle, n;
  bool operator<(const Claim& o) const { return key != o.key ? key < o.key : bundle < o.bundle; }
};

class RootPlacer {
 public:
  RootPlacer(const HairMesh& mesh, const RootOptions& options, const Context& context)
      : mesh_(mesh), options_(options), context_(context) {}

  Result<RootSet> run() {
    survey();
    if (context_.cancelled()) return cancelled();
    if (options_.count > 0 && !(totalWeight_ > 0)) {
      return makeError(ErrorCode::Degenerate,
                       "no bundle can carry a strand: every one is without height, area, "
                       "length or density");
    }
    if (options_.count > 0) merge();
    group();
    fill();
    if (context_.cancelled()) return cancelled();
    return std::move(out_);
  }

 private:
  static Error cancelled() { return makeError(ErrorCode::Cancelled, "stopped while placing roots"); }

  void survey() {
    const auto bundles = mesh_.bundles();
    grounds_.resize(bundles.size());
    std::vector<Vec3> positions;
    for (const HairVertex& vertex : mesh_.vertices()) positions.push_back(vertex.position);
    const double least = kLeastLength * bounds(positions).diagonal();
    parallelFor(context_, bundles.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) grounds_[b] = surveyOne(b, least);
    });
    double zeroWeight = 0;
    for (const Ground& ground : grounds_) {
      totalWeight_ += ground.weight;
      zeroWeight += ground.zeroWeight;
      out_.barrenBundles += ground.barren;
      out_.triangulatedFaces += ground.triangulated;
    }
    if (totalWeight_ > 0) {
      out_.zeroLength = std::size_t(std::llround(double(options_.count) * zeroWeight / totalWeight_));
    }
  }

  Ground surveyOne(std::size_t b, double least) const {
    const Bundle& bundle = mesh_.bundles()[b];
    Ground ground;
    const RootFace face(rootCorners(mesh_, bundle));
    ground.barren = face.barren() || bundle.height() == 0;
    if (ground.barren) return ground;
    ground.triangulated = face.triangulated();
    const double weight = face.area() * (options_.density.empty() ? 1.0 : options_.density[b]);
    (hasLength(mesh_, bundle, least) ? ground.weight : ground.zeroWeight) = weight;
    return ground;
  }

  /// The first `count` claims. All claims up to (count + live bundles)/Σ weight are at least count many.
  void merge() {
    std::size_t live = 0;
    for (const Ground& ground : grounds_) live += ground.weight > 0;
    const double last = (double(options_.count) + double(live)) / totalWeight_ * (1 + 1e-12);
    const std::vector<double> offsets = rootOffsets(mesh_, options_.seed);
    claims_.reserve(options_.count + 2 * live);
    for (std::size_t b = 0; b < grounds_.size(); ++b) {
      if (!(grounds_[b].weight > 0)) continue;
      const double start = offsets[b], step = 1 / grounds_[b].weight;
      for (std::uint32_t n = 0;; ++n) {
        const double key = (double(n) + start) * step;
        if (key > last) break;
        claims_.push_back({key, std::uint32_t(b), n});
      }
    }
    COIF_CHECK(claims_.size() >= options_.count, "enough claims were made");
    sortClaims(last);
    claims_.resize(options_.count);
  }

  /// Keys are spread evenly over [0, last], so buckets of a few claims each leave little to sort.
  void sortClaims(double last) {
    const std::size_t buckets = claims_.size() / 4 + 1;
    const auto bucketOf = [&](const Claim& c) {
      return std::min(std::size_t(c.key / last * double(buckets)), buckets - 1);
    };
    std::vector<std::uint32_t> ends(buckets + 1, 0);
    for (const Claim& c : claims_) ++ends[bucketOf(c) + 1];
    for (std::size_t i = 0; i < buckets; ++i) ends[i + 1] += ends[i];
    std::vector<std::uint32_t> next(ends.begin(), ends.end() - 1);
    std::vector<Claim> sorted(claims_.size());
    for (const Claim& c : claims_) sorted[next[bucketOf(c)]++] = c;
    for (std::size_t i = 0; i < buckets; ++i) {
      std::sort(sorted.begin() + ends[i], sorted.begin() + ends[i + 1]);
    }
    claims_ = std::move(sorted);
  }

  void group() {
    const std::size_t bundles = grounds_.size(), count = claims_.size();
    out_.bundleStarts.assign(bundles + 1, 0);
    out_.bundles.resize(count);
    out_.weightOffsets.resize(count + 1);
    for (std::size_t r = 0; r < count; ++r) {
      const std::uint32_t b = claims_[r].bundle;
      out_.bundles[r] = b;
      ++out_.bundleStarts[b + 1];
      out_.weightOffsets[r + 1] = out_.weightOffsets[r] + mesh_.bundles()[b].corners;
    }
    for (std::size_t b = 0; b < bundles; ++b) out_.bundleStarts[b + 1] += out_.bundleStarts[b];
    out_.byBundle.resize(count);
    for (std::size_t r = 0; r < count; ++r) {
      out_.byBundle[out_.bundleStarts[claims_[r].bundle] + claims_[r].n] = std::uint32_t(r);
    }
    claims_ = {};
  }

  void fill() {
    out_.ids.resize(out_.bundles.size());
    out_.weights.resize(out_.weightOffsets.back());
    std::atomic<std::size_t> negative{0};  // a sum of integers: the same in any order
    progressiveTile();
    parallelFor(context_, grounds_.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) negative += fillBundle(b);
    });
    out_.negativeWeights = negative;
  }

  std::size_t fillBundle(std::size_t b) {
    const Bundle& bundle = mesh_.bundles()[b];
    const auto roots = std::span(out_.byBundle)
                           .subspan(out_.bundleStarts[b], out_.bundleStarts[b + 1] - out_.bundleStarts[b]);
    if (roots.empty()) return 0;
    const RootFace face(rootCorners(mesh_, bundle));
    RootSequence sequence(face, options_.seed, bundle.id);
    std::vector<double> weights(bundle.corners);
    std::size_t negative = 0;
    for (const std::uint32_t r : roots) {
      const RootSequence::Root root = sequence.next();
      out_.ids[r] = strandId(bundle.id, root.index);
      negative += face.weights(root.place, weights);
      std::copy(weights.begin(), weights.end(), out_.weights.begin() + std::ptrdiff_t(out_.weightOffsets[r]));
    }
    return negative;
  }

  const HairMesh& mesh_;
  const RootOptions& options_;
  const Context& context_;
  std::vector<Ground> grounds_;
  std::vector<Claim> claims_;
  double totalWeight_ = 0;
  RootSet out_;
};

}  // namespace

Result<RootSet> placeRoots(const HairMesh& mesh, const RootOptions& options, const Context& context) {
  COIF_TRY(checkOptions(mesh, options));
  return RootPlacer(mesh, options, context).run();
}

}  // namespace coif
