// What holds for every stack: laziness, threads, motion, density, edits, faults.
#include "coif/style/style_plan.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

#include "coif/base/random.h"
#include "style/style_samples.h"

namespace coif {
namespace {

using namespace samples;

TEST(StylePlan, WhatCannotActIsLeftOutAndSaid) {
  const HairMesh mesh = lawn(2, 10);
  const StrandSet straight = strandsOn(mesh, 100);
  StyleStack stack{op("curl"), op("wave"), op("frizz"), op("noise"), op("push_out"), op("clump")};
  stack[0].enabled = false;
  stack[1].amount = 0;
  stack[2].ramp = {{{0, 0}, {1, 0}}, RampShape::Linear};
  stack[3].mask = {{mesh.vertices()[0].id, 0.0}};
  stack[5].group = "fringe";
  const StylePlan plan = StylePlan::create(mesh, straight, stack).value();
  EXPECT_TRUE(plan.changesNothing());
  EXPECT_EQ(plan.bytes(), 0u);
  const std::vector<std::string> reasons{
      "it is switched off",       "its amount is 0",  "its ramp is 0 from root to tip",
      "its mask is 0 everywhere", "there is no head", "there is no group 'fringe'"};
  ASSERT_EQ(plan.report().operators.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(plan.report().operators[i].leftOut, reasons[i]);
  StrandSet same = straight;
  ASSERT_TRUE(plan.apply(mesh, same).ok());
  EXPECT_EQ(same.points, straight.points);
  EXPECT_EQ(same.widths, straight.widths);
}

TEST(StylePlan, RunningIdleOperatorsChangesNoByte) {
  const HairMesh mesh = grid(3, 3, 4, 0.2);
  const StrandSet straight = strandsOn(mesh, 500);
  for (StyleOperator idle : everyKind()) {
    idle.amount = 0;
    StyleOptions options;
    options.runIdle = true;
    const StrandSet out = styled(mesh, straight, {idle}, options);
    // Moving there and back in doubles loses less than half a float's last place, so few points round anew.
    EXPECT_LT(greatestDifference(out, straight), 1e-6) << idle.kind;
    EXPECT_EQ(out.widths, straight.widths) << idle.kind;
  }
}

TEST(StylePlan, AnIdleClumpMakesNoLocksForWhatFollows) {
  const HairMesh mesh = lawn(3, 10);
  const StrandSet straight = strandsOn(mesh, 300);
  StyleStack stack{op("clump"), op("smooth"), op("curl")};
  stack[0].amount = 0;
  StyleOptions options;
  options.runIdle = true;
  const StrandSet forced = styled(mesh, straight, stack, options), lazy = styled(mesh, straight, stack);
  EXPECT_LT(greatestDifference(forced, lazy), 1e-5) << "a float's rounding between the passes";
  stack[0].amount = 1e-9;
  EXPECT_GT(greatestDifference(styled(mesh, straight, stack), lazy), 0.1) << "the least clump makes locks";
}

TEST(StylePlan, SameBytesForAnyNumberOfThreads) {
  const HairMesh mesh = grid(6, 5, 4, 0.2);
  const StrandSet straight = strandsOn(mesh, 3000);
  const StrandSet one = styled(mesh, straight, everyKind(), {}, 1);
  for (const int threads : {2, 5}) {
    const StrandSet more = styled(mesh, straight, everyKind(), {}, threads);
    EXPECT_EQ(one.points, more.points);
    EXPECT_EQ(one.widths, more.widths);
  }
}

TEST(StylePlan, EveryKindDoesSomethingAndKeepsRoots) {
  const HairMesh mesh = grid(4, 4, 4, 0.1, 2);
  const StrandSet straight = strandsOn(mesh, 1000);
  StyleStack stack = everyKind();
  for (const StyleOperator& each : stack) {
    StyleOperator acting = each;
    if (acting.kind == "cut_plane") acting.parameters = {{"point_y", 5}, {"normal_y", 1}};
    const StrandSet out = styled(mesh, straight, {acting});
    EXPECT_TRUE(out.points != straight.points || out.widths != straight.widths) << each.kind;
    for (std::size_t s = 0; s < 1000; ++s) ASSERT_EQ(out.strand(s)[0], straight.strand(s)[0]) << each.kind;
    EXPECT_TRUE(validate(out).ok()) << each.kind;
  }
}

TEST(StylePlan, ADenserSetHasTheSameFirstStrands) {
  const HairMesh mesh = grid(5, 4, 4, 0.2);
  StyleStack stack = everyKind();
  for (StyleOperator& each : stack) {
    if (each.kind == "clump" || each.kind == "braid") each.parameters["count"] = 37;
  }
  const StrandSet few = styled(mesh, strandsOn(mesh, 700), stack);
  const StrandSet many = styled(mesh, strandsOn(mesh, 1400), stack);
  ASSERT_TRUE(std::equal(few.ids.begin(), few.ids.end(), many.ids.begin()));
  EXPECT_TRUE(std::equal(few.points.begin(), few.points.end(), many.points.begin()));
  // Fewer strands than centres: each is its own, as it is in the denser set.
  const StrandSet sparse = styled(mesh, strandsOn(mesh, 20), stack);
  EXPECT_TRUE(std::equal(sparse.points.begin(), sparse.points.end(), many.points.begin()));
}

/// The mesh turned and moved.
HairMesh moved(HairMesh mesh, const Eigen::AngleAxisd& turn, const Vec3& by) {
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v)
    mesh.setPosition(v, turn * mesh.position(v) + by);
  return mesh;
}

TEST(StylePlan, RigidMotionOfTheMeshMovesTheHairRigidly) {
  const HairMesh mesh = grid(4, 4, 4, 0.2);
  const StrandSet straight = strandsOn(mesh, 500);
  const StylePlan plan = StylePlan::create(mesh, straight, everyKind()).value();
  StrandSet here = straight;
  ASSERT_TRUE(plan.apply(mesh, here).ok());
  const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, -0.5).normalized());
  const Vec3 by(3, -2, 1);
  const HairMesh there = moved(mesh, turn, by);
  StrandSet follows = strandsOn(there, 500);
  ASSERT_TRUE(plan.apply(there, follows).ok());
  double worst = 0;
  for (std::size_t p = 0; p < here.points.size(); ++p) {
    const Vec3 expected = turn * here.points[p].cast<double>() + by;
    worst = std::max(worst, (expected - follows.points[p].cast<double>()).norm());
  }
  // Floats near 8 are 1e-6 apart; their error turns frames of steps of 0.1 by 1e-5 at most.
  EXPECT_LT(worst, 5e-5);
  // Planned anew there it is the same hair, where the stack does not look at the world.
  StyleStack own;
  for (const StyleOperator& each : everyKind()) {
    if (!findStyleKind(each.kind)->looksAtWorld) own.push_back(each);
  }
  const StrandSet a = styled(mesh, straight, own), b = styled(there, strandsOn(there, 500), own);
  worst = 0;
  for (std::size_t p = 0; p < a.points.size(); ++p) {
    const Vec3 expected = turn * a.points[p].cast<double>() + by;
    worst = std::max(worst, (expected - b.points[p].cast<double>()).norm());
  }
  EXPECT_LT(worst, 2e-4) << "centres' frames are nearest ones, and arcs sum float steps";
}

