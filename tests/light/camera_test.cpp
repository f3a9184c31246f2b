#include "coif/light/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coif {
namespace {

TEST(CameraFraming, SeesTheWholeBoxFromEverywhere) {
  const Box box{Vec3(-1, 3, -2), Vec3(4, 4, 7)};
  constexpr double kAspect = 1.5;
  for (const UpAxis axis : {UpAxis::Y, UpAxis::Z}) {
    for (double azimuth = -180; azimuth < 180; azimuth += 25) {
      for (const double elevation : {-80.0, 0.0, 40.0, 90.0}) {
        const auto frame = frameOf(frameBox(box, axis, azimuth, elevation, kAspect));
        ASSERT_TRUE(frame.ok());
        double reach = 0;
        for (int c = 0; c < 8; ++c) {
          const Vec3 p = Vec3(c & 1 ? 4 : -1, c & 2 ? 4 : 3, c & 4 ? 7 : -2) - frame->eye;
          const double depth = p.dot(frame->forward);
          EXPECT_GT(depth, 0);
          reach = std::max({reach, std::abs(p.dot(frame->up)) / (depth * frame->slopeY),
                            std::abs(p.dot(frame->right)) / (depth * frame->slopeY * kAspect)});
        }
        EXPECT_NEAR(reach, 1 / 1.06, 1e-9);  // the margin
      }
    }
  }
  const Camera front = frameBox(box, UpAxis::Z, 0, 0), side = frameBox(box, UpAxis::Y, 90, 0);
  EXPECT_LT(front.eye.y(), -10);
  EXPECT_GT(side.eye.x(), 10);
}

TEST(CameraFrame, IsRightHandedAndLooksAtTheTarget) {
  const auto frame = frameOf(Camera{Vec3(1, 2, 3), Vec3(-4, 0, 1), Vec3(0.1, 1, 0.2), 90});
  ASSERT_TRUE(frame.ok());
  EXPECT_LT((frame->right.cross(frame->up) + frame->forward).norm(), 1e-12);
  EXPECT_LT((frame->forward - Vec3(-5, -2, -2).normalized()).norm(), 1e-12);
  EXPECT_GT(frame->up.dot(Vec3(0.1, 1, 0.2)), 0);
  EXPECT_NEAR(frame->slopeY, 1, 1e-12);
}

TEST(CameraFrame, RefusesWhatSpansNoPlane) {
  const Vec3 up = Vec3::UnitY();
  EXPECT_FALSE(frameOf(Camera{Vec3(0, 0, 1), Vec3(0, 0, 1), up, 30}).ok());
  EXPECT_FALSE(frameOf(Camera{Vec3(0, 1, 0), Vec3(0, 0, 0), up, 30}).ok());
  EXPECT_FALSE(frameOf(Camera{Vec3(0, 0, NAN), Vec3(0, 0, 0), up, 30}).ok());
  for (const double fov : {0.0, -10.0, 179.0, double(NAN)}) {
    EXPECT_FALSE(frameOf(Camera{Vec3(0, 0, 1), Vec3(0, 0, 0), up, fov}).ok()) << fov;
  }
}

}  // namespace
}  // namespace coif
