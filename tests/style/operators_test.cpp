// What each kind does, against the answer on straight hair.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "style/style_samples.h"

namespace coif {
namespace {

using namespace samples;

constexpr double kTurn = 2 * std::numbers::pi;

StyleOperator plainCurl(double radius, double wavelength, double hand = 0) {
  return level(op("curl", {{"radius", radius},
                           {"wavelength", wavelength},
                           {"size_variation", 0},
                           {"wavelength_variation", 0},
                           {"phase_variation", 0},
                           {"hand", hand}}));
}

TEST(Curl, IsAHelixOfRadiusPitchAndHand) {
  const HairMesh mesh = lawn(2, 12);
  const StrandSet straight = strandsOn(mesh, 20, 241);
  for (const double hand : {0.0, 1.0}) {
    const StrandSet curled = styled(mesh, straight, {plainCurl(0.75, 3, hand)});
    for (std::size_t s = 0; s < curled.strandCount(); ++s) {
      const auto was = straight.strand(s), now = curled.strand(s);
      EXPECT_EQ(now[0], was[0]) << "the root stays on the head";
      double turned = 0;
      for (std::size_t p = 1; p < now.size(); ++p) {
        const Vec3 off = (now[p] - was[p]).cast<double>();
        // Floats near 12 hold 1e-6.
        EXPECT_NEAR(off.norm(), 0.75, 3e-6);
        EXPECT_NEAR(off.y(), 0, 3e-6);
        if (p == 1) continue;
        const Vec3 before = (now[p - 1] - was[p - 1]).cast<double>();
        turned += std::atan2(before.cross(off).y(), before.dot(off));
      }
      // From the first point after the root to the tip; right-handed about the way up, or left-handed.
      EXPECT_NEAR(turned, (hand == 0 ? 1 : -1) * kTurn * (12 - 12.0 / 240) / 3, 1e-3);
    }
  }
}

TEST(Curl, LengthIsTheHelixsOrKept) {
  const HairMesh mesh = lawn(1, 12);
  const StrandSet straight = strandsOn(mesh, 4, 1201);
  StyleOperator curl = plainCurl(0.5, 2);
  const double stretch = std::hypot(1, kTurn * 0.5 / 2);
  // The root's own step is the way to the helix, one radius aside; 100 chords a turn are 1.6e-4 short.
  for (const auto& [keep, expected] : {std::pair(0.0, 12 * stretch), std::pair(1.0, 12.0)}) {
    ASSERT_TRUE(setParameter(curl, "keep_length", keep).ok());
    const StrandSet curled = styled(mesh, straight, {curl});
    for (std::size_t s = 0; s < curled.strandCount(); ++s)
      EXPECT_NEAR(lengthOf(curled.strand(s)), expected, 0.5 + 1e-3 * expected);
  }
}

TEST(Wave, IsASineInItsDirection) {
  const HairMesh mesh = lawn(1, 8);
  const StrandSet straight = strandsOn(mesh, 5, 65);
  std::vector<Vec3> sideways;
  for (const double direction : {0.0, 90.0}) {
    const StrandSet waved = styled(mesh, straight,
                                   {level(op("wave", {{"height", 0.5},
                                                      {"wavelength", 4},
                                                      {"size_variation", 0},
                                                      {"wavelength_variation", 0},
                                                      {"phase_variation", 0},
                                                      {"direction", direction}}))});
    for (std::size_t s = 0; s < waved.strandCount(); ++s) {
      const Vec3 axis = (waved.strand(s)[8] - straight.strand(s)[8]).cast<double>().normalized();  // a crest
      if (s == 0) sideways.push_back(axis);
      for (std::size_t p = 0; p < 65; ++p) {
        const Vec3 off = (waved.strand(s)[p] - straight.strand(s)[p]).cast<double>();
        EXPECT_NEAR(off.dot(axis), 0.5 * std::sin(kTurn * (8.0 * double(p) / 64) / 4), 2e-6);
        EXPECT_NEAR((off - off.dot(axis) * axis).norm(), 0, 2e-6);
      }
    }
  }
  EXPECT_NEAR(sideways[0].dot(sideways[1]), 0, 1e-5);
}

TEST(Length, ScalesAlongTheHair) {
  const HairMesh mesh = lawn(2, 10);
  const StrandSet straight = strandsOn(mesh, 50);
  for (const double scale : {0.3, 1.0, 1.7}) {
    const StrandSet scaled = styled(mesh, straight, {op("length", {{"scale", scale}, {"variation", 0}})});
    for (std::size_t s = 0; s < 50; ++s) {
      EXPECT_NEAR(lengthOf(scaled.strand(s)), 10 * scale, 1e-5 * scale);
      EXPECT_NEAR(scaled.strand(s)[16].y(), 5 * scale, 2e-5) << "points spread anew";
    }
  }
  const StrandSet varied = styled(mesh, straight, {op("length", {{"variation", 0.5}})});
  double shortest = 10, longest = 0;
  for (std::size_t s = 0; s < 50; ++s) {
    shortest = std::min(shortest, lengthOf(varied.strand(s)));
    longest = std::max(longest, lengthOf(varied.strand(s)));
  }
  EXPECT_GE(shortest, 5 - 1e-5);
  EXPECT_LE(longest, 10 + 1e-5);
  EXPECT_GT(longest - shortest, 3) << "50 draws of a range of 5";
}

TEST(Trim, TakesExactlyThatMuch) {
  const HairMesh mesh = lawn(2, 10);
  const StrandSet straight = strandsOn(mesh, 20);
  StyleOperator trim = op("trim", {{"cut", 3.3}, {"uneven", 0}});
  for (const auto& [amount, left] : {std::pair(1.0, 6.7), std::pair(0.5, 8.35)}) {
    trim.amount = amount;
    const StrandSet cut = styled(mesh, straight, {trim});
    for (std::size_t s = 0; s < 20; ++s) EXPECT_NEAR(lengthOf(cut.strand(s)), left, 1e-5);
  }
  ASSERT_TRUE(setParameter(trim, "cut", 25.0).ok());
  trim.amount = 1;
  const StrandSet stubs = styled(mesh, straight, {trim});
  for (std::size_t s = 0; s < 20; ++s)
    EXPECT_NEAR(lengthOf(stubs.strand(s)), 0.01, 1e-5) << "a stub of a thousandth stays";
}

TEST(CutPlane, EndsCurledHairOnThePlane) {
  const HairMesh mesh = lawn(3, 10);
  const StrandSet straight = strandsOn(mesh, 60, 97);
  const Vec3 normal = Vec3(0.3, 1, -0.2).normalized();
  const StyleOperator cut = op("cut_plane", {{"point_y", 7},
                                             {"normal_x", normal.x()},
                                             {"normal_y", normal.y()},
                                             {"normal_z", normal.z()},
                                             {"uneven", 0}});
  const StrandSet curled = styled(mesh, straight, {plainCurl(0.4, 2.5)});
  const StrandSet ended = styled(mesh, straight, {plainCurl(0.4, 2.5), cut});
  for (std::size_t s = 0; s < 60; ++s) {
    // The tip lies on the plane as well as floats near 10 and a float's reach say.
    EXPECT_NEAR((ended.strand(s).back().cast<double>() - Vec3(0, 7, 0)).dot(normal), 0, 1e-5);
    EXPECT_GT((curled.strand(s).back().cast<double>() - Vec3(0, 7, 0)).dot(normal), 0.5);
    // What is left is the same curl: each new point lies on the old line, within the bend between its points.
    for (std::size_t k = 3; k < 97; ++k) {  // after the step from the root out to the helix
      const Vec3f p = ended.strand(s)[k];
      float nearest = 1e9f;
      for (std::size_t i = 1; i < 97; ++i) {
        const Vec3f a = curled.strand(s)[i - 1], d = curled.strand(s)[i] - a;
        const float t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0f, 1.0f);
        nearest = std::min(nearest, (p - a - t * d).norm());
      }
      EXPECT_LT(nearest, 0.02f);
    }
  }
}

TEST(Clump, FullTightnessEndsEveryHairInItsCentresTip) {
  const HairMesh mesh = lawn(4, 10);
  const StrandSet straight = strandsOn(mesh, 400);
  const StrandSet clumped = styled(mesh, straight, {level(op("clump", {{"count", 12}, {"variation", 0}}))});
  std::vector<int> members(12, 0);
  for (std::size_t s = 0; s < 400; ++s) {
    std::size_t nearest = 0;
    for (std::size_t c = 1; c < 12; ++c) {
      if ((straight.strand(s)[0] - straight.strand(c)[0]).norm() <
          (straight.strand(s)[0] - straight.strand(nearest)[0]).norm())
        nearest = c;
    }
    ++members[nearest];
    EXPECT_EQ(clumped.strand(s)[0], straight.strand(s)[0]);
    EXPECT_LT((clumped.strand(s).back() - straight.strand(nearest).back()).norm(), 3e-6f) << s;
  }
  for (const int m : members) EXPECT_GT(m, 5) << "centres are spread over the scalp";
}

TEST(Clump, KeepsAPartingOpen) {
  HairMesh mesh = lawn(4, 6);
  for (std::uint32_t y = 0; y < 4; ++y)  // the line x = 2, from one border to the other
    ASSERT_TRUE(separateEdge(mesh, {mesh.bundles()[4 * y + 1].id, 1, 1}).ok());
  const StrandSet straight = strandsOn(mesh, 800);
  const StrandSet clumped = styled(mesh, straight, {level(op("clump", {{"count", 8}, {"variation", 0}}))});
  for (std::size_t s = 0; s < 800; ++s) {
    const float root = straight.strand(s)[0].x(), tip = clumped.strand(s).back().x();
    EXPECT_EQ(root < 2, tip < 2) << root;
  }
}

TEST(Clump, ASecondOneMakesLocksOfLocks) {
  const HairMesh mesh = lawn(4, 10);
  const StrandSet straight = strandsOn(mesh, 1000);
  const StyleOperator fine = level(op("clump", {{"count", 100}, {"variation", 0}}));
  StyleOperator coarse = level(op("clump", {{"count", 10}, {"variation", 0}}));
  coarse.amount = 0.5, coarse.name = "Coarse";
  const StrandSet once = styled(mesh, straight, {fine}), twice = styled(mesh, straight, {fine, coarse});
  std::set<std::tuple<long, long>> tips;
  for (std::size_t s = 0; s < 1000; ++s) {
    const Vec3f a = once.strand(s).back();
    tips.insert({std::lround(1e3 * a.x()), std::lround(1e3 * a.z())});
    // Half way from the fine lock's centre to the coarse one's.
    bool found = false;
    for (std::size_t c = 0; c < 10; ++c)
      found = found || (twice.strand(s).back() - 0.5f * (a + once.strand(c).back())).norm() < 1e-5f;
    EXPECT_TRUE(found) << s;
  }
  EXPECT_EQ(tips.size(), 100u);
}

TEST(Braid, CrossesInThreeParts) {
  const HairMesh mesh = lawn(2, 16);
  const StrandSet straight = strandsOn(mesh, 300, 129);
  const StrandSet braided = styled(
      mesh, straight, {level(op("braid", {{"count", 1}, {"width", 2}, {"pitch", 4}, {"fullness", 0}}))});
  // Without fullness every hair of a part is the same line: three lines, each within width/2 of the middle.
  std::set<std::pair<long, long>> lines;
  double widest = 0;
  for (std::size_t s = 0; s < 300; ++s) {
    const Vec3f off = braided.strand(s)[100] - straight.strand(0)[100];
    lines.insert({std::lround(1e4 * off.x()), std::lround(1e4 * off.z())});
    for (std::size_t p = 1; p < 129; ++p) {
      const Vec3f from = braided.strand(s)[p] - straight.strand(0)[p];
      widest = std::max(widest, double(from.norm()));
    }
  }
  EXPECT_EQ(lines.size(), 3u);
  // √(sin²φ + ¼ sin²2φ) is 1 at most: sin²φ (1 + cos²φ) = 1 − cos⁴φ.
  EXPECT_NEAR(widest, 1, 1e-3);
}

TEST(Droop, KeepsLengthsAndEndsStraightDown) {
  const HairMesh mesh = lawn(1, 10);
  const StrandSet up = strandsOn(mesh, 6, 65);
  StyleOperator droop = op("droop", {{"strength", 1}});
  HairMesh leaning = mesh;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v)
    leaning.setPosition(v, mesh.position(v) + 0.5 * mesh.vertices()[v].layer * Vec3::UnitX());
  const StrandSet straight = strandsOn(leaning, 6, 65), hanging = styled(leaning, straight, {droop});
  for (std::size_t s = 0; s < 6; ++s) {
    EXPECT_NEAR(lengthOf(hanging.strand(s)), lengthOf(straight.strand(s)), 1e-5);
    const Vec3f last = hanging.strand(s)[64] - hanging.strand(s)[63];
    EXPECT_NEAR(last.normalized().y(), -1, 1e-6);
    EXPECT_LT((hanging.strand(s)[1] - straight.strand(s)[1]).norm(), 0.01f) << "stiff at the root";
  }
  // Straight up there is no side to fall to.
  EXPECT_EQ(styled(mesh, up, {droop}).points, up.points);
}