TEST(StylePlan, AMovedMeshTakesTheStyleAlong) {
  // Bent as by a wind: the curl keeps its distance from the bent line, and the stack is not run again.
  const HairMesh mesh = lawn(3, 10);
  StyleOperator curl = level(op("curl", {{"radius", 0.5}, {"size_variation", 0}}));
  const StrandSet straight = strandsOn(mesh, 100, 97);
  const StylePlan plan = StylePlan::create(mesh, straight, StyleStack{curl}).value();
  HairMesh bent = mesh;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const double y = mesh.position(v).y();
    bent.setPosition(v, mesh.position(v) + Vec3(0.05 * y * y, -0.02 * y * y, 0));
  }
  const StrandSet line = strandsOn(bent, 100, 97);
  StrandSet curled = line;
  ASSERT_TRUE(plan.apply(bent, curled).ok());
  for (std::size_t p = 0; p < line.points.size(); ++p) {
    // 0.5 to the floats' rounding near 10.
    const float expected = p % 97 == 0 ? 0.0f : 0.5f;
    EXPECT_NEAR((curled.points[p] - line.points[p]).norm(), expected, 3e-6f);
  }
}

/// Every vertex above the root layer moved by up to `step` in each direction.
HairMesh edited(HairMesh mesh, double step) {
  const CounterRandom random(5);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3 by(random.uniform(3 * v), random.uniform(3 * v + 1), random.uniform(3 * v + 2));
    if (mesh.vertices()[v].layer > 0) mesh.setPosition(v, mesh.position(v) + step * by);
  }
  return mesh;
}

