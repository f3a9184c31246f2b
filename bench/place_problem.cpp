#include "bench/place_problem.h"

#include "bench/bench.h"
#include "coif/base/random.h"
#include "coif/hairmesh/operations.h"

namespace coif {

namespace {

HairMesh squareRoot(std::uint32_t side) {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::uint32_t y = 0; y <= side; ++y) {
    for (std::uint32_t x = 0; x <= side; ++x) positions.emplace_back(double(x) / side, double(y) / side, 0);
  }
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t v = y * (side + 1) + x;
      corners.insert(corners.end(), {v, v + 1, v + side + 2, v + side + 1});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  return require(HairMesh::fromRoot(positions, offsets, corners));
}

}  // namespace

std::string PlaceProblem::name() const {
  static constexpr const char* kNames[] = {"uniform", "mixed", "split"};
  return "place-" + std::to_string(side) + "x" + std::to_string(side) + "x" + std::to_string(height) + "-" +
         kNames[int(kind)];
}

std::string PlaceProblem::title() const {
  static constexpr const char* kTitles[] = {"heights uniform", "heights mixed", "heights mixed, split"};
  return std::to_string(side) + "\xc2\xb2 root quads \xc3\x97 " + std::to_string(height) + " layers, " +
         kTitles[int(kind)];
}

HairMesh placeProblemMesh(const PlaceProblem& p, std::uint64_t seed) {
  HairMesh mesh = squareRoot(p.side);
  const CounterRandom random(seed, p.side);
  const auto heightOf = [&](std::uint32_t f) {
    if (p.kind == PlaceKind::Uniform) return p.height;
    const std::uint32_t patch = f % p.side * 5 / p.side + 5 * (f / p.side * 5 / p.side),
                        half = (p.height + 1) / 2;
    return half + random.below(patch, p.height - half + 1);
  };
  for (std::uint32_t k = 1; k <= p.height; ++k) {
    const std::uint32_t strips = p.kind == PlaceKind::MixedAndSplit && k > p.height / 2 ? 4 : 1;
    for (std::uint32_t strip = 0; strip < strips; ++strip) {
      std::vector<BundleId> grown;
      for (std::uint32_t f = 0; f < p.side * p.side; ++f) {
        if (heightOf(f) >= k && f % p.side * strips / p.side == strip) grown.push_back(BundleId(f));
      }
      ExtrudeOptions up;
      up.direction = Vec3(0, 0, 1.0 / p.height);
      if (!grown.empty()) (void)require(extrudeFaces(mesh, grown, up));
    }
  }
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].layer == 0) continue;
    const CounterRandom shake = random.child(v);
    const Vec3 offset(shake.uniform(0) - 0.5, shake.uniform(1) - 0.5, shake.uniform(2) - 0.5);
    mesh.setPosition(v, mesh.position(v) + 0.5 * offset);
  }
  return mesh;
}

}  // namespace coif
