#include "style/kinds.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "coif/base/check.h"

namespace coif {
namespace style {

StyleParameter number(std::string name, std::string label, std::string unit, double standard, double least,
                      double usual, double most, std::string help) {
  return {std::move(name), std::move(label), ParameterKind::Number, std::move(unit), standard, least, most,
          usual,           std::move(help)};
}
StyleParameter share(std::string name, std::string label, double standard, std::string help) {
  return number(std::move(name), std::move(label), "", standard, 0, 1, 1, std::move(help));
}
StyleParameter integer(std::string name, std::string label, double standard, double least, double usual,
                       double most, std::string help) {
  return {std::move(name), std::move(label), ParameterKind::Integer, "", standard, least, most,
          usual,           std::move(help)};
}
StyleParameter flag(std::string name, std::string label, bool standard, std::string help) {
  return {std::move(name), std::move(label), ParameterKind::Flag, "", double(standard), 0, 1, 1,
          std::move(help)};
}
StyleParameter choice(std::string name, std::string label, std::vector<std::string> choices,
                      std::string help) {
  const double last = double(choices.size()) - 1;
  return {std::move(name), std::move(label),  ParameterKind::Choice, "", 0, 0, last, last,
          std::move(help), std::move(choices)};
}

namespace {
const std::vector<KindEntry>& kinds() {
  static const std::vector<KindEntry> all = [] {
    std::vector<KindEntry> list;
    for (auto part : {waveKinds, noiseKinds, lockKinds, lengthKinds, shapeKinds}) {
      for (KindEntry& kind : part()) list.push_back(std::move(kind));
    }
    return list;
  }();
  return all;
}
}  // namespace

const KindEntry* findKind(std::string_view name) {
  const auto found = std::ranges::find_if(kinds(), [&](const KindEntry& k) { return k.info.name == name; });
  return found == kinds().end() ? nullptr : &*found;
}

CounterRandom EffectSetup::random() const {
  std::uint64_t key = mix64(op.seed + 1);
  for (const char c : op.kind) key = hashCombine(key, std::uint8_t(c));
  return CounterRandom(key);
}

}  // namespace style

std::span<const StyleKind> styleKinds() {
  static const std::vector<StyleKind> infos = [] {
    std::vector<StyleKind> list;
    for (const style::KindEntry& kind : style::kinds()) list.push_back(kind.info);
    return list;
  }();
  return infos;
}

const StyleKind* findStyleKind(std::string_view name) {
  const style::KindEntry* kind = style::findKind(name);
  return kind == nullptr ? nullptr : &kind->info;
}

const StyleParameter* findParameter(const StyleKind& kind, std::string_view name) {
  const auto found = std::ranges::find(kind.parameters, name, &StyleParameter::name);
  return found == kind.parameters.end() ? nullptr : &*found;
}

Result<StyleOperator> makeStyleOperator(std::string_view name) {
  const StyleKind* kind = findStyleKind(name);
  if (kind == nullptr) {
    std::string known;
    for (const StyleKind& k : styleKinds()) known += (known.empty() ? "" : ", ") + k.name;
    return makeError(ErrorCode::NotFound,
                     "there is no style operator '" + std::string(name) + "'; there are " + known);
  }
  StyleOperator op;
  op.kind = kind->name, op.name = kind->label, op.amount = kind->amount, op.ramp = kind->ramp;
  return op;
}

double parameterOf(const StyleOperator& op, std::string_view name) {
  const auto own = op.parameters.find(std::string(name));
  if (own != op.parameters.end()) return own->second;
  const StyleKind* kind = findStyleKind(op.kind);
  const StyleParameter* parameter = kind ? findParameter(*kind, name) : nullptr;
  COIF_CHECK(parameter != nullptr, op.kind + " has no parameter " + std::string(name));
  return parameter->standard;
}

namespace {

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

Result<const StyleParameter*> parameterNamed(const StyleOperator& op, std::string_view name) {
  const StyleKind* kind = findStyleKind(op.kind);
  if (kind == nullptr) return makeStyleOperator(op.kind).error();
  if (const StyleParameter* parameter = findParameter(*kind, name)) return parameter;
  std::string known;
  for (const StyleParameter& p : kind->parameters) known += (known.empty() ? "" : ", ") + p.name;
  return makeError(ErrorCode::NotFound,
                   kind->name + " has no parameter '" + std::string(name) + "'; it has " + known);
}

Error refuse(const StyleParameter& parameter, const std::string& wanted) {
  return makeError(ErrorCode::InvalidArgument, parameter.name + " wants " + wanted);
}

std::string rangeText(const StyleParameter& p) {
  if (p.kind == ParameterKind::Flag) return "on or off";
  if (p.kind == ParameterKind::Choice) {
    std::string words;
    for (const std::string& c : p.choices) words += (words.empty() ? "" : ", ") + c;
    return "one of " + words;
  }
  const std::string what = p.kind == ParameterKind::Integer ? "a whole number" : "a number";
  return what + " from " + text(p.least) + " to " + text(p.most) +
         (p.unit.empty() ? std::string() : " " + p.unit);
}

}  // namespace

Status setParameter(StyleOperator& op, std::string_view name, double value) {
  COIF_ASSIGN(const StyleParameter* parameter, parameterNamed(op, name));
  const bool whole = parameter->kind != ParameterKind::Number;
  if (!(value >= parameter->least && value <= parameter->most) || (whole && value != std::floor(value)))
    return refuse(*parameter, rangeText(*parameter));
  op.parameters[parameter->name] = value;
  return {};
}

Status setParameter(StyleOperator& op, std::string_view name, std::string_view given) {
  COIF_ASSIGN(const StyleParameter* parameter, parameterNamed(op, name));
  const auto word = std::ranges::find(parameter->choices, given);
  if (word != parameter->choices.end())
    return setParameter(op, name, double(word - parameter->choices.begin()));
  if (parameter->kind == ParameterKind::Flag && (given == "on" || given == "off"))
    return setParameter(op, name, given == "on" ? 1.0 : 0.0);
  double value = 0;
  const auto [end, failed] = std::from_chars(given.data(), given.data() + given.size(), value);
  const bool read = failed == std::errc() && end == given.data() + given.size();
  if (!read || parameter->kind == ParameterKind::Choice) return refuse(*parameter, rangeText(*parameter));
  return setParameter(op, name, value);
}

}  // namespace coif