TEST(StylePlan, ASmallEditChangesTheStyleALittle) {
  const HairMesh mesh = grid(4, 4, 4, 0.2);
  std::vector<StyleStack> stacks;
  for (const StyleOperator& each : everyKind()) {
    stacks.push_back({each});
    if (each.kind == "cut_plane") stacks.pop_back();  // hair may meet a plane anew: that is its nature
  }
  stacks.push_back({});
  for (std::size_t i = 0; i + 1 < stacks.size(); ++i) stacks.back().push_back(stacks[i][0]);
  for (const StyleStack& stack : stacks) {
    const StrandSet before = styled(mesh, strandsOn(mesh, 800), stack);
    for (const double step : {1e-3, 1e-5}) {
      const HairMesh after = edited(mesh, step);
      // This hair stands nearly along the mean normal, where frames turn fastest: offsets of 1.5 there turn
      // by up to 160 times the edit over steps of 1. The bound is proportional: nothing jumps.
      EXPECT_LT(greatestDifference(before, styled(after, strandsOn(after, 800), stack)), 400 * step + 2e-5)
          << stack[0].kind << " of " << stack.size();
    }
  }
}

TEST(StylePlan, FramesAgreeAcrossBundles) {
  // Two strands at either side of a border curl alike.
  HairMesh mesh = lawn(4, 10);
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3 p = mesh.position(v);  // hair that leans outwards, like on a head
    mesh.setPosition(v, p + 0.3 * p.y() * Vec3(p.x() - 1.7, 0, p.z() + 2.2));
  }
  const StrandSet straight = strandsOn(mesh, 4000);
  const StrandSet curled =
      styled(mesh, straight, {level(op("curl", {{"coherence", 1000}, {"phase_variation", 0}}))});
  int pairs = 0;
  for (std::size_t a = 0; a < 4000; ++a) {
    for (std::size_t b = a + 1; b < 4000; ++b) {
      const Vec3f root = straight.strand(a)[0];
      if (straight.rootFaces[a] == straight.rootFaces[b] || (root - straight.strand(b)[0]).norm() > 0.03f)
        continue;
      const Vec3f up = straight.strand(a)[1] - root;
      if (Vec3f(up.x(), 0, up.z()).norm() < 0.2f * up.norm()) continue;  // near the whorl no field is smooth
      const Vec3f offA = curled.strand(a)[20] - straight.strand(a)[20];
      const Vec3f offB = curled.strand(b)[20] - straight.strand(b)[20];
      // Two roots 0.03 apart lean 0.009 apart where they lean by 0.2 or more: 0.05 rad, and the twist on the
      // way.
      EXPECT_LT((offA - offB).norm(), 0.15f * offA.norm());
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 20);
}

TEST(StylePlan, MasksAndGroupsSayWhere) {
  HairMesh mesh = lawn(4, 10);
  for (std::uint32_t b = 0; b < 8; ++b) mesh.setGroup(b, mesh.addGroup("front"));
  StyleOperator wave = level(op("wave"));
  wave.group = "front";
  const StrandSet straight = strandsOn(mesh, 500);
  const StrandSet grouped = styled(mesh, straight, {wave});
  for (std::size_t s = 0; s < 500; ++s)
    EXPECT_EQ(grouped.strand(s).back() != straight.strand(s).back(), straight.groups[s] == 1);
  // A mask that is the x of the root: the strand's share is its own x, whatever the face.
  StyleOperator trim = op("trim", {{"cut", 4}, {"uneven", 0}});
  for (const HairVertex& v : mesh.vertices()) {
    if (v.layer == 0) trim.mask.push_back({v.id, v.position.x() / 4});
  }
  const StrandSet trimmed = styled(mesh, straight, {trim});
  for (std::size_t s = 0; s < 500; ++s)
    EXPECT_NEAR(lengthOf(trimmed.strand(s)), 10 - straight.strand(s)[0].x(), 1e-5);
}

