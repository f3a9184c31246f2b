// Droop, smooth and push-out: operators that look at where the hair has come to lie.
#include <cmath>

#include "style/kinds.h"

namespace coif::style {
namespace {

/// Turns every step of the hair towards the ground and lays the steps end to end: no length changes.
class Droop final : public Effect {
 public:
  explicit Droop(const EffectSetup& setup) : down_(-setup.up), strength_(setup.number("strength")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    if (strand.size() < 2) return;
    Vec3 before = strand.position(0), here = before;
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const Vec3 next = strand.position(p), step = next - before;
      here += turned(step, strength_ * strength.at(strand.fraction(p)));
      strand.moveTo(p, here);
      before = next;
    }
  }

 private:
  /// By a share of the angle to straight down.
  Vec3 turned(const Vec3& step, double share) const {
    const Vec3 axis = step.cross(down_);
    const double sine = axis.norm(), angle = std::atan2(sine, step.dot(down_));
    if (!(sine > 1e-12 * step.norm())) return step;
    return Eigen::AngleAxisd(share * angle, axis / sine) * step;
  }
  Vec3 down_;
  double strength_;
};

/// Laplacian smoothing of the styled line; root and tip stay.
class Smooth final : public Effect {
 public:
  explicit Smooth(const EffectSetup& setup) : steps_(int(setup.number("steps"))) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    if (strand.size() < 3) return;
    std::vector<Vec3> points, next;
    for (std::size_t p = 0; p < strand.size(); ++p) points.push_back(strand.position(p));
    next = points;
    for (int i = 0; i < steps_; ++i) {
      for (std::size_t p = 1; p + 1 < points.size(); ++p)
        next[p] = points[p] + 0.5 * (0.5 * (points[p - 1] + points[p + 1]) - points[p]);
      std::swap(points, next);
    }
    for (std::size_t p = 1; p + 1 < points.size(); ++p) {
      const Vec3 was = strand.position(p);
      strand.moveTo(p, was + strength.at(strand.fraction(p)) * (points[p] - was));
    }
  }

 private:
  int steps_;
};

/// Points inside the head, or nearer to it than the distance, move out along the way to its nearest point.
class PushOut final : public Effect {
 public:
  explicit PushOut(const EffectSetup& setup) : head_(*setup.head), distance_(setup.length("distance")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const Vec3 at = strand.position(p);
      // Hair rises from the skin to the full distance within its own first stretch of that length.
      const double wanted = std::min(distance_, 0.5 * strand.arcs()[p]);
      const SurfacePoint foot = head_.nearest(at);
      if (foot.face == kNone) return;
      const Vec3 away = at - foot.position;
      const bool inside = away.dot(foot.normal) < 0 && head_.windingNumber(at) > 0.5;
      if (!inside && foot.distance >= wanted) continue;
      const bool clear = !inside && foot.distance > 1e-9 * head_.size();
      const Vec3 outward = clear ? Vec3(away / foot.distance) : foot.normal;
      const Vec3 target = foot.position + wanted * outward;
      strand.moveTo(p, at + strength.at(strand.fraction(p)) * (target - at));
    }
  }

 private:
  const Surface& head_;
  double distance_;
};

}  // namespace

std::vector<KindEntry> shapeKinds() {
  StyleKind droop{"droop",
                  "Droop",
                  "Lets hair hang down, longer hair more; its length stays.",
                  {share("strength", "Strength", 0.3, "1: the tip points straight down.")}};
  droop.ramp = {{{0, 0}, {1, 1}}, RampShape::Smooth};
  droop.usesSeed = false, droop.looksAtWorld = true;
  StyleKind smooth{"smooth",
                   "Smooth",
                   "Takes bends out of the hair; root and tip stay.",
                   {integer("steps", "Steps", 8, 1, 50, 1000, "More take out longer bends.")}};
  smooth.usesSeed = false;
  StyleKind push{"push_out",
                 "Push out",
                 "Keeps hair out of the head; best as the last operator.",
                 {number("distance", "Distance", "cm", 0.15, 0, 2, 1000, "Between skin and hair.")}};
  push.usesSeed = false, push.looksAtWorld = push.needsHead = true;
  return {{std::move(droop), [](const EffectSetup& s) { return std::make_unique<Droop>(s); }},
          {std::move(smooth), [](const EffectSetup& s) { return std::make_unique<Smooth>(s); }},
          {std::move(push), [](const EffectSetup& s) { return std::make_unique<PushOut>(s); }}};
}

}  // namespace coif::style
