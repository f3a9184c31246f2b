#include "coif/strands/skin.h"

#include <algorithm>

#include "coif/base/parallel.h"

namespace coif {
namespace {

constexpr std::size_t kGrain = 512;

/// A weighted mean of rows.
class Mean {
 public:
  void add(const SkinBinding& binding, std::size_t element, double share) {
    const std::size_t first = binding.firstOf(element);
    for (std::size_t i = first; i < first + binding.influences; ++i) {
      if (binding.weights[i] != 0) at(binding.joints[i]) += share * double(binding.weights[i]);
    }
  }

  /// The strongest first; mean value coordinates may be negative, weights may not.
  void store(SkinBinding& into, std::size_t element) {
    std::erase_if(sums_, [](const Sum& sum) { return !(sum.weight > 0); });
    std::sort(sums_.begin(), sums_.end(), [](const Sum& a, const Sum& b) {
      return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
    });
    if (sums_.size() > into.influences) sums_.resize(into.influences);
    double total = 0;
    for (const Sum& sum : sums_) total += sum.weight;
    const std::size_t first = element * into.influences;
    for (std::size_t i = 0; i < into.influences; ++i) {
      into.joints[first + i] = i < sums_.size() ? sums_[i].joint : 0;
      into.weights[first + i] = i < sums_.size() ? float(sums_[i].weight / total) : 0;
    }
  }

 private:
  struct Sum {
    std::uint32_t joint;
    double weight;
  };
  double& at(std::uint32_t joint) {
    for (Sum& sum : sums_) {
      if (sum.joint == joint) return sum.weight;
    }
    return sums_.emplace_back(Sum{joint, 0}).weight;
  }
  std::vector<Sum> sums_;
};

SkinBinding emptyLike(const SkinBinding& binding, std::size_t elements) {
  SkinBinding out;
  out.influences = binding.influences;
  out.jointNames = binding.jointNames;
  out.skeleton = binding.skeleton;
  out.bindFromScene = binding.bindFromScene;
  out.joints.resize(elements * out.influences);
  out.weights.resize(out.joints.size());
  return out;
}

SkinBinding skinMesh(const SkinBinding& head, const Surface& surface, const HairMesh& mesh,
                     const Context& context) {
  SkinBinding out = emptyLike(head, mesh.vertices().size());
  parallelFor(context, mesh.vertices().size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      std::size_t root = v;
      while (mesh.vertices()[root].parent != kNone) root = mesh.vertices()[root].parent;
      const SurfacePoint foot = surface.nearest(mesh.vertices()[root].position);
      Mean mean;
      if (foot.triangle != kNone) {
        const auto corners = surface.triangleVertices(foot.triangle);
        for (int i = 0; i < 3; ++i) mean.add(head, corners[std::size_t(i)], foot.barycentric[i]);
      }
      mean.store(out, v);
    }
  });
  return out;
}

/// The bundle (by index) of each strand. Error when one has none.
Result<std::vector<std::uint32_t>> bundlesOf(const HairMesh& mesh, const StrandSet& strands) {
  const Error foreign = makeError(ErrorCode::InvalidArgument,
                                  "the strands have no root faces and weights of this hair mesh to take the "
                                  "skin's binding by");
  const std::size_t count = strands.strandCount();
  if (strands.rootFaces.size() != count || strands.weightOffsets.size() != count + 1) return foreign;
  std::vector<std::uint32_t> found(count);
  const auto bundles = mesh.bundles();  // ascending by id
  for (std::size_t s = 0; s < count; ++s) {
    const auto it = std::lower_bound(
        bundles.begin(), bundles.end(), strands.rootFaces[s],
        [](const Bundle& bundle, std::uint32_t id) { return std::uint32_t(bundle.id) < id; });
    if (it == bundles.end() || std::uint32_t(it->id) != strands.rootFaces[s] ||
        strands.weightOffsets[s + 1] - strands.weightOffsets[s] != it->corners) {
      return foreign;
    }
    found[s] = std::uint32_t(it - bundles.begin());
  }
  return found;
}

}  // namespace

void makeRigidIfUniform(SkinBinding& binding) {
  const std::size_t n = binding.influences;
  for (std::size_t i = n; i < binding.joints.size(); ++i) {
    if (binding.joints[i] != binding.joints[i - n] || binding.weights[i] != binding.weights[i - n]) return;
  }
  if (binding.joints.size() <= n) return;
  binding.joints.resize(n);
  binding.weights.resize(n);
}

Result<StrandSkin> skinHair(SkinBinding head, const Surface& surface, const HairMesh& mesh,
                            const StrandSet& strands, const Context& context) {
  const std::size_t rows = head.rigid() ? 1 : surface.mesh().vertexCount();
  if (head.influences == 0 || head.joints.size() != rows * head.influences ||
      head.weights.size() != head.joints.size()) {
    return makeError(ErrorCode::InvalidArgument, "the skin's binding does not fit the head");
  }
  COIF_ASSIGN(const std::vector<std::uint32_t> bundles, bundlesOf(mesh, strands));
  StrandSkin skin;
  skin.hairMesh = skinMesh(head, surface, mesh, context);
  skin.strands = emptyLike(head, bundles.size());
  parallelFor(context, bundles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto corners = mesh.bundles()[bundles[s]].face(0);
      Mean mean;
      for (std::size_t i = 0; i < corners.size(); ++i)
        mean.add(skin.hairMesh, corners[i], double(strands.weights[strands.weightOffsets[s] + i]));
      mean.store(skin.strands, s);
    }
  });
  makeRigidIfUniform(skin.hairMesh);
  makeRigidIfUniform(skin.strands);
  skin.head = std::move(head);
  return skin;
}

}  // namespace coif