TEST(StyleMask, NewVerticesTakeTheirNeighboursMean) {
  const HairMesh mesh = lawn(2, 1, 1);  // 9 root vertices
  StyleMask mask;
  std::uint32_t middle = kNone;
  for (const HairVertex& v : mesh.vertices()) {
    if (v.layer > 0) continue;
    if (v.position.isApprox(Vec3(1, 0, -1))) {
      middle = mesh.indexOf(v.id);
      continue;
    }
    mask.push_back({v.id, v.position.x() / 2});
  }
  ASSERT_NE(middle, kNone);
  EXPECT_DOUBLE_EQ(maskOf(mask, mesh)[middle], 0.5);
  EXPECT_DOUBLE_EQ(maskOf({}, mesh)[middle], 1);
}

TEST(StylePlan, StrandsOfTwoPointsAndOfNoLength) {
  const HairMesh mesh = lawn(2, 10);
  StrandSet two = strandsOn(mesh, 50, 2);
  StrandSet collapsed = strandsOn(mesh, 50, 9);
  for (std::size_t s = 0; s < 50; ++s) {
    for (std::size_t p = 1; p < 9; ++p) collapsed.points[9 * s + p] = collapsed.points[9 * s];
  }
  for (const StrandSet& set : {two, collapsed}) {
    for (const StyleOperator& each : everyKind()) {
      const StrandSet out = styled(mesh, set, {each});
      EXPECT_TRUE(validate(out).ok()) << each.kind;
    }
    EXPECT_TRUE(validate(styled(mesh, set, everyKind())).ok());
  }
}

TEST(StylePlan, RefusesWhatIsNoStyle) {
  const HairMesh mesh = lawn(2, 10);
  const StrandSet straight = strandsOn(mesh, 20);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const std::function<void(StyleOperator&)>& spoil, const std::string& place) {
    StyleStack stack{op("clump"), op("curl")};
    spoil(stack[1]);
    const auto plan = StylePlan::create(mesh, straight, stack);
    ASSERT_FALSE(plan.ok()) << place;
    EXPECT_EQ(plan.error().place, place);
    EXPECT_GT(plan.error().message.size(), 10u);
  };
  refused([](auto& o) { o.kind = "perm"; }, "[1].kind");
  refused([](auto& o) { o.name = "Clump"; }, "[1].name");
  refused([](auto& o) { o.name = ""; }, "[1].name");
  refused([&](auto& o) { o.amount = nan; }, "[1].amount");
  refused([&](auto& o) { o.amount = 1.5; }, "[1].amount");
  refused([&](auto& o) { o.parameters["radius"] = nan; }, "[1].parameters.radius");
  refused([&](auto& o) { o.parameters["radius"] = 1e9; }, "[1].parameters.radius");
  refused([&](auto& o) { o.parameters["wavelength"] = 0; }, "[1].parameters.wavelength");
  refused([&](auto& o) { o.parameters["hand"] = 0.5; }, "[1].parameters.hand");
  refused([&](auto& o) { o.parameters["bounce"] = 1; }, "[1].parameters.bounce");
  refused([&](auto& o) { o.ramp.points = {}; }, "[1].ramp");
  refused([&](auto& o) { o.mask = {{VertexId(2), 1}, {VertexId(1), 1}}; }, "[1].mask");
  refused([&](auto& o) { o.mask = {{VertexId(2), nan}}; }, "[1].mask");
  // Strands that do not say where they grow, of another mesh, or changed since.
  StrandSet bare = straight;
  bare.ids.clear();
  EXPECT_FALSE(StylePlan::create(mesh, bare, everyKind()).ok());
  EXPECT_FALSE(StylePlan::create(lawn(1, 10), straight, everyKind()).ok());
  const StylePlan plan = StylePlan::create(mesh, straight, everyKind()).value();
  StrandSet other = strandsOn(mesh, 21);
  EXPECT_EQ(plan.apply(mesh, other).error().code, ErrorCode::InvalidArgument);
}

