#include "coif/light/strand_shooter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "path_scenes.h"

namespace coif::testing {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

class ShooterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto probe = StrandShooter::create(StrandSet{});
    if (!probe.ok() && probe.error().code == ErrorCode::Unsupported) GTEST_SKIP() << probe.error().text();
  }
};

TEST_F(ShooterTest, OneFibreIsMetAtItsAxisWithTheOffsetOfTheFibreFunction) {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, -1, 0), Vec3f(0, 1, 0)}, 0.2f);
  const auto shooter = StrandShooter::create(strands);
  ASSERT_TRUE(shooter.ok()) << shooter.error().text();
  std::vector<StrandMeeting> met;
  EXPECT_FALSE(shooter->shoot(Vec3(0.05, 0.5, -3), Vec3::UnitZ(), kFar, met));
  ASSERT_EQ(met.size(), 1u);
  EXPECT_NEAR(met[0].distance, 3, 1e-5);
  EXPECT_NEAR(met[0].along, 0.75, 1e-5);
  EXPECT_NEAR(met[0].radius, 0.1, 1e-7);
  // fibre.h: the ray meets the surface on the side h (e × T), e = ω_o = −z, T = y: towards +x for h > 0.
  EXPECT_NEAR(met[0].h, 0.5, 1e-6);
  const Vec3 oblique = Vec3(0, std::sin(0.4), std::cos(0.4));
  shooter->shoot(-2 * oblique, oblique, kFar, met);
  ASSERT_EQ(met.size(), 1u);
  EXPECT_NEAR(met[0].inclinationRad(oblique), 0.4, 1e-6);
  EXPECT_NEAR(met[0].h, 0, 1e-6);
  shooter->shoot(Vec3(0.101, 0.5, -3), Vec3::UnitZ(), kFar, met);
  EXPECT_TRUE(met.empty());
  shooter->shoot(Vec3(0, 0.5, -3), Vec3::UnitZ(), 2.9, met);
  EXPECT_TRUE(met.empty());
}

// Every strand within its radius of the ray's line, by the distance between line and segment in double.
struct BruteForce {
  std::set<std::uint32_t> surely, perhaps;  // perhaps: within float's rounding of the radius or of the start
  BruteForce(const StrandSet& strands, const Vec3& origin, const Vec3& direction) {
    for (std::uint32_t s = 0; s < strands.strandCount(); ++s) {
      const auto points = strands.strand(s);
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vec3 a = points[i].cast<double>() - origin, d = (points[i + 1] - points[i]).cast<double>();
        const auto flat = [&](const Vec3& v) { return Vec3(v - v.dot(direction) * direction); };
        const double u =
            std::clamp(-flat(a).dot(flat(d)) / std::max(flat(d).squaredNorm(), 1e-300), 0.0, 1.0);
        const double distance = flat(a + u * d).norm(), depth = (a + u * d).dot(direction);
        const double radius = 0.5 * double(strands.widths[strands.offsets[s]]);
        if (distance < radius - 1e-5 && depth > 1e-5) surely.insert(s);
        if (distance < radius + 1e-5 && depth > -1e-5) perhaps.insert(s);
      }
    }
  }
};

TEST_F(ShooterTest, MeetsWhatBruteForceMeetsHoweverCloseOnceEach) {
  const StrandSet strands = cluster(300, 0.04f);
  const auto shooter = StrandShooter::create(strands);
  ASSERT_TRUE(shooter.ok());
  std::vector<StrandMeeting> met;
  std::size_t total = 0;
  for (std::uint64_t r = 0; r < 300; ++r) {
    const CounterRandom random(7, r);
    const auto u = [&](std::uint64_t i) { return random.uniform(i) - 0.5; };
    const Vec3 origin(u(0), u(1), u(2)), direction = Vec3(u(3), u(4), u(5)).normalized();
    shooter->shoot(origin, direction, kFar, met);
    const BruteForce expected(strands, origin, direction);
    std::set<std::uint32_t> found;
    for (const StrandMeeting& m : met) {
      found.insert(m.strand);
      EXPECT_LE(std::abs(m.h), 1);
    }
    EXPECT_TRUE(std::is_sorted(met.begin(), met.end(),
                               [](const auto& a, const auto& b) { return a.distance < b.distance; }));
    EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.surely.begin(), expected.surely.end()));
    EXPECT_TRUE(std::includes(expected.perhaps.begin(), expected.perhaps.end(), found.begin(), found.end()));
    total += met.size();
  }
  EXPECT_GT(total, 300u);  // the test looks at something
}