TEST(Smooth, LeavesStraightHairAndFlattensNoise) {
  const HairMesh mesh = lawn(1, 10);
  const StrandSet straight = strandsOn(mesh, 10);
  const StyleOperator smooth = level(op("smooth", {{"steps", 200}}));
  EXPECT_LT(greatestDifference(styled(mesh, straight, {smooth}), straight), 3e-6);
  StyleOperator noise = level(op("frizz", {{"height", 0.5}, {"wavelength", 1.5}}));
  const StrandSet rough = styled(mesh, straight, {noise}), flat = styled(mesh, straight, {noise, smooth});
  EXPECT_LT(lengthOf(flat.strand(3)), 0.25 * lengthOf(rough.strand(3)) + 0.75 * 10);
}

TEST(Noise, NeighboursBendAlikeAcrossBordersAndFrizzDoesNot) {
  const HairMesh mesh = lawn(4, 10);
  const StrandSet straight = strandsOn(mesh, 3000);
  const auto differences = [&](const StyleOperator& noise) {
    const StrandSet bent = styled(mesh, straight, {level(noise)});
    double near = 0, all = 0;
    int pairs = 0;
    for (std::size_t a = 0; a < 300; ++a) {
      std::size_t nearest = a == 0;
      for (std::size_t b = 0; b < 3000; ++b) {
        // Of another bundle: across a border.
        if (straight.rootFaces[b] == straight.rootFaces[a]) continue;
        if ((straight.strand(b)[0] - straight.strand(a)[0]).norm() <
            (straight.strand(nearest)[0] - straight.strand(a)[0]).norm())
          nearest = b;
      }
      if ((straight.strand(nearest)[0] - straight.strand(a)[0]).norm() > 0.15f) continue;
      const auto off = [&](std::size_t s) {
        return Vec3f(bent.strand(s).back() - straight.strand(s).back());
      };
      near += double((off(a) - off(nearest)).squaredNorm());
      all += double((off(a) - off((a + 150) % 300)).squaredNorm());
      ++pairs;
    }
    EXPECT_GT(pairs, 20);
    return near / all;
  };
  // At 0.15 of 2.5 cm a smooth field differs by a small share of its range; own noise by as much as any.
  EXPECT_LT(differences(op("noise", {{"octaves", 1}})), 0.05);
  EXPECT_GT(differences(op("frizz")), 0.6);
}

