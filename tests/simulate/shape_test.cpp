// Shapes at rest with known answers: cantilever, elastica, catenary, rest shapes; and one step against an
// independent dense solve.
#include <Eigen/LU>
#include <numbers>

#include "coif/base/random.h"
#include "simulate/chain_samples.h"

namespace coif {
namespace {

constexpr double kG = 9.81;

// Large steps of implicit Euler: motion dies, the minimum of the energy is left.
void settle(const ChainSet& c, ChainState& state, std::span<ForceField* const> fields = {},
            const Vec3& gravity = Vec3(0, -kG, 0)) {
  const auto solver = samples::solverFor(c, DynamicsMethod::Direct, gravity);
  for (int k = 0; k < 200; ++k) {
    const StepReport report = solver->step(state, fields, k < 20 ? 0.1 : 10.0).value();
    // From a pose far from rest the first large steps may stop at maxNewton; they go on from there.
    if (k >= 50) {
      ASSERT_TRUE(report.faults.empty()) << k;
    }
  }
}

double droopOfBeam(std::size_t links, double rigidity) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i <= links; ++i) points.emplace_back(double(i) / double(links), 0, 0);
  const ChainSet c = chainsFromCurves(points, std::vector<std::uint64_t>{0, points.size()},
                                      {.linearDensity = 1, .bendingRigidity = rigidity})
                         .value()
                         .chains;
  ChainState state = restState(c);
  settle(c, state);
  return -state.positions.back().y();
}

// Tip droop w L⁴ / 8EI of a beam that carries its own weight.
TEST(Cantilever, DroopsAsTheBeamDoes) {
  const double rigidity = 100 * kG;  // droop 1/800: the linear theory's own error is its square
  const double exact = kG / (8 * rigidity);
  std::vector<double> errors;
  for (const std::size_t links : {5, 10, 20, 40})
    errors.push_back(std::abs(droopOfBeam(links, rigidity) / exact - 1));
  EXPECT_LT(errors[1], 0.011);  // a hundredth at ten links
  EXPECT_NEAR(samples::orders(errors)[1], 2, 0.1);
}

TEST(Cantilever, DroopOptionSaysWhatItDoes) {
  const std::vector<Vec3> points{{0, 0, 0},   {0.3, 0, 0}, {0.6, 0, 0}, {0.9, 0, 0},
                                 {1.2, 0, 0}, {1.5, 0, 0}, {1.8, 0, 0}, {2.1, 0, 0}};
  ChainOptions options;
  options.droop = 0.01;
  const ChainSet c = chainsFromCurves(points, std::vector<std::uint64_t>{0, 8}, options).value().chains;
  ChainState state = restState(c);
  settle(c, state);
  EXPECT_NEAR(-state.positions.back().y() / 2.1, 0.01, 0.01 * 0.03);  // seven links: 2 % by the test above
}

// EI θ″ = −P cos θ with θ(0) = 0, θ′(L) = 0, by shooting; independent of the chains.
Vec2 elasticaTip(double load) {
  constexpr int kSteps = 2000;
  const double h = 1. / kSteps;
  Vec2 tip = Vec2::Zero();
  const auto shoot = [&](double slope) {
    double theta = 0, rate = slope;
    tip.setZero();
    for (int k = 0; k < kSteps; ++k) {
      const auto f = [&](double t) { return -load * std::cos(t); };
      const double a1 = rate, b1 = f(theta), a2 = rate + h / 2 * b1, b2 = f(theta + h / 2 * a1),
                   a3 = rate + h / 2 * b2, b3 = f(theta + h / 2 * a2), a4 = rate + h * b3,
                   b4 = f(theta + h * a3);
      const double middle = theta + h / 2 * a2;
      const double next = theta + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      tip += h / 6 *
             Vec2(std::cos(theta) + 4 * std::cos(middle) + std::cos(next),
                  std::sin(theta) + 4 * std::sin(middle) + std::sin(next));
      theta = next, rate += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
    }
    return rate;
  };
  double low = 0, high = 2 * load;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (shoot(middle) > 0 ? high : low) = middle;
  }
  return tip;
}

TEST(Elastica, BendsFarUnderALoadAtItsTip) {
  const double load = 4;  // P L² / EI: the tip sinks by two thirds of the length
  const Vec2 exact = elasticaTip(load);
  EXPECT_NEAR(elasticaTip(2).y(), 0.4935, 1e-4);  // Bisshopp and Drucker 1945
  std::vector<double> errors;
  for (const std::size_t links : {10, 20, 40}) {
    ChainSet c = straightChain(links, 1, Vec3(1, 0, 0), 1e-9, double(links));
    c.stiffness[1] *= 2;
    c.masses.back() = load / kG;
    ChainState state = restState(c);
    settle(c, state);
    const Vec3 tip = state.positions.back();
    errors.push_back((Vec2(tip.x(), -tip.y()) - exact).norm());
  }
  EXPECT_LT(errors.back(), 5e-4);
  EXPECT_NEAR(samples::orders(errors).back(), 2, 0.2);
}

