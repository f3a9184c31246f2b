// Curl and wave: periodic offsets across the hair.
#include <cmath>
#include <numbers>

#include "style/kinds.h"
#include "style/value_noise.h"

namespace coif::style {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kLengthSamples = 64;  // midpoints in which the length of a curl is summed

/// What one strand's wave is like, after variation.
struct Wave {
  double radius, wavelength, phase;
  bool left;
};

/// Parameters that curl and wave share.
class Waves {
 public:
  Waves(const EffectSetup& setup, const char* radius)
      : random_(setup.random()),
        radius_(setup.length(radius)),
        wavelength_(setup.length("wavelength")),
        radiusVariation_(setup.number("size_variation")),
        wavelengthVariation_(setup.number("wavelength_variation")),
        phase_(setup.number("phase") / 360),
        phaseVariation_(setup.number("phase_variation")),
        coherence_(setup.number("coherence")) {}

  Wave of(const StyledStrand& strand) const {
    const Vec3 size = variation(random_.child(1), strand, coherence_);
    const Vec3 turn = variation(random_.child(2), strand, coherence_);
    return {radius_ * (1 + radiusVariation_ * size.x()), wavelength_ * (1 + wavelengthVariation_ * size.y()),
            kTurn * (phase_ + 0.5 * phaseVariation_ * turn.x()), turn.y() < 0};
  }

 private:
  CounterRandom random_;
  double radius_, wavelength_, radiusVariation_, wavelengthVariation_, phase_, phaseVariation_, coherence_;
};

std::vector<StyleParameter> waveParameters(StyleParameter radius, double wavelength, double phaseVariation) {
  return {std::move(radius),
          number("wavelength", "Length of a turn", "cm", wavelength, 0.1, 15, 1000,
                 "Hair from one turn to the next, along the mesh's curve."),
          number("size_variation", "Size varies", "", 0.25, 0, 0.9, 0.9,
                 "How much bigger or smaller than that, as a share."),
          number("wavelength_variation", "Length varies", "", 0.15, 0, 0.9, 0.9,
                 "How much longer or shorter a turn is than that, as a share."),
          number("phase", "Phase", "°", 0, -1e6, 360, 1e6, "Where it begins."),
          share("phase_variation", "Phase varies", phaseVariation,
                "0: neighbours turn together, 1: each begins anywhere."),
          number("coherence", "Agrees over", "cm", 2, 0, 20, 1000,
                 "Over how far neighbours vary alike; 0: each for itself. Hair that a clump gathered varies "
                 "as one.")};
}

class Curl final : public Effect {
 public:
  explicit Curl(const EffectSetup& setup)
      : waves_(setup, "radius"), hand_(int(setup.number("hand"))), keepLength_(setup.flag("keep_length")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const Wave wave = waves_.of(strand);
    const double hand = hand_ == 1 || (hand_ == 2 && wave.left) ? -1 : 1;
    if (keepLength_) shorten(strand, strength, wave);
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const double angle = wave.phase + hand * kTurn * strand.arcs()[p] / wave.wavelength;
      const double radius = wave.radius * strength.at(strand.fraction(p));
      strand.addOffset(p, radius * std::cos(angle), radius * std::sin(angle));
    }
  }

 private:
  /// A helix of radius r is √(1 + (2πr/λ)²) times as long as its axis.
  static void shorten(StyledStrand& strand, const Strength& strength, const Wave& wave) {
    double mean = 0;
    for (int i = 0; i < kLengthSamples; ++i) {
      const double radius = wave.radius * strength.at((i + 0.5) / kLengthSamples);
      mean += std::hypot(1, kTurn * radius / wave.wavelength) / kLengthSamples;
    }
    strand.endAtArc(strand.length() / mean);
  }

  Waves waves_;
  int hand_;
  bool keepLength_;
};

class WaveEffect final : public Effect {
 public:
  explicit WaveEffect(const EffectSetup& setup)
      : waves_(setup, "height"), direction_(setup.number("direction") / 360 * kTurn) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const Wave wave = waves_.of(strand);
    for (std::size_t p = 1; p < strand.size(); ++p) {
      const double height = wave.radius * strength.at(strand.fraction(p)) *
                            std::sin(wave.phase + kTurn * strand.arcs()[p] / wave.wavelength);
      strand.addOffset(p, height * std::cos(direction_), height * std::sin(direction_));
    }
  }

 private:
  Waves waves_;
  double direction_;
};

}  // namespace

std::vector<KindEntry> waveKinds() {
  StyleKind curl{
      "curl", "Curl", "Winds each hair around its own line, as a helix.",
      waveParameters(number("radius", "Radius", "cm", 0.6, 0, 3, 1000, "Of the helix."), 3.5, 0.3)};
  curl.parameters.push_back(choice("hand", "Winds", {"right", "left", "either"}, "Which way round."));
  curl.parameters.push_back(
      flag("keep_length", "Keep the length", false,
           "Curled hair is as long as it was, so it ends higher; off: it ends where the "
           "mesh does and is longer."));
  curl.ramp = {{{0, 0}, {0.3, 1}}, RampShape::Smooth};
  curl.pointsPerWave = 10;
  StyleKind wave{
      "wave", "Wave", "Bends each hair to and fro across its own line.",
      waveParameters(number("height", "Height", "cm", 0.5, 0, 3, 1000, "To either side."), 6, 0.2)};
  wave.parameters.push_back(number("direction", "Direction", "°", 0, -1e6, 180, 1e6,
                                   "0: along the head, 90: away from it, between: both."));
  wave.ramp = {{{0, 0}, {0.3, 1}}, RampShape::Smooth};
  wave.pointsPerWave = 8;
  return {{std::move(curl), [](const EffectSetup& s) { return std::make_unique<Curl>(s); }},
          {std::move(wave), [](const EffectSetup& s) { return std::make_unique<WaveEffect>(s); }}};
}

}  // namespace coif::style
