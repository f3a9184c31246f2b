// Length, trim, cut and width: where hair ends, and how thick it is.
#include <cmath>

#include "style/kinds.h"

namespace coif::style {
namespace {

class Length final : public Effect {
 public:
  explicit Length(const EffectSetup& setup)
      : random_(setup.random()), scale_(setup.number("scale")), variation_(setup.number("variation")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const double own = scale_ * (1 - variation_ * random_.uniform(strand.place.id));
    strand.endAtArc(strand.length() * (1 + strength.whole * (own - 1)));
  }

 private:
  CounterRandom random_;
  double scale_, variation_;
};

class Trim final : public Effect {
 public:
  explicit Trim(const EffectSetup& setup)
      : random_(setup.random()), cut_(setup.length("cut")), uneven_(setup.length("uneven")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const double cut = cut_ + uneven_ * random_.uniform(strand.place.id);
    if (cut > 0) strand.endAtArc(std::max(strand.length() - strength.whole * cut, 0.0));
  }

 private:
  CounterRandom random_;
  double cut_, uneven_;
};

/// A straight cut: every hair ends where it first goes through the plane.
class CutPlane final : public Effect {
 public:
  explicit CutPlane(const EffectSetup& setup)
      : random_(setup.random()),
        point_(setup.number("point_x"), setup.number("point_y"), setup.number("point_z")),
        normal_(setup.number("normal_x"), setup.number("normal_y"), setup.number("normal_z")),
        uneven_(setup.length("uneven")) {
    normal_ = normal_.norm() > 0 ? Vec3(normal_.normalized()) : Vec3(-setup.up);
  }

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const double shift = uneven_ * random_.uniform(strand.place.id);
    const auto beyond = [&](double place) {
      return (strand.positionAt(place) - point_).dot(normal_) + shift;
    };
    if (strand.size() < 2 || beyond(0) >= 0) return;  // it grows beyond the plane: it stays
    for (std::size_t p = 1; p < strand.size(); ++p) {
      if (beyond(double(p)) < 0) continue;
      double inside = double(p - 1), outside = double(p);
      for (int i = 0; i < 52; ++i) {  // to the last bit of the place
        const double middle = 0.5 * (inside + outside);
        (beyond(middle) < 0 ? inside : outside) = middle;
      }
      const double tip = double(strand.size() - 1);
      return strand.endAt(tip + strength.whole * (inside - tip));
    }
  }

 private:
  CounterRandom random_;
  Vec3 point_, normal_;
  double uneven_;
};

class Width final : public Effect {
 public:
  explicit Width(const EffectSetup& setup)
      : random_(setup.random()), scale_(setup.number("scale")), variation_(setup.number("variation")) {}

  void run(StyledStrand& strand, const Strength& strength, const Locks*) const override {
    const double own = scale_ * (1 + variation_ * (2 * random_.uniform(strand.place.id) - 1));
    for (std::size_t p = 0; p < strand.size(); ++p) {
      const double profile = own * strength.ramp(strand.fraction(p));
      strand.scaleWidth(p, 1 + strength.whole * (profile - 1));
    }
  }

 private:
  CounterRandom random_;
  double scale_, variation_;
};

}  // namespace

std::vector<KindEntry> lengthKinds() {
  const StyleParameter uneven =
      number("uneven", "Uneven", "cm", 0.5, 0, 10, 1000, "More is cut off some hairs, at most so much.");
  StyleKind length{"length",
                   "Length",
                   "Makes hair shorter or longer along its own line.",
                   {number("scale", "Length", "", 1, 0, 2, 100, "As a share of what the mesh gives."),
                    share("variation", "Varies", 0.25, "How much shorter some hairs are, as a share.")}};
  length.usesRamp = false;
  StyleKind trim{"trim",
                 "Trim",
                 "Cuts a length off the tips.",
                 {number("cut", "Cut off", "cm", 2, 0, 30, 10000, "Off every hair."), uneven}};
  trim.usesRamp = false;
  const auto coordinate = [](const char* name, const char* label, double standard, const char* help) {
    return number(name, label, "", standard, -1e9, 100, 1e9, help);
  };
  StyleKind cut{"cut_plane",
                "Straight cut",
                "Cuts hair off where it goes through a plane.",
                {coordinate("point_x", "Point x", 0, "A point of the plane, scene units."),
                 coordinate("point_y", "Point y", 0, "A point of the plane, scene units."),
                 coordinate("point_z", "Point z", 0, "A point of the plane, scene units."),
                 coordinate("normal_x", "Normal x", 0, "Points to what is cut off; all 0: down."),
                 coordinate("normal_y", "Normal y", 0, "Points to what is cut off; all 0: down."),
                 coordinate("normal_z", "Normal z", 0, "Points to what is cut off; all 0: down."), uneven}};
  cut.usesRamp = false, cut.looksAtWorld = true;
  StyleKind width{"width",
                  "Width",
                  "Makes hair thicker or thinner; the ramp is its profile.",
                  {number("scale", "Width", "", 1, 0, 4, 1000, "As a share of what it was."),
                   share("variation", "Varies", 0.2, "Between hairs, as a share.")}};
  width.changesWidth = true;
  width.ramp = {{{0, 1}, {0.6, 1}, {1, 0.3}}, RampShape::Smooth};
  return {{std::move(length), [](const EffectSetup& s) { return std::make_unique<Length>(s); }},
          {std::move(trim), [](const EffectSetup& s) { return std::make_unique<Trim>(s); }},
          {std::move(cut), [](const EffectSetup& s) { return std::make_unique<CutPlane>(s); }},
          {std::move(width), [](const EffectSetup& s) { return std::make_unique<Width>(s); }}};
}

}  // namespace coif::style
