// Strands and fragments for the tests of the light room.
#pragma once

#include <vector>

#include "coif/base/random.h"
#include "coif/light/fragments.h"

namespace coif {

inline void addStrand(StrandSet& set, const std::vector<Vec3f>& points, float width) {
  set.points.insert(set.points.end(), points.begin(), points.end());
  set.widths.resize(set.points.size(), width);
  set.offsets.push_back(set.points.size());
}

/// Wavy strands through the cube [0, 1]³, mostly across z; a pure function of its arguments.
inline StrandSet wavyStrands(std::size_t count, float width, std::uint64_t seed = 1, int points = 9) {
  StrandSet set;
  for (std::size_t s = 0; s < count; ++s) {
    const CounterRandom random(seed, s);
    const Vec3 from(random.uniform(0), random.uniform(1), random.uniform(2));
    const Vec3 to(random.uniform(3), random.uniform(4), random.uniform(5));
    std::vector<Vec3f> strand;
    for (int i = 0; i < points; ++i) {
      const double t = double(i) / (points - 1);
      const Vec3 wave(0.02 * std::sin(9 * t + from.x()), 0.02 * std::cos(7 * t), 0.01 * std::sin(5 * t));
      strand.push_back((from + t * (to - from) + wave).cwiseMax(0.0).cwiseMin(1.0).cast<float>());
    }
    addStrand(set, strand, width);
  }
  return set;
}

/// Looks down −z on [0, 1]² × [0, 1]: texel (i, j) covers [i, i + 1) / size, depth is 1 − z.
inline LightView squareView(int size) {
  LightView view;
  view.eye = Vec3(0.5, 0.5, 1);
  view.texel = 1.0 / size;
  view.depthRange = 1;
  view.size = size;
  return view;
}

/// One strand that crosses the middle of the square map's texel in x, at the given depth.
inline void addAcross(StrandSet& set, const LightView& view, int x, int y, double depth, double alpha) {
  const double h = view.texel, width = alpha * h;
  const float z = float(1 - depth), cy = float((y + 0.5) * h);
  addStrand(set, {Vec3f(float((x + 0.01) * h), cy, z), Vec3f(float((x + 0.99) * h), cy, z)}, float(width));
}

inline std::vector<Fragment> collect(const FragmentStream& stream) {
  std::vector<Fragment> out;
  for (int band = 0; band < stream.bandCount(); ++band) {
    stream.forBand(band, [&](const Fragment& f) { out.push_back(f); });
  }
  return out;
}

}  // namespace coif