class HoldNode : public ForceField {
 public:
  HoldNode(std::uint32_t node, const Vec3& where, double stiffness)
      : node_(node), where_(where), stiffness_(stiffness) {}
  void prepare(const NodeView&, double, double, const Context&) override {}
  void add(std::uint32_t node, const Vec3& x, const Vec3&, Vec3& force, Mat3& stiffness) const override {
    if (node != node_) return;
    force += stiffness_ * (where_ - x);
    stiffness += stiffness_ * Mat3::Identity();
  }
  double energy(std::uint32_t node, const Vec3& x) const override {
    return node == node_ ? 0.5 * stiffness_ * (where_ - x).squaredNorm() : 0;
  }

 private:
  std::uint32_t node_;
  Vec3 where_;
  double stiffness_;
};

// Both ends held: y = a cosh(x / a), 2a sinh(D / 2a) = L.
TEST(Catenary, HangsBetweenTwoPoints) {
  const double span = 0.6;
  double low = 0.05, high = 10;
  for (int k = 0; k < 200; ++k) {
    const double a = (low + high) / 2;
    (2 * a * std::sinh(span / (2 * a)) > 1 ? low : high) = a;
  }
  const double sag = low * (std::cosh(span / (2 * low)) - 1);
  std::vector<double> errors;
  for (const std::size_t links : {10, 20, 40}) {
    ChainSet c = straightChain(links, 1, Vec3(1, 0, 0), 1. / double(links));
    c.masses.back() /= 2;
    HoldNode hold(std::uint32_t(links), Vec3(span, 0, 0), 1e6);  // gives way by 1e-5 under the chain's weight
    ForceField* fields[] = {&hold};
    ChainState state = restState(c);
    settle(c, state, fields);
    EXPECT_NEAR(state.positions.back().x(), span, 1e-4);
    errors.push_back(std::abs(-state.positions[links / 2].y() - sag) / sag);
  }
  EXPECT_LT(errors.back(), 1e-3);
  EXPECT_GT(samples::orders(errors).back(), 1.7);
}

ChainSet helix(std::size_t links) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i <= links; ++i) {
    const double t = 0.5 * double(i);
    points.emplace_back(0.3 * std::cos(t), 0.3 * std::sin(t), 0.1 * t);
  }
  return chainsFromCurves(points, std::vector<std::uint64_t>{0, points.size()}, {.bendingRigidity = 1})
      .value()
      .chains;
}

