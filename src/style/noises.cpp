// Noise, frizz and flyaways: what keeps hair from lying too well.
#include <cmath>
#include <numbers>

#include "style/kinds.h"
#include "style/value_noise.h"

namespace coif::style {
namespace {

class Noise final : public Effect {
 public:
  Noise(const EffectSetup& setup, double coherence)
      : random_(setup.random()),
        height_(setup.length("height")),
        wavelength_(setup.length("wavelength")),
        coherence_(coherence),
        octaves_(int(setup.number("octaves"))) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    for (int octave = 0; octave < octaves_; ++octave) {
      const double finer = std::exp2(octave);
      AlongNoise noise(random_.child(std::uint64_t(octave)), strand.place, coherence_ / finer);
      for (std::size_t p = 1; p < strand.size(); ++p) {
        const Vec3 value = noise(strand.arcs()[p] * finer / wavelength_);
        const double height = height_ / finer * strength.at(strand.fraction(p));
        strand.addOffset(p, height * value.x(), height * value.y());
      }
    }
  }

 private:
  CounterRandom random_;
  double height_, wavelength_, coherence_;
  int octaves_;
};

/// A few hairs leave the rest in a slow arc of their own.
class Flyaways final : public Effect {
 public:
  explicit Flyaways(const EffectSetup& setup)
      : random_(setup.random()), share_(setup.number("share")), distance_(setup.length("distance")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const CounterRandom own = random_.child(strand.place.id);
    if (own.uniform(0) >= share_) return;
    const double angle = 2 * std::numbers::pi * own.uniform(1), bend = 2 * std::numbers::pi * own.uniform(2);
    const double far = distance_ * (0.25 + 0.75 * own.uniform(3)), turns = 0.5 + own.uniform(4);
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const double v = strand.fraction(p), height = far * strength.at(v);
      const double wander = 0.5 * std::sin(bend + 2 * std::numbers::pi * turns * v);
      strand.addOffset(p, height * std::cos(angle + wander), height * std::sin(angle + wander));
    }
  }

 private:
  CounterRandom random_;
  double share_, distance_;
};

StyleParameter height(double standard, const char* help) {
  return number("height", "Height", "cm", standard, 0, 3, 1000, help);
}
StyleParameter wavelength(double standard) {
  return number("wavelength", "Length of a bend", "cm", standard, 0.05, 20, 1000,
                "Along the hair, from one bend to the next.");
}
StyleParameter octaves(double standard) {
  return integer("octaves", "Octaves", standard, 1, 5, 8, "Each adds bends half as long and half as high.");
}

}  // namespace

std::vector<KindEntry> noiseKinds() {
  StyleKind noise{"noise",
                  "Noise",
                  "Bends hair at random, neighbours alike.",
                  {height(1.5, "At most so far to a side."), wavelength(6),
                   number("coherence", "Agrees over", "cm", 2.5, 0, 20, 1000,
                          "Over how far neighbours bend alike; 0: each for itself."),
                   octaves(2)}};
  noise.ramp = {{{0, 0}, {1, 1}}, RampShape::Smooth};
  noise.pointsPerWave = 4;
  StyleKind frizz{"frizz",
                  "Frizz",
                  "Bends every hair in its own way.",
                  {height(0.3, "At most so far to a side."), wavelength(2), octaves(1)}};
  frizz.ramp = {{{0, 0}, {0.25, 0.5}, {1, 1}}, RampShape::Smooth};
  frizz.pointsPerWave = 4;
  StyleKind flyaways{"flyaways",
                     "Flyaways",
                     "Lets a few hairs stand off the rest.",
                     {number("share", "Share", "", 0.04, 0, 0.3, 1, "Of all hairs."),
                      number("distance", "Distance", "cm", 3.5, 0, 10, 1000, "Of their tips, at most.")}};
  flyaways.ramp = {{{0, 0}, {0.2, 0.06}, {1, 1}}, RampShape::Smooth};
  return {{std::move(noise),
           [](const EffectSetup& s) { return std::make_unique<Noise>(s, s.number("coherence")); }},
          {std::move(frizz), [](const EffectSetup& s) { return std::make_unique<Noise>(s, 0); }},
          {std::move(flyaways), [](const EffectSetup& s) { return std::make_unique<Flyaways>(s); }}};
}

}  // namespace coif::style
