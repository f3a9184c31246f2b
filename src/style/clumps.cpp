// Clump and braid: hair that gathers around centres.
#include <cmath>
#include <numbers>

#include "style/kinds.h"

namespace coif::style {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The strand's centre, having told the strand of it if it gathers there at all; null without one.
const Locks::Centre* join(StyledStrand& strand, const Locks& locks, const Strength& strength) {
  const std::uint32_t c = locks.centreOf[strand.index];
  if (c == kNone) return nullptr;
  if (strength.whole * strength.ramp.greatest() == 0) return &locks.centres[c];
  strand.lock = locks.centres[c].place, strand.inLock = true;
  return &locks.centres[c];
}

/// The same share of the way along the centre.
double placeOn(const Locks::Centre& centre, const StyledStrand& strand, std::size_t p) {
  const double share = double(centre.points.size() - 1) / double(strand.size() - 1);
  return share == 1 ? double(p) : double(p) * share;
}

const Frame& frameAt(const Locks::Centre& centre, double place) {
  return centre.frames[std::min(std::size_t(place + 0.5), centre.frames.size() - 1)];
}

class Clump final : public Effect {
 public:
  explicit Clump(const EffectSetup& setup)
      : random_(setup.random()),
        count_(std::uint32_t(setup.number("count"))),
        variation_(setup.number("variation")),
        twist_(kTurn * setup.number("twist")) {}

  std::uint32_t lockCount() const override { return count_; }

  void run(StyledStrand& strand, const Strength& strength, const Locks* locks) const override {
    const Locks::Centre* centre = join(strand, *locks, strength);
    if (centre == nullptr || centre->place.id == strand.place.id) return;
    const double lock = 1 - variation_ * random_.child(1).uniform(centre->place.id);
    const double own = 1 - 0.5 * variation_ * random_.child(2).uniform(strand.place.id);
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const double v = strand.fraction(p), tight = lock * own * strength.at(v);
      const double angle = strength.whole * twist_ * v, place = placeOn(*centre, strand, p);
      if (tight == 0 && angle == 0) continue;
      const Vec3 middle = splineAt<Vec3>(centre->points, place);
      Vec3 apart = strand.position(p) - middle;
      if (angle != 0) apart = Eigen::AngleAxisd(angle, frameAt(*centre, place).tangent) * apart;
      strand.moveTo(p, middle + (1 - tight) * apart);
    }
  }

 private:
  CounterRandom random_;
  std::uint32_t count_;
  double variation_, twist_;
};

/// 0, 1 or 2: in which third around the centre's root a hair grows, as seen from outside.
double partOf(const StrandPlace& hair, const StrandPlace& centre) {
  if (hair.id == centre.id) return 0;
  Vec3 across = centre.normal.cross(Vec3::UnitZ());  // level, but where the scalp is
  if (across.norm() < 0.3) across = centre.normal.cross(Vec3::UnitY());
  const Vec3 away = hair.root - centre.root;
  const double around = std::atan2(away.dot(centre.normal.cross(across)), away.dot(across)) / kTurn + 0.5;
  return std::min(std::floor(3 * around), 2.0);
}

/// Three parts of a lock go along a lying figure of eight, a third of the way apart.
class Braid final : public Effect {
 public:
  explicit Braid(const EffectSetup& setup)
      : random_(setup.random()),
        count_(std::uint32_t(setup.number("count"))),
        width_(0.5 * setup.length("width")),
        pitch_(setup.length("pitch")),
        fullness_(setup.number("fullness")) {}

  std::uint32_t lockCount() const override { return count_; }

  void run(StyledStrand& strand, const Strength& strength, const Locks* locks) const override {
    const Locks::Centre* centre = join(strand, *locks, strength);
    if (centre == nullptr || strand.size() < 2) return;
    const double part = partOf(strand.place, centre->place);
    const CounterRandom own = random_.child(strand.place.id);
    const double angle = kTurn * own.uniform(0), far = fullness_ * width_ * std::sqrt(own.uniform(1));
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const double place = placeOn(*centre, strand, p), v = strand.fraction(p);
      const Frame& frame = frameAt(*centre, place);
      const double phase = kTurn * (splineAt<double>(centre->arcs, place) / pitch_ + part / 3);
      const double x = width_ * std::sin(phase) + far * std::cos(angle);
      const double y = 0.5 * width_ * std::sin(2 * phase) + far * std::sin(angle);
      const Vec3 target = splineAt<Vec3>(centre->points, place) + x * frame.normal + y * frame.binormal;
      const Vec3 at = strand.position(p);
      strand.moveTo(p, at + strength.at(v) * (target - at));
    }
  }

 private:
  CounterRandom random_;
  std::uint32_t count_;
  double width_, pitch_, fullness_;
};

}  // namespace

std::vector<KindEntry> lockKinds() {
  StyleKind clump{"clump",
                  "Clump",
                  "Gathers hair into locks; several make locks of locks.",
                  {integer("count", "Locks", 350, 1, 5000, 1e6, "On the whole head, or in the group."),
                   share("variation", "Varies", 0.3, "How much looser some locks and hairs are."),
                   number("twist", "Twist", "turns", 0, -5, 5, 1000, "Of a lock, from root to tip.")}};
  clump.amount = 0.75;
  clump.ramp = {{{0, 0}, {0.35, 0.4}, {1, 1}}, RampShape::Smooth};
  StyleKind braid{"braid",
                  "Braid",
                  "Plaits hair in three parts around each centre.",
                  {integer("count", "Braids", 40, 1, 200, 1e6, "On the whole head, or in the group."),
                   number("width", "Width", "cm", 1.6, 0, 6, 1000, "Of a braid, between its outer middles."),
                   number("pitch", "Length of a turn", "cm", 4, 0.1, 20, 1000,
                          "Hair from where a part lies outside to where it does again."),
                   number("fullness", "Fullness", "", 0.45, 0, 1, 10,
                          "How thick each part is, as a share of the width.")}};
  braid.ramp = {{{0, 0}, {0.15, 1}}, RampShape::Smooth};
  braid.usesSeed = true;
  return {{std::move(clump), [](const EffectSetup& s) { return std::make_unique<Clump>(s); }},
          {std::move(braid), [](const EffectSetup& s) { return std::make_unique<Braid>(s); }}};
}

}  // namespace coif::style
