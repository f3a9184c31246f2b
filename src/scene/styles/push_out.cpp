#include "scene/styles/push_out.h"

#include <algorithm>

#include "coif/base/parallel.h"

namespace coif::styles {

namespace {

/// The mean of some vertices: a point that a strand passes near.
using Sample = std::vector<std::uint32_t>;

std::vector<Sample> samplesOf(const HairMesh& mesh) {
  std::vector<Sample> samples;
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t layer = 1; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer), below = bundle.face(layer - 1);
      Sample prism(face.begin(), face.end());
      samples.push_back(prism);
      prism.insert(prism.end(), below.begin(), below.end());
      samples.push_back(std::move(prism));
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const std::uint32_t j = (i + 1) % bundle.corners;
        samples.push_back({face[i], below[i]});
        samples.push_back({face[i], face[j]});
        samples.push_back({face[i], face[j], below[i], below[j]});
      }
    }
  }
  return samples;
}

}  // namespace

void pushOut(const HairMesh& mesh, std::vector<Vec3>& targets, const Surface& head, const HeadSpace& space,
             double margin, const Context& context) {
  constexpr int kRounds = 8;
  // Head heights: farther spoils the shape more than a few points inside do.
  constexpr double kFarthest = 0.06;
  const auto samples = samplesOf(mesh);
  std::vector<Vec3> pushes(samples.size());
  const std::vector<Vec3> wanted = targets;
  for (int round = 0; round < kRounds && !context.cancelled(); ++round) {
    parallelFor(context, samples.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        Vec3 middle = Vec3::Zero();
        bool atRoot = false;
        for (std::uint32_t v : samples[s]) {
          middle += targets[v] / double(samples[s].size());
          atRoot = atRoot || mesh.vertices()[v].layer == 0;
        }
        Vec3 away;
        const double distance = clearanceOf(head, space, space.fromScene(middle), away);
        const double least = atRoot ? 0.5 * margin : margin;
        pushes[s] = distance < least ? Vec3(space.height * (least - distance) * space.directionToScene(away))
                                     : Vec3(Vec3::Zero());
      }
    });
    // As far as the greatest push that a vertex is part of, in the mean direction of all: the same on both
    // sides of the head, and whatever the order of the samples.
    std::vector<Vec3> sums(targets.size(), Vec3::Zero());
    std::vector<double> greatest(targets.size(), 0);
    bool moved = false;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      if (pushes[s].squaredNorm() == 0) continue;
      for (std::uint32_t v : samples[s]) {
        if (mesh.vertices()[v].layer == 0) continue;
        sums[v] += pushes[s];
        greatest[v] = std::max(greatest[v], pushes[s].norm());
      }
      moved = true;
    }
    if (!moved) return;
    for (std::size_t v = 0; v < targets.size(); ++v) {
      if (greatest[v] == 0) continue;
      const Vec3 total = targets[v] + greatest[v] * sums[v].stableNormalized() - wanted[v];
      targets[v] =
          wanted[v] + total * std::min(1.0, kFarthest * space.height / std::max(total.norm(), 1e-300));
    }
  }
}

}  // namespace coif::styles