TEST(RestShape, CurlsComeBackFromAnyPoseAndFollowTheirRoot) {
  const ChainSet c = helix(20);
  ChainState state = restState(c);
  const auto solver = samples::solverFor(c, DynamicsMethod::Direct, Vec3::Zero());
  ASSERT_TRUE(solver->step(state, {}, 0.01).ok());
  for (std::size_t i = 0; i < c.nodeCount(); ++i)  // nothing to do: rounding of 20 frames
    EXPECT_LE((state.positions[i] - c.restPositions[i]).norm(), 1e-12);
  const CounterRandom random(5);
  for (std::uint32_t i = 1; i < c.nodeCount(); ++i) {
    const Vec3 link = c.restPositions[i] - c.restPositions[i - 1];
    const Vec3 shake(random.uniform(3 * i) - 0.5, random.uniform(3 * i + 1) - 0.5,
                     random.uniform(3 * i + 2) - 0.5);
    state.positions[i] = state.positions[i - 1] + c.lengths[i] * (link.normalized() + shake).normalized();
  }
  settle(c, state, {}, Vec3::Zero());
  for (std::size_t i = 0; i < c.nodeCount(); ++i)
    EXPECT_LE((state.positions[i] - c.restPositions[i]).norm(), 1e-6);
  const Mat3 turn = Eigen::AngleAxisd(2.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const std::vector<Vec3> roots{Vec3(1, 2, 3)};
  const std::vector<Mat3> frames{turn * c.rootFrames[0]};
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(solver->step(state, {}, 10, {roots, frames}).ok());
  for (std::size_t i = 0; i < c.nodeCount(); ++i) {
    const Vec3 expected = roots[0] + turn * (c.restPositions[i] - c.restPositions[0]);
    EXPECT_LE((state.positions[i] - expected).norm(), 1e-6);
  }
}

// Positions x and multipliers λ of min ½ Σ m|x − y|²/h² + bending, |d| = ℓ, by Newton on the dense KKT
// matrix.
std::vector<Vec3> denseStep(const ChainSet& c, const ChainState& s, double h) {
  const auto links = Eigen::Index(c.nodeCount()) - 1;
  Eigen::VectorXd z(4 * links);
  for (Eigen::Index i = 0; i < links; ++i) z.segment<3>(3 * i) = s.positions[std::size_t(i) + 1];
  z.tail(links).setZero();
  const Vec3 root = s.positions[0];
  for (int iteration = 0; iteration < 100; ++iteration) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4 * links, 4 * links);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(4 * links);
    const auto x = [&](Eigen::Index i) -> Vec3 { return i == 0 ? root : Vec3(z.segment<3>(3 * (i - 1))); };
    const auto block = [&](Eigen::Index i, Eigen::Index j, const Mat3& m) {
      if (i > 0 && j > 0) a.block<3, 3>(3 * (i - 1), 3 * (j - 1)) += m;
    };
    const auto add = [&](Eigen::Index i, const Vec3& v) {
      if (i > 0) r.segment<3>(3 * (i - 1)) += v;
    };
    for (Eigen::Index i = 1; i <= links; ++i) {
      const auto n = std::size_t(i);
      const auto p = Eigen::Index(c.parents[n]);
      const double w = c.masses[n] / (h * h), ell = c.lengths[n];
      const Vec3 y = s.positions[n] + h * s.velocities[n] + h * h * Vec3(0, -kG, 0), d = x(i) - x(p);
      add(i, w * (x(i) - y)), block(i, i, w * Mat3::Identity());
      // −κ u·t with t the parent's link or the root frame's direction: bilinear in the links.
      Vec3 t = s.rootFrames[0] * c.restDirections[n];
      const double k = c.stiffness[n] / ell;
      if (p > 0) {
        const auto g = Eigen::Index(c.parents[std::size_t(p)]);
        const double kk = k / c.lengths[std::size_t(p)];
        t = (x(p) - x(g)) / c.lengths[std::size_t(p)];
        add(p, -kk * d), add(g, kk * d);
        const Mat3 m = -kk * Mat3::Identity();
        const Eigen::Index to[2] = {i, p}, from[2] = {p, g};
        for (int u = 0; u < 2; ++u) {
          for (int v = 0; v < 2; ++v) {
            const Mat3 signedM = (u == v) ? m : Mat3(-m);
            block(to[u], from[v], signedM), block(from[v], to[u], signedM);
          }
        }
      }
      add(i, -k * t), add(p, k * t);
      const double lambda = z(3 * links + i - 1);
      const Mat3 geometric = lambda / ell * Mat3::Identity();
      block(i, i, geometric), block(p, p, geometric), block(i, p, -geometric), block(p, i, -geometric);
      add(i, lambda * d / ell), add(p, -lambda * d / ell);
      const Eigen::Index row = 3 * links + i - 1;
      r(row) = (d.squaredNorm() - ell * ell) / (2 * ell);
      a.block<1, 3>(row, 3 * (i - 1)) += d.transpose() / ell;
      if (p > 0) a.block<1, 3>(row, 3 * (p - 1)) -= d.transpose() / ell;
      a.block<3, 1>(3 * (i - 1), row) += d / ell;
      if (p > 0) a.block<3, 1>(3 * (p - 1), row) -= d / ell;
    }
    const Eigen::VectorXd step = a.partialPivLu().solve(r);
    z -= step;
    if (step.head(3 * links).norm() < 1e-14) break;
  }
  std::vector<Vec3> out{root};
  for (Eigen::Index i = 0; i < links; ++i) out.emplace_back(z.segment<3>(3 * i));
  return out;
}

TEST(Direct, OneStepEqualsADenseSolveOnChainsAndTrees) {
  const CounterRandom random(11);
  for (const bool branched : {false, true}) {
    for (const double kappa : {0.0, 0.3, 40.0}) {
      ChainSet c = straightChain(8, 1, Vec3(1, 0.3, 0), 0.2, kappa);
      if (branched) c.parents = {kNone, 0, 1, 2, 3, 2, 5, 1, 7};  // two splits
      ChainState state = restState(c);
      for (std::uint32_t i = 1; i < c.nodeCount(); ++i) {
        const Vec3 shake(random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2));
        state.positions[i] =
            state.positions[c.parents[i]] + c.lengths[i] * (Vec3(1, 0, 0) + 0.5 * shake).normalized();
        state.velocities[i] = 0.5 * Vec3(shake.z(), -shake.x(), shake.y());
      }
      const std::vector<Vec3> reference = denseStep(c, state, 1. / 60);
      SolverOptions options;
      options.tolerance = 1e-13;
      const auto solver = makeSolver(c, options).value();
      ASSERT_TRUE(solver->step(state, {}, 1. / 60).ok());
      for (std::size_t i = 0; i < c.nodeCount(); ++i)
        EXPECT_LE((state.positions[i] - reference[i]).norm(), 1e-11) << branched << " " << kappa << " " << i;
    }
  }
}

}  // namespace
}  // namespace coif
