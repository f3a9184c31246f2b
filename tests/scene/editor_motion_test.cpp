// Motion in the editor: settings as steps, draping, commands in two halves, heads that move by themselves.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "coif/scene/editor.h"
#include "coif/scene/head_motion.h"
#include "scene/sample_scene.h"

namespace coif {
namespace {

TEST(EditorMotion, SettingsAreAStepAndSurviveUndo) {
  Editor editor(test::sampleScene());
  const auto before = editor.canonicalState();
  ASSERT_TRUE(editor.run("set_dynamics", {{"droop", 0.7}, {"wind", std::string("gusts")}}).ok());
  EXPECT_EQ(editor.scene().dynamics.droop, 0.7);
  EXPECT_EQ(editor.scene().dynamics.wind, WindKind::Gusts);
  ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.canonicalState(), before);
  EXPECT_EQ(editor.scene().dynamics, test::sampleScene().dynamics);
}

TEST(EditorMotion, DrapingSinksAndIsOneStep) {
  Scene scene = test::sampleScene();
  Editor editor(scene);
  const auto before = editor.canonicalState();
  const int up = scene.upAxis == UpAxis::Y ? 1 : 2;
  const auto height = [&] {
    double sum = 0;
    for (const HairVertex& v : editor.mesh().vertices()) sum += v.position[up];
    return sum;
  };
  const double start = height();
  ASSERT_TRUE(editor.run("set_dynamics", {{"droop", 5.0}}).ok());
  const Status draped = editor.run("drape", {{"seconds", 1.0}});
  ASSERT_TRUE(draped.ok()) << draped.error().text();
  EXPECT_LT(height(), start);
  EXPECT_EQ(editor.undoCount(), 2u);
  for (std::size_t v = 0; v < scene.hairMesh.vertices().size(); ++v) {
    if (scene.hairMesh.vertices()[v].layer > 0) continue;
    EXPECT_EQ(editor.mesh().vertices()[v].position, scene.hairMesh.vertices()[v].position);
  }
  ASSERT_TRUE(editor.run("undo").ok());
  ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.canonicalState(), before);
}

TEST(EditorMotion, ACancelledCommandChangesNothing) {
  Editor editor(test::sampleScene());
  const auto before = editor.canonicalState();
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  EXPECT_EQ(editor.run("drape", {}, context).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(editor.canonicalState(), before);
}

TEST(EditorMotion, WhatWasPreparedForAnotherRevisionIsRefused) {
  Editor editor(test::sampleScene());
  ASSERT_TRUE(editor.run("select_all").ok());
  auto early = editor.prepare("translate", {{"by", Vec3(1, 0, 0)}});
  auto late = editor.prepare("translate", {{"by", Vec3(0, 1, 0)}});
  ASSERT_TRUE(early.ok() && late.ok());
  ASSERT_TRUE(editor.commit(std::move(*early)).ok());
  const auto after = editor.canonicalState();
  EXPECT_EQ(editor.commit(std::move(*late)).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(editor.canonicalState(), after);
}

TEST(HeadPoses, StartAtRestAndKeepTheirPivot) {
  const Scene scene = test::sampleScene();
  for (const HeadMove move : {HeadMove::Shake, HeadMove::Nod, HeadMove::Turn}) {
    const auto poses = headPoses({move, 30, 2}, scene.hairMesh, scene.upAxis, 100, 24);
    ASSERT_TRUE(poses.ok());
    EXPECT_EQ(poses->front(), RigidPose{});
    double greatest = 0;
    for (const RigidPose& pose : *poses) {
      // A rotation's trace is 1 + 2 cos of its angle.
      greatest = std::max(greatest, std::acos(std::clamp((pose.rotation.trace() - 1) / 2, -1.0, 1.0)));
      EXPECT_LT((pose.rotation * pose.rotation.transpose() - Mat3::Identity()).norm(), 1e-12);
    }
    // 24 / 2 frames a period hit the sine's peak at every third frame.
    if (move != HeadMove::Turn) {
      EXPECT_NEAR(greatest, 30 * std::numbers::pi / 180, 1e-9);
    }
    // The first step is small beside the fastest: the head does not jump off.
    EXPECT_LT(((*poses)[1].rotation - Mat3::Identity()).norm(), 0.1);
  }
  EXPECT_EQ(headPoses({HeadMove::Shake, 30, 0}, scene.hairMesh, scene.upAxis, 2, 24).error().code,
            ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace coif
