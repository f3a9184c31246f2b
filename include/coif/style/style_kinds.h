// The kinds of style operators and what each can be told: one table that the command line, Python and the
// editor's panel are made from. A kind that is added in src/style appears in all of them by itself.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coif/base/result.h"
#include "coif/style/style_operator.h"

namespace coif {

enum class ParameterKind { Number, Integer, Flag, Choice };

struct StyleParameter {
  std::string name;   ///< snake_case: "wavelength"
  std::string label;  ///< "Length of a turn"
  ParameterKind kind = ParameterKind::Number;
  std::string unit;                       ///< "cm", "°", "turns"; empty for a plain number
  double standard = 0;                    ///< its value when not told otherwise
  double least = 0, most = 1;             ///< what is accepted
  double usual = 1;                       ///< right end of a slider; <= most
  std::string help;                       ///< one sentence
  std::vector<std::string> choices = {};  ///< of a Choice; the value is the index
};

struct StyleKind {
  std::string name;   ///< "curl"
  std::string label;  ///< "Curl"
  std::string help;   ///< one sentence
  std::vector<StyleParameter> parameters;
  double amount = 1;          ///< of a new operator
  Ramp ramp = {};             ///< of a new operator
  bool usesRamp = true;       ///< false: the ramp is not asked
  bool usesSeed = true;       ///< false: nothing in it is random
  bool looksAtWorld = false;  ///< depends on where the hair is, not on the hair mesh alone
  bool needsHead = false;     ///< left out where the scene has none
  bool changesWidth = false;  ///< of the hair; its place stays
  double pointsPerWave = 0;   ///< points that a "wavelength" needs to look round; 0: it has none
};

/// All kinds, in the order of a menu.
std::span<const StyleKind> styleKinds();
/// Null when there is none of that name.
const StyleKind* findStyleKind(std::string_view name);
/// Null when the kind has no such parameter.
const StyleParameter* findParameter(const StyleKind& kind, std::string_view name);

/// An operator with the kind's standards. Error: NotFound, naming the kinds that there are.
Result<StyleOperator> makeStyleOperator(std::string_view kind);
/// The operator's value, or the kind's standard. The kind must have the parameter.
double parameterOf(const StyleOperator& op, std::string_view name);
/// Sets a parameter. Errors: NotFound (no such parameter), InvalidArgument (out of range, not whole).
Status setParameter(StyleOperator& op, std::string_view name, double value);
/// The same from text: a number, "on"/"off", or a choice's word.
Status setParameter(StyleOperator& op, std::string_view name, std::string_view text);

}  // namespace coif
