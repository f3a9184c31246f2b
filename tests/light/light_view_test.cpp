#include "coif/light/light_view.h"

#include <gtest/gtest.h>

#include "coif/base/random.h"

namespace coif {
namespace {

Vec3 randomPoint(std::uint64_t i, const Box& box) {
  const CounterRandom random(7, i);
  const Vec3 u(random.uniform(0), random.uniform(1), random.uniform(2));
  return box.lo + u.cwiseProduct(box.hi - box.lo);
}

/// The inverse of project, written from the header's definition.
Vec3 unproject(const LightView& view, const Vec3& p) {
  const double texel = view.texelAt(p.z()), half = 0.5 * view.size;
  return view.eye + (p.x() - half) * texel * view.right + (p.y() - half) * texel * view.up +
         p.z() * view.forward;
}

const Box kBox{Vec3(-3, 1, 2), Vec3(5, 4, 12)};

class Views : public testing::TestWithParam<bool> {
 protected:
  LightView view(std::uint64_t i, int size) const {
    const Vec3 direction = randomPoint(i, {Vec3::Constant(-1), Vec3::Constant(1)});
    if (!GetParam()) return distantLightView(direction, kBox, size);
    return pointLightView(0.5 * (kBox.lo + kBox.hi) + 30 * direction.normalized(), kBox, size);
  }
};
INSTANTIATE_TEST_SUITE_P(DistantAndPoint, Views, testing::Bool());

TEST_P(Views, ProjectionIsUndoneByItsDefinition) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const LightView v = view(i, 256);
    const Vec3 p = randomPoint(i + 1000, kBox);
    // A few roundings of numbers up to 30, and the division by a depth of up to 40.
    EXPECT_LT((unproject(v, v.project(p)) - p).norm(), 1e-12);
  }
}

TEST_P(Views, FrameIsRightHandedAndTheBoxIsInsideTheMap) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const LightView v = view(i, 64);
    EXPECT_LT((v.right.cross(v.up) + v.forward).norm(), 1e-12);
    for (int c = 0; c < 8; ++c) {
      const Vec3 corner((c & 1 ? kBox.hi : kBox.lo).x(), (c & 2 ? kBox.hi : kBox.lo).y(),
                        (c & 4 ? kBox.hi : kBox.lo).z());
      const Vec3 p = v.project(corner);
      EXPECT_GE(p.head<2>().minCoeff(), 1 - 1e-3);  // one texel of margin
      EXPECT_LE(p.head<2>().maxCoeff(), v.size - 1 + 1e-3);
      EXPECT_GE(p.z(), 0);
      EXPECT_LE(p.z(), v.depthRange * (1 + 1e-9));
    }
  }
}

TEST(LightView, DepthGrowsAwayFromTheLight) {
  const LightView distant = distantLightView(Vec3(0, 5, 0), kBox, 32);
  EXPECT_LT(distant.project(Vec3(0, 4, 5)).z(), distant.project(Vec3(0, 1, 5)).z());
  const LightView point = pointLightView(Vec3(1, 50, 7), kBox, 32);
  EXPECT_NEAR(point.project(Vec3(1, 4, 7)).z(), 46, 0.5);  // along the view's axis, which leans a little
  EXPECT_GT(point.texelAt(46), point.texelAt(10));
}

TEST(LightView, PointsBehindAPointLightHaveNoPositiveDepth) {
  const LightView view = pointLightView(Vec3(0, 0, 40), kBox, 32);
  EXPECT_LE(view.project(Vec3(0, 0, 41)).z(), 0);
}

TEST(LightView, EmptyBoxGivesAUsableView) {
  for (const LightView& view :
       {distantLightView(Vec3(0, 0, 1), Box{}, 16), pointLightView(Vec3(0, 0, 3), Box{}, 16)}) {
    EXPECT_GT(view.texel, 0);
    EXPECT_TRUE(view.project(Vec3::Zero()).allFinite());
  }
}

TEST(LightView, LightInsideTheBoxLooksAtItsMiddleAtMost150Degrees) {
  const Vec3 middle = 0.5 * (kBox.lo + kBox.hi);
  const LightView view = pointLightView(middle + Vec3(0, 0, 1), kBox, 102);
  EXPECT_NEAR(std::atan(0.5 * (view.size - 2) * view.texel), 75 * 3.14159265358979 / 180, 1e-9);
  const Vec3 p = view.project(middle);
  EXPECT_NEAR(p.x(), 51, 1e-9);
  EXPECT_NEAR(p.z(), 1, 1e-12);
  const LightView atMiddle = pointLightView(middle, kBox, 16);  // looks anywhere, but is a frame
  EXPECT_LT((atMiddle.right.cross(atMiddle.up) + atMiddle.forward).norm(), 1e-12);
}

TEST(LightView, ZeroOrInfiniteDirectionFallsBackToALightAbove) {
  for (const Vec3& bad : {Vec3(0, 0, 0), Vec3(HUGE_VAL, 0, 0)}) {
    EXPECT_EQ(distantLightView(bad, kBox, 16).forward, Vec3(0, -1, 0));
  }
}

}  // namespace
}  // namespace coif