TEST_F(ShooterTest, AJointIsMetOnce) {
  StrandSet strands;
  addStrand(strands, {Vec3f(-1, 0, 0), Vec3f(0, 0.1f, 0), Vec3f(1, 0, 0)}, 0.2f);
  const auto shooter = StrandShooter::create(strands);
  ASSERT_TRUE(shooter.ok());
  std::vector<StrandMeeting> met;
  for (double x = -0.02; x < 0.02; x += 0.0037) {
    shooter->shoot(Vec3(x, 0.09, 1), -Vec3::UnitZ(), kFar, met);
    EXPECT_EQ(met.size(), 1u) << x;
  }
}

TEST_F(ShooterTest, AStrandDoesNotShadowItselfButACurlDoes) {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, -1, 0), Vec3f(0, 0, 0), Vec3f(0, 1, 0)}, 0.1f);
  std::vector<Vec3f> curl;
  for (int i = 0; i <= 60; ++i) {
    const float a = float(i) * 0.1f;  // most of a circle
    curl.push_back(Vec3f(5 + std::cos(a), std::sin(a), 0));
  }
  strands.points.insert(strands.points.end(), curl.begin(), curl.end());
  strands.widths.resize(strands.points.size(), 0.1f);
  strands.offsets.push_back(strands.points.size());
  const auto shooter = StrandShooter::create(strands);
  ASSERT_TRUE(shooter.ok());
  std::vector<StrandMeeting> met;
  for (std::uint64_t r = 0; r < 200; ++r) {
    const CounterRandom random(9, r);
    const auto u = [&](std::uint64_t i) { return random.uniform(i) - 0.5; };
    // Anywhere in the fibre's cross-section, in every direction but those that run along it (within 2.3°).
    const Vec3 direction = Vec3(u(0), u(1), u(2)).normalized();
    if (std::abs(direction.y()) > 0.9992) continue;
    shooter->shoot(Vec3(0.03 * u(3), 0.5 * u(4), 0.03 * u(5)), direction, 2, met, 0);
    EXPECT_TRUE(met.empty()) << direction.transpose();
  }
  shooter->shoot(Vec3(6, 0, 0), -Vec3::UnitX(), kFar, met, 1);
  ASSERT_EQ(met.size(), 2u);
  EXPECT_EQ(met[0].strand, 1u);
  EXPECT_NEAR(met[0].distance, 2, 2e-3);  // chords of 0.1 rad lie 1 − cos 0.05 inside the circle
}

TEST_F(ShooterTest, TheHeadEndsTheWay) {
  StrandSet strands;
  addStrand(strands, {Vec3f(-1, 0, 1), Vec3f(1, 0, 1)}, 0.1f);
  addStrand(strands, {Vec3f(-1, 0, -1), Vec3f(1, 0, -1)}, 0.1f);
  const PolygonMesh head = square(Vec3::UnitZ(), 1);
  const auto shooter = StrandShooter::create(strands, &head);
  ASSERT_TRUE(shooter.ok());
  std::vector<StrandMeeting> met;
  EXPECT_TRUE(shooter->shoot(Vec3(0.1, 0, 3), -Vec3::UnitZ(), kFar, met));
  ASSERT_EQ(met.size(), 1u);
  EXPECT_EQ(met[0].strand, 0u);
  EXPECT_FALSE(shooter->shoot(Vec3(0.1, 0, 3), -Vec3::UnitZ(), 2.5, met));
  EXPECT_FALSE(shooter->shoot(Vec3(0.1, 5, 3), -Vec3::UnitZ(), kFar, met));
}

TEST_F(ShooterTest, BrokenStrandsAreCountedAndBrokenSetsRefused) {
  StrandSet strands;
  addStrand(strands, {Vec3f(0, -1, 0), Vec3f(0, 1, 0)}, 0.1f);
  addStrand(strands, {Vec3f(0, -1, 0), Vec3f(0, NAN, 0)}, 0.1f);
  addStrand(strands, {Vec3f(0, 0, 0)}, 0.1f);
  addStrand(strands, {Vec3f(1, 1, 1), Vec3f(1, 1, 1)}, 0.1f);
  addStrand(strands, {Vec3f(0, 0, 0), Vec3f(1e20f, 0, 0)}, 0.1f);
  addStrand(strands, {Vec3f(0, 0, 0), Vec3f(1, 0, 0)}, -1.0f);
  addStrand(strands, {Vec3f(0, -1, 0), Vec3f(0, -1, 0), Vec3f(0, 1, 0)}, 0.1f);
  const auto shooter = StrandShooter::create(strands);
  ASSERT_TRUE(shooter.ok());
  EXPECT_EQ(shooter->strandsDropped(), 5u);
  std::vector<StrandMeeting> met;
  shooter->shoot(Vec3(0, 0, 3), -Vec3::UnitZ(), kFar, met);
  EXPECT_EQ(met.size(), 2u);
  StrandSet broken = strands;
  broken.offsets.back() = 99;
  EXPECT_FALSE(StrandShooter::create(broken).ok());
}

}  // namespace
}  // namespace coif::testing
