// What the head's own frame shows is what the scene's shows of a moved head.
#include "coif/scene/seen_from_head.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace coif {
namespace {

constexpr double kRounding = 1e-12;  // some operations on values of about one

RigidPose somePose() {
  return {Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix(), Vec3(0.3, -0.7, 1.1)};
}

TEST(SeenFromHead, KeepsEveryDistanceAndAngleToTheHead) {
  const RigidPose pose = somePose();
  const Vec3 onHead(0.2, 0.4, -0.1), inWorld = pose.world(onHead);
  Camera camera;
  camera.eye = Vec3(1, 2, 5), camera.target = Vec3(0.1, 0.2, 0.3), camera.up = Vec3(0.1, 1, 0);
  const Camera seen = cameraFromHead(camera, pose);
  EXPECT_NEAR((seen.eye - onHead).norm(), (camera.eye - inWorld).norm(), kRounding);
  EXPECT_NEAR((seen.target - seen.eye).dot(onHead - seen.eye),
              (camera.target - camera.eye).dot(inWorld - camera.eye), kRounding);
  EXPECT_NEAR(seen.up.dot(onHead - seen.eye), camera.up.dot(inWorld - camera.eye), kRounding);
  EXPECT_EQ(seen.fovDeg, camera.fovDeg);
  const Ground ground{Vec3(0, -1, 0), Vec3(0.1, 1, 0.2), 3, Vec3f::Constant(0.2f)};
  const Ground below = groundFromHead(ground, pose);
  EXPECT_NEAR(below.normal.dot(onHead - below.point), ground.normal.dot(inWorld - ground.point), kRounding);
  EXPECT_EQ(below.radius, ground.radius);
}

TEST(SeenFromHead, TurnsLightsOfTheSceneAloneAndCarriesTheHeadBack) {
  const RigidPose pose = somePose();
  Lights lights;
  EXPECT_EQ(lightsFromHead(lights, pose).key.direction, lights.key.direction) << "they follow the camera";
  lights.followCamera = false;
  const Lights seen = lightsFromHead(lights, pose);
  for (const auto light : {&Lights::key, &Lights::fill, &Lights::rim}) {
    EXPECT_GT(((seen.*light).direction - (lights.*light).direction).norm(), 0.1);
    EXPECT_NEAR((pose.rotation * (seen.*light).direction - (lights.*light).direction).norm(), 0, kRounding);
  }
  PolygonMesh head;
  head.positions = {Vec3(1, 0, 0), Vec3(0, 2, 0)};
  const PolygonMesh moved = headInWorld(head, pose);
  for (std::size_t v = 0; v < 2; ++v)
    EXPECT_NEAR((pose.local(moved.positions[v]) - head.positions[v]).norm(), 0, kRounding);
}

}  // namespace
}  // namespace coif
