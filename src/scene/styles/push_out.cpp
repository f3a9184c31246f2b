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
    // Each vertex takes the greatest push that it is part of; the order of samples is fixed, so is the
    // result.
    std::vector<Vec3> moves(targets.size(), Vec3::Zero());
    bool moved = false;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      if (pushes[s].squaredNorm() == 0) continue;
      for (std::uint32_t v : samples[s]) {
        if (mesh.vertices()[v].layer > 0 && pushes[s].squaredNorm() > moves[v].squaredNorm())
          moves[v] = pushes[s];
      }
      moved = true;
    }
    if (!moved) return;
    for (std::size_t v = 0; v < targets.size(); ++v) {
      const Vec3 total = targets[v] + moves[v] - wanted[v];
      targets[v] =
          wanted[v] + total * std::min(1.0, kFarthest * space.height / std::max(total.norm(), 1e-300));
    }
  }
}

}  // namespace coif::styles