TEST(Flyaways, AreTheGivenShareAndTheSameHairs) {
  const HairMesh mesh = lawn(4, 10);
  const StrandSet straight = strandsOn(mesh, 4000);
  const StrandSet flown = styled(mesh, straight, {op("flyaways", {{"share", 0.1}})});
  int moved = 0;
  for (std::size_t s = 0; s < 4000; ++s) moved += flown.strand(s).back() != straight.strand(s).back();
  EXPECT_NEAR(moved, 400, 4 * std::sqrt(4000 * 0.1 * 0.9)) << "four standard deviations";
}

TEST(Width, FollowsItsRamp) {
  const HairMesh mesh = lawn(1, 10);
  const StrandSet straight = strandsOn(mesh, 10, 33);
  StyleOperator width = op("width", {{"scale", 2}, {"variation", 0}});
  width.ramp = {{{0, 1}, {1, 0}}, RampShape::Linear};
  const StrandSet out = styled(mesh, straight, {width});
  EXPECT_EQ(out.points, straight.points);
  for (std::size_t p = 0; p < straight.points.size(); ++p) {
    const float factor = 2 * (1 - float(p % 33) / 32);
    EXPECT_NEAR(out.widths[p], factor * straight.widths[p], 1e-6f * straight.widths[p]);
  }
}

TEST(PushOut, LeavesNoPointInTheHead) {
  const HairMesh mesh = lawn(2, 4);
  PolygonMesh block;  // above the lawn's middle, open to no side
  for (int i = 0; i < 8; ++i)
    block.positions.push_back({i & 1 ? 1.6 : 0.4, i & 2 ? 3.0 : 1.5, i & 4 ? -0.4 : -1.6});
  for (const auto& face : std::vector<std::vector<std::uint32_t>>{
           {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}})
    block.addFace(face);
  const Surface head(block);
  ASSERT_NEAR(head.windingNumber({1, 2, -1}), 1, 0.01);
  const StrandSet straight = strandsOn(mesh, 200);
  StyleOptions options;
  options.head = &head;
  const StrandSet out = styled(mesh, straight, {level(op("push_out", {{"distance", 0.1}}))}, options);
  std::size_t inside = 0;
  for (const Vec3f& p : straight.points) inside += head.windingNumber(p.cast<double>()) > 0.5;
  ASSERT_GT(inside, 500u);
  for (const Vec3f& p : out.points) EXPECT_GT(head.signedDistance(p.cast<double>()), -1e-5);
}

}  // namespace
}  // namespace coif
