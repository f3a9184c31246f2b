// What a session made of strands, against what they are.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coif/preview/session.h"

namespace coif::testing {

inline double boxSize(const StrandSet& strands) {
  Vec3f lo = strands.points[0], hi = lo;
  for (const Vec3f& p : strands.points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  return double((hi - lo).norm());
}

/// Greatest distance between the strands of the picture at full detail and those of `truth`, matched by lock.
inline double worstDifference(PreviewSession& session, const HairMesh& mesh, const StrandSet& truth) {
  PreviewOptions options;
  options.width = options.height = 32;
  options.subframes = 1;
  options.shadows = options.lod = false;
  Camera camera = frameBox({Vec3::Constant(-3), Vec3::Constant(3)}, UpAxis::Y, 0, 0);
  session.setCamera(camera);
  const auto picture = session.render(options);
  EXPECT_TRUE(picture.ok()) << (picture.ok() ? "" : picture.error().text());
  if (!picture.ok()) return INFINITY;
  const StrandSet made = session.readBack().value();
  EXPECT_EQ(made.pointCount(), truth.pointCount());
  std::vector<std::size_t> order(truth.strandCount());
  for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return mesh.indexOf(BundleId(truth.rootFaces[a])) < mesh.indexOf(BundleId(truth.rootFaces[b]));
  });
  double worst = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto expected = truth.strand(order[i]), strand = made.strand(i);
    if (expected.size() != strand.size()) return INFINITY;
    for (std::size_t p = 0; p < expected.size(); ++p) {
      worst = std::max(worst, double((expected[p] - strand[p]).norm()));
      const float width = truth.widths[truth.offsets[order[i]] + p];
      EXPECT_NEAR(made.widths[made.offsets[i] + p], width,
                  1e-6f * width + 1e-9f);  // a few units of the last place
    }
  }
  return worst;
}

// The bar, 1e-5 of the bounding box. The sums are float of numbers as large as the box: some 1e-6.
inline constexpr double kAgreement = 1e-5;

}  // namespace coif::testing
