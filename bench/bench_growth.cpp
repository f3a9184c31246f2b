#include "bench/bench_growth.h"

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "bench/place_problem.h"
#include "coif/strands/grow.h"

namespace coif {

namespace {

/// "VmRSS" or "VmHWM" of this process in bytes; 0 where the system does not say.
double memoryLine(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.compare(0, name.size(), name) == 0) return 1024 * std::stod(line.substr(name.size() + 1));
  }
  return 0;
}

/// Lowers the high-water mark to what is in use now.
void resetPeak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

GrowResult growHair(const HairMesh& mesh, std::size_t count, const BenchOptions& options) {
  GrowOptions growing;
  growing.count = count;
  growing.points = 32;
  growing.seed = options.seed;
  return require(grow(mesh, growing, options.context));
}

}  // namespace

std::vector<BenchFigure> growthFigures(const BenchOptions& options) {
  // About the hair mesh of a hairstyle: 196 quads, six layers.
  const HairMesh mesh = placeProblemMesh({14, 6, PlaceKind::Uniform}, options.seed);
  const std::size_t few = options.quick ? 20000 : 100000, many = options.quick ? 200000 : 1000000;
  std::vector<BenchFigure> figures;
  resetPeak();
  const double before = memoryLine("VmRSS:");
  const GrowResult grown = growHair(mesh, many, options);
  const double peak = memoryLine("VmHWM:") - before;
  if (peak > 0) {
    figures.push_back({"peak memory of growing " + std::to_string(many) + " strands / the strands' own bytes",
                       peak / double(grown.strands.bytes()), "", Bar::AtMost, 1.2});
  }

  const double growing = fastestSeconds([&] { growHair(mesh, few, options); });
  const double filling = fastestSeconds([&] { std::vector<Vec3f> points(few * 32, Vec3f(1, 2, 3)); });
  const double fillingAll = fastestSeconds([&] {
    std::vector<Vec3f> points(few * 32, Vec3f(1, 2, 3));
    std::vector<float> widths(few * 32, 1.0f);
  });
  const std::string what = std::to_string(few) + " strands of 32 points";
  // Few strands cost less than waking the threads: the bar is for a whole head of hair.
  figures.push_back({"growing " + what + " / filling a new buffer of the points", growing / filling, "",
                     options.quick ? Bar::None : Bar::AtMost, 3});
  figures.push_back(
      {"growing " + what + " / filling new buffers of points and widths", growing / fillingAll, ""});
  return figures;
}

}  // namespace coif
