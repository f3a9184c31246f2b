// How a kind of style operator is written: what the registry shows, and what it does to one strand.
#pragma once

#include <functional>
#include <memory>

#include "coif/scalp/surface.h"
#include "coif/style/style_kinds.h"
#include "style/styled_strand.h"

namespace coif::style {

struct EffectSetup {
  const StyleOperator& op;
  double cm;  ///< scene units in a centimetre
  Vec3 up;    ///< unit
  const Surface* head;

  double number(const char* name) const { return parameterOf(op, name); }
  double length(const char* name) const { return parameterOf(op, name) * cm; }
  bool flag(const char* name) const { return parameterOf(op, name) != 0; }
  CounterRandom random() const;  ///< of the operator's seed and kind
};

/// An operator made ready. run() is called from many threads, for strands in any order.
class Effect {
 public:
  virtual ~Effect() = default;
  virtual std::uint32_t lockCount() const { return 0; }  ///< > 0: run() wants locks of so many centres
  virtual void run(StyledStrand& strand, const Strength& strength, const Locks* locks) const = 0;
};

struct KindEntry {
  StyleKind info;
  std::function<std::unique_ptr<Effect>(const EffectSetup&)> make;
};

/// Null when there is none of that name.
const KindEntry* findKind(std::string_view name);

// One file each.
std::vector<KindEntry> waveKinds();
std::vector<KindEntry> noiseKinds();
std::vector<KindEntry> lockKinds();
std::vector<KindEntry> lengthKinds();
std::vector<KindEntry> shapeKinds();

// Short forms for the tables.
StyleParameter number(std::string name, std::string label, std::string unit, double standard, double least,
                      double usual, double most, std::string help);
StyleParameter share(std::string name, std::string label, double standard, std::string help);  ///< 0 … 1
StyleParameter integer(std::string name, std::string label, double standard, double least, double usual,
                       double most, std::string help);
StyleParameter flag(std::string name, std::string label, bool standard, std::string help);
StyleParameter choice(std::string name, std::string label, std::vector<std::string> choices,
                      std::string help);

}  // namespace coif::style