TEST(StylePlan, ExtremeParametersStayFinite) {
  const HairMesh mesh = grid(2, 2, 4, 0.2);
  const StrandSet straight = strandsOn(mesh, 60);
  for (const StyleKind& kind : styleKinds()) {
    if (kind.needsHead) continue;
    for (const bool most : {false, true}) {
      StyleOperator extreme = makeStyleOperator(kind.name).value();
      for (const StyleParameter& p : kind.parameters)
        ASSERT_TRUE(setParameter(extreme, p.name, most ? p.most : p.least).ok()) << p.name;
      StrandSet out = straight;
      const auto report = applyStyle(mesh, out, StyleStack{extreme});
      if (report.ok()) {
        EXPECT_TRUE(validate(out).ok()) << kind.name;
      } else {
        EXPECT_EQ(report.error().code, ErrorCode::Degenerate) << kind.name;
      }
    }
  }
}

TEST(StylePlan, CanBeCancelled) {
  const HairMesh mesh = lawn(2, 10);
  const StrandSet straight = strandsOn(mesh, 500);
  std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const auto plan = StylePlan::create(mesh, straight, everyKind(), {}, context);
  ASSERT_FALSE(plan.ok());
  EXPECT_EQ(plan.error().code, ErrorCode::Cancelled);
}

TEST(PointsWanted, CountsTheShortestWaveOnTheLongestHair) {
  const HairMesh mesh = lawn(2, 12);
  EXPECT_EQ(pointsWanted(StyleStack{op("clump"), op("droop")}, mesh, 0.01), 0u);
  StyleStack stack{op("wave", {{"wavelength", 6}}), op("curl", {{"wavelength", 3}})};
  EXPECT_EQ(pointsWanted(stack, mesh, 0.01), 41u) << "4 turns of 10 points, and the end";
  stack[1].enabled = false;
  EXPECT_EQ(pointsWanted(stack, mesh, 0.01), 17u);
}

TEST(StyleKinds, SayEverythingAPanelNeeds) {
  std::set<std::string> names;
  for (const StyleKind& kind : styleKinds()) {
    EXPECT_TRUE(names.insert(kind.name).second);
    EXPECT_FALSE(kind.label.empty() || kind.help.empty()) << kind.name;
    EXPECT_TRUE(validate(kind.ramp).ok()) << kind.name;
    std::set<std::string> own;
    for (const StyleParameter& p : kind.parameters) {
      const std::string where = kind.name + "." + p.name;
      EXPECT_TRUE(own.insert(p.name).second) << where;
      EXPECT_FALSE(p.label.empty() || p.help.empty()) << where;
      EXPECT_TRUE(p.least <= p.standard && p.standard <= p.usual && p.usual <= p.most) << where;
      EXPECT_EQ(p.kind == ParameterKind::Choice, !p.choices.empty()) << where;
    }
    EXPECT_EQ(kind.pointsPerWave > 0, own.contains("wavelength")) << kind.name;
  }
  for (const char* wanted : {"curl", "wave", "noise", "frizz", "clump", "length", "trim", "cut_plane",
                             "width", "flyaways", "droop", "smooth", "push_out", "braid"})
    EXPECT_TRUE(names.contains(wanted)) << wanted;
}

TEST(StyleKinds, ParametersReadText) {
  StyleOperator curl = op("curl");
  ASSERT_TRUE(setParameter(curl, "hand", "left").ok());
  ASSERT_TRUE(setParameter(curl, "keep_length", "on").ok());
  ASSERT_TRUE(setParameter(curl, "radius", "1.25").ok());
  EXPECT_EQ(parameterOf(curl, "hand"), 1);
  EXPECT_EQ(parameterOf(curl, "keep_length"), 1);
  EXPECT_EQ(parameterOf(curl, "radius"), 1.25);
  EXPECT_EQ(setParameter(curl, "radius", "1.25x").error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(setParameter(curl, "radius", "nan").error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(setParameter(curl, "hand", "1").error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(setParameter(curl, "turns", "1").error().code, ErrorCode::NotFound);
  EXPECT_EQ(freeName(StyleStack{op("curl"), op("clump")}, "Curl"), "Curl 2");
}

}  // namespace
}  // namespace coif
