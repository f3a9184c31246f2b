// The style room: kinds of operators, stacks, and styled strands.
#include "bind_style.h"

#include <nanobind/stl/string.h>

#include <algorithm>

#include "bind_hairmesh.h"
#include "bind_strands.h"
#include "coif/style/style_kinds.h"
#include "coif/style/style_plan.h"

namespace coif::python {

using namespace nb::literals;

namespace {

constexpr const char* kEntries[] = {"kind",  "name",       "enabled", "amount", "seed",
                                    "group", "parameters", "ramp",    "smooth", "mask"};

nb::dict fromOperator(const StyleOperator& op) {
  nb::dict out, parameters, mask;
  const StyleKind* kind = findStyleKind(op.kind);
  if (kind != nullptr) {
    for (const StyleParameter& p : kind->parameters) {
      const double value = parameterOf(op, p.name);
      if (p.kind == ParameterKind::Choice) {
        parameters[p.name.c_str()] = p.choices[std::size_t(value)];
      } else {
        parameters[p.name.c_str()] = value;
      }
    }
  }
  nb::list ramp;
  for (const RampPoint& p : op.ramp.points) ramp.append(nb::make_tuple(p.x, p.y));
  for (const auto& [vertex, value] : op.mask) mask[nb::int_(std::uint32_t(vertex))] = value;
  out["kind"] = op.kind, out["name"] = op.name, out["enabled"] = op.enabled, out["amount"] = op.amount;
  out["seed"] = op.seed, out["group"] = op.group, out["parameters"] = parameters, out["ramp"] = ramp;
  out["smooth"] = op.ramp.shape == RampShape::Smooth, out["mask"] = mask;
  return out;
}

void setFrom(StyleOperator& op, const std::string& key, const nb::handle& value) {
  if (key == "name") op.name = nb::cast<std::string>(value);
  if (key == "enabled") op.enabled = nb::cast<bool>(value);
  if (key == "amount") op.amount = nb::cast<double>(nb::float_(value));
  if (key == "seed") op.seed = nb::cast<std::uint64_t>(value);
  if (key == "group") op.group = nb::cast<std::string>(value);
  if (key == "smooth") op.ramp.shape = nb::cast<bool>(value) ? RampShape::Smooth : RampShape::Linear;
  if (key == "parameters") {
    for (const auto [name, given] : nb::cast<nb::dict>(value)) {
      const auto parameter = nb::cast<std::string>(name);
      take(nb::isinstance<nb::str>(given)
               ? setParameter(op, parameter, std::string_view(nb::cast<std::string>(given)))
               : setParameter(op, parameter, nb::cast<double>(nb::float_(given))));
    }
  }
  if (key == "ramp") {
    op.ramp.points.clear();
    for (const nb::handle point : value)
      op.ramp.points.push_back({nb::cast<double>(nb::float_(nb::object(point[0]))),
                                nb::cast<double>(nb::float_(nb::object(point[1])))});
  }
  if (key == "mask") {
    op.mask.clear();
    for (const auto [vertex, share] : nb::cast<nb::dict>(value))
      op.mask.push_back(
          {VertexId(nb::cast<std::uint32_t>(nb::int_(vertex))), nb::cast<double>(nb::float_(share))});
    std::sort(op.mask.begin(), op.mask.end());
  }
}

StyleOperator toOperator(const nb::dict& entry) {
  if (!entry.contains("kind")) throw nb::type_error("an operator of a style needs a 'kind'");
  StyleOperator op = take(makeStyleOperator(nb::cast<std::string>(entry["kind"])));
  for (const auto [name, value] : entry) {
    const auto key = nb::cast<std::string>(name);
    if (std::find(std::begin(kEntries), std::end(kEntries), key) == std::end(kEntries))
      throw nb::type_error(("an operator of a style has no '" + key + "'").c_str());
    setFrom(op, key, value);
  }
  return op;
}

nb::list kindList() {
  nb::list out;
  for (const StyleKind& kind : styleKinds()) {
    nb::dict entry;
    entry["kind"] = kind.name, entry["label"] = kind.label, entry["help"] = kind.help;
    entry["looks_at_world"] = kind.looksAtWorld, entry["uses_ramp"] = kind.usesRamp;
    nb::list parameters;
    for (const StyleParameter& p : kind.parameters) {
      nb::dict parameter;
      parameter["name"] = p.name, parameter["label"] = p.label, parameter["unit"] = p.unit;
      parameter["standard"] = p.standard, parameter["least"] = p.least, parameter["most"] = p.most;
      parameter["help"] = p.help;
      nb::list choices;
      for (const std::string& word : p.choices) choices.append(word);
      parameter["choices"] = choices;
      parameters.append(parameter);
    }
    entry["parameters"] = parameters;
    out.append(entry);
  }
  return out;
}

Strands styledStrands(const Strands& strands, const HairMeshModel& mesh, const nb::object& styles,
                      bool useHead, int threads) {
  const StyleStack stack = toStyles(styles);
  Strands out = strands;
  StyleOptions options;
  if (useHead) options.head = mesh.head.get();
  Run(threads, nb::none())(
      [&](const Context& context) { return applyStyle(mesh.mesh(), out.set, stack, options, context); });
  return out;
}

}  // namespace

nb::list fromStyles(const StyleStack& styles) {
  nb::list out;
  for (const StyleOperator& op : styles) out.append(fromOperator(op));
  return out;
}

StyleStack toStyles(const nb::object& list) {
  StyleStack out;
  try {
    for (const nb::handle entry : list) {
      StyleOperator op = toOperator(nb::cast<nb::dict>(entry));
      if (!nb::cast<nb::dict>(entry).contains("name")) op.name = freeName(out, op.name);
      out.push_back(std::move(op));
    }
  } catch (const nb::cast_error&) {
    throw nb::type_error("a style is a list of dicts as Scene.styles gives them");
  }
  take(validate(out));
  return out;
}

void bindStyle(nb::module_& m) {
  m.def("style_kinds", &kindList,
        "The kinds of style operators: a list of dicts with kind, label, help, uses_ramp, looks_at_world and "
        "parameters\n(each a dict with name, label, unit, standard, least, most, choices and help).");
  m.def("style_strands", &styledStrands, "strands"_a, "hair_mesh"_a, "styles"_a, nb::kw_only(),
        "use_head"_a = true, "threads"_a = 0,
        "A styled copy of strands that coif.grow() made on this hair mesh.\n\n"
        "styles: a list of dicts as Scene.styles has them; only 'kind' is needed:\n"
        "[{'kind': 'clump'}, {'kind': 'curl', 'parameters': {'radius': 0.8}}]. The interpreter lock is "
        "released.\nRaises Error for what is no style, or strands of another mesh.");
}

}  // namespace coif::python
