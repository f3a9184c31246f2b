// Wisps: who belongs to whom, and strands that go along with their guides.
#include "coif/simulate/wisps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "coif/simulate/simulation.h"
#include "coif/strands/grow.h"
#include "simulate/mesh_samples.h"

namespace coif {
namespace {

StrandSet strandsOf(const HairMesh& mesh, std::size_t count, std::uint32_t points = 9) {
  GrowOptions options;
  options.count = count;
  options.points = points;
  return grow(mesh, options).value().strands;
}

double worst(const StrandSet& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t p = 0; p < b.size(); ++p)
    most = std::max(most, (a.points[p].cast<double>() - b[p]).norm());
  return most;
}

TEST(Wisps, HaveThreeGuidesOfTheirOwnNeighbourhood) {
  const HairMesh mesh = samples::patch(Vec3(0, -1, 0));
  const WispSet set = makeWisps(mesh, {20, 6, 1}).value();
  ASSERT_EQ(set.wisps.size(), 20u);
  EXPECT_EQ(set.guides.size(), set.guideCount() * 6);
  std::set<std::uint32_t> seen;
  for (const auto& guides : set.wisps) {
    for (const std::uint32_t g : guides) seen.insert(g);
    for (int k = 0; k < 3; ++k) {
      // Twenty cells of a patch of 3 × 3 are 0.67 wide; none reaches over more than three of those.
      EXPECT_LE((set.guide(guides[k])[0] - set.guide(guides[(k + 1) % 3])[0]).norm(), 2.0);
    }
  }
  EXPECT_EQ(seen.size(), set.guideCount());  // every guide serves a wisp, none two wisps
  for (const WispSet::Root& root : set.roots) {
    double sum = 0;
    for (const double weight : root.weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

// Where hair parts, roots are neighbours and tips are not: no wisp reaches across.
TEST(Wisps, APartingPartsThem) {
  HairMesh mesh = samples::patch(Vec3(0, -1, 0));
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const HairVertex& vertex = mesh.vertices()[v];
    const double side = vertex.position.x() > 1.5 ? 1 : -1;
    mesh.setPosition(v, vertex.position + Vec3(4.0 * side * vertex.layer, 0, 0));
  }
  const WispSet set = makeWisps(mesh, {12, 6, 1}).value();
  const StrandSet strands = strandsOf(mesh, 300);
  for (const auto& guides : set.wisps) {
    for (const std::uint32_t g : guides)
      EXPECT_LE((set.guide(g)[5] - set.guide(guides[0])[5]).norm(), 13) << g;  // sides are 35 apart
  }
  for (std::size_t s = 0; const WispStrand& bound : bindStrands(set, strands)) {
    const double tip = strands.strand(s++).back().x(), guide = set.guide(set.wisps[bound.wisp][0])[5].x();
    if (std::abs(tip - 1.5) > 12) { EXPECT_GT((tip - 1.5) * (guide - 1.5), 0) << s; }
  }
}

TEST(Wisps, StrandsStayWhereTheyWereModelledAndMoveRigidlyWithTheirGuides) {
  const HairMesh mesh = samples::patch(Vec3(0.5, -1, 0.2));
  const WispSet set = makeWisps(mesh, {9, 5, 1}).value();
  const StrandSet rest = strandsOf(mesh, 200);
  const auto bound = bindStrands(set, rest);
  for (const WispStrand& strand : bound) {
    EXPECT_NEAR(strand.weights[0] + strand.weights[1] + strand.weights[2], 1, 1e-12);
    for (const double weight : strand.weights) EXPECT_GE(weight, 0);
  }
  const Mat3 turn = Eigen::AngleAxisd(2.5, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  for (const Mat3& by : {Mat3(Mat3::Identity()), turn}) {
    std::vector<Vec3> positions, expected;
    for (const Vec3& p : set.guides) positions.push_back(by * p + Vec3(7, 0, 1));
    for (const Vec3f& p : rest.points) expected.push_back(by * p.cast<double>() + Vec3(7, 0, 1));
    StrandSet moved = rest;
    ASSERT_TRUE(carryStrands(set, positions, by, bound, moved).ok());
    EXPECT_LE(worst(moved, expected), 4e-6);  // floats up to 16
  }
}

// Guides that shift by what is linear in the root: so do strands inside their triangle, the papers'
// interpolation from three guides.
TEST(Wisps, InterpolateBetweenTheirGuides) {
  const HairMesh mesh = samples::patch(Vec3(0, -1, 0));
  const WispSet set = makeWisps(mesh, {4, 4, 1}).value();
  const StrandSet rest = strandsOf(mesh, 300);
  const auto bound = bindStrands(set, rest);
  std::vector<Vec3> positions;
  const auto lift = [](double x, double z) {
    return Vec3(0, 0.3 * x - 0.2 * z, 0);
  };  // along the hair: no turn
  for (std::size_t g = 0; g < set.guideCount(); ++g) {
    const Vec3 root = set.guide(g)[0];
    for (const Vec3& p : set.guide(g)) positions.push_back(p + lift(root.x(), root.z()));
  }
  StrandSet moved = rest;
  ASSERT_TRUE(carryStrands(set, positions, Mat3::Identity(), bound, moved).ok());
  std::size_t inside = 0;
  for (std::size_t s = 0; s < bound.size(); ++s) {
    const auto& w = bound[s].weights;
    if (std::min({w[0], w[1], w[2]}) <= 0) continue;
    ++inside;
    for (std::size_t j = 0; j < 9; ++j) {
      const Vec3f before = rest.strand(s)[j];
      const Vec3 expected = before.cast<double>() + lift(rest.strand(s)[0].x(), rest.strand(s)[0].z());
      EXPECT_LE((moved.strand(s)[j].cast<double>() - expected).norm(), 3e-6) << s;
    }
  }
  EXPECT_GT(inside, 60u);
}

TEST(Wisps, AreTheSameBytesForAnyNumberOfThreadsAndRefuseWhatDoesNotFit) {
  const HairMesh mesh = samples::patch(Vec3(0.5, -1, 0.2));
  Context one, five;
  one.threads = 1, five.threads = 5;
  const WispSet a = makeWisps(mesh, {30, 5, 1}, nullptr, one).value(),
                b = makeWisps(mesh, {30, 5, 1}, nullptr, five).value();
  EXPECT_EQ(a.guides, b.guides);
  EXPECT_EQ(a.wisps, b.wisps);
  const StrandSet rest = strandsOf(mesh, 700);
  std::vector<Vec3> positions = a.guides;
  for (Vec3& p : positions) p += Vec3(std::sin(3 * p.y()), 0, std::cos(p.x()));
  StrandSet left = rest, right = rest;
  ASSERT_TRUE(carryStrands(a, positions, Mat3::Identity(), bindStrands(a, rest, one), left, one).ok());
  ASSERT_TRUE(carryStrands(b, positions, Mat3::Identity(), bindStrands(b, rest, five), right, five).ok());
  EXPECT_EQ(left.points, right.points);
  EXPECT_FALSE(makeWisps(mesh, {0, 5, 1}).ok());
  EXPECT_FALSE(makeWisps(mesh, {5, 1, 1}).ok());
  EXPECT_FALSE(makeWisps(HairMesh(), {5, 5, 1}).ok());
  const auto bound = bindStrands(a, rest);
  EXPECT_FALSE(carryStrands(a, std::span(positions).first(3), Mat3::Identity(), bound, left).ok());
  EXPECT_FALSE(carryStrands(a, positions, Mat3::Identity(), std::span(bound).first(3), left).ok());
}

// Through the simulation: guides keep their lengths, hang below their roots, and go on after an interruption.
TEST(Wisps, SwingKeepTheirLengthsAndResume) {
  const HairMesh mesh = samples::patch(Vec3(1, 0, 0));
  DynamicsSettings settings;
  settings.wisps = 8;
  settings.guidePoints = 9;
  settings.droop = 0;
  settings.drag = 6;
  settings.lateral = 20;
  SimulationWorld world = samples::centimetres();
  for (int f = 0; f < 4; ++f) {
    std::vector<Vec3> roots;  // a scalp that grows wider
    for (const HairVertex& vertex : mesh.vertices())
      if (vertex.layer == 0) roots.push_back(vertex.position * (1 + 0.05 * f));
    world.motion.roots.push_back(roots);
  }
  auto whole = Simulation::create(mesh, settings, world);
  ASSERT_TRUE(whole.ok()) << whole.error().text();
  const WispSet set = makeWisps(mesh, {8, 9, settings.seed}).value();
  ASSERT_EQ((*whole)->positions().size(), set.guides.size());
  for (std::size_t p = 0; p < set.guides.size(); ++p)  // the rotation that fits best is found to rounding
    EXPECT_LE(((*whole)->positions()[p] - set.guides[p]).norm(), 1e-12);
  const auto state = (*whole)->state();
  for (int f = 0; f < 24 * 8; ++f) ASSERT_TRUE((*whole)->advance().ok());
  const auto now = (*whole)->positions();
  for (std::size_t g = 0; g < set.guideCount(); ++g) {
    // Weights of the root face take the scaled corners to the scaled root.
    EXPECT_LE((now[g * 9] - 1.15 * set.guide(g)[0]).norm(), 1e-6);
    for (std::size_t k = 1; k < 9; ++k) {
      const double length = (set.guide(g)[k] - set.guide(g)[k - 1]).norm();
      EXPECT_NEAR((now[g * 9 + k] - now[g * 9 + k - 1]).norm(), length, 1e-9 * length);
      EXPECT_LT(now[g * 9 + k].y(), now[g * 9 + k - 1].y() - 0.9 * length);  // it hangs
    }
  }
  auto second = Simulation::create(mesh, settings, world);
  ASSERT_TRUE((*second)->restore(state).ok());
  for (int f = 0; f < 24 * 8; ++f) ASSERT_TRUE((*second)->advance().ok());
  EXPECT_EQ((*whole)->state(), (*second)->state());
}

}  // namespace
}  // namespace coif
