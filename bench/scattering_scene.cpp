#include "bench/scattering_scene.h"

#include <cmath>
#include <numbers>

#include "coif/base/random.h"
#include "coif/scalp/example_head.h"
#include "coif/scene/hairstyle.h"
#include "coif/strands/grow.h"

namespace coif {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

void addFibre(StrandSet& strands, const Vec3& from, const Vec3& to, double width) {
  strands.points.push_back(from.cast<float>());
  strands.points.push_back(to.cast<float>());
  strands.widths.insert(strands.widths.end(), 2, float(width));
  strands.offsets.push_back(strands.points.size());
}

}  // namespace

Lights oneLight(const Vec3& toLight, double irradiance) {
  Lights lights;
  lights.followCamera = false;
  lights.key = {toLight, Vec3f::Constant(float(irradiance))};
  lights.fill.color = lights.rim.color = lights.skyColor = lights.groundColor = Vec3f::Zero();
  return lights;
}

ScatteringScene clusterScene(int side, double aroundDeg, double alongDeg, std::uint64_t seed) {
  ScatteringScene scene;
  scene.name = "cluster";
  const double cell = 1.0 / side, radius = cell / 4, tilt = std::tan(2 * kDegree);
  for (int i = 0; i < side * side; ++i) {
    const CounterRandom random(seed, std::uint64_t(i));
    const auto shaken = [&](int at, std::uint64_t k) {
      return (at + 0.5 + 0.5 * (random.uniform(k) - 0.5)) * cell - 0.5;
    };
    const Vec3 middle(0, shaken(i % side, 0), shaken(i / side, 1));
    const Vec3 lean(0.5, tilt * (random.uniform(2) - 0.5), tilt * (random.uniform(3) - 0.5));
    addFibre(scene.strands, middle - lean, middle + lean, 2 * radius);
  }
  scene.camera.eye = Vec3(0, 1.2, 4.5);
  scene.camera.fovDeg = 18;
  // From the viewer, turned about the fibres (upwards), then along them.
  const double around = aroundDeg * kDegree, along = alongDeg * kDegree;
  const Vec3 toLight(std::sin(along), std::cos(along) * std::sin(around), std::cos(along) * std::cos(around));
  scene.lights = oneLight(toLight, 4);
  return scene;
}

ScatteringScene styledScene(const std::string& name, std::size_t hairs, const BenchOptions& options,
                            std::uint32_t strandPoints) {
  ScatteringScene scene;
  scene.name = name;
  scene.head = makeExampleHead();
  const Surface head(scene.head);
  const Region region = require(automaticCap(head));
  CageOptions caging;
  caging.count = int(suggestedCageCount(name));
  const Cage cage = require(buildCage(head.mesh(), head, region, caging));
  const Hairstyle style = require(modelHairstyle(name, cage, head, options.context));
  GrowOptions growing;
  growing.count = hairs;
  growing.points = strandPoints;
  growing.seed = options.seed;
  growing.head = &head;
  // 0.08 mm at 100 000 hairs on a head 23 cm high.
  growing.width = 0.08e-3 / 0.23 * cage.frame.height * 100000.0 / double(hairs);
  scene.strands = require(grow(style.mesh, growing, options.context)).strands;
  std::vector<Vec3> points;
  for (const Vec3f& p : scene.strands.points) points.push_back(p.cast<double>());
  scene.camera = frameBox(bounds(points), scene.strands.upAxis, style.showFromDeg, 8);
  scene.lights = oneLight(Vec3::UnitZ(), 4);
  scene.lights.followCamera = true;
  scene.lights.key.direction = Vec3(-0.55, 0.65, 0.62);
  scene.lights.rim = {Vec3(0.55, 0.55, -0.8), Vec3f::Constant(3)};
  scene.size = 96;
  return scene;
}

}  // namespace coif
