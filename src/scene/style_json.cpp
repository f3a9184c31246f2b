#include "scene/style_json.h"

#include "coif/style/style_kinds.h"
#include "scene/typed_array.h"

namespace coif::scene {
namespace {

nlohmann::ordered_json operatorJson(const StyleOperator& op) {
  nlohmann::ordered_json out, parameters = nlohmann::ordered_json::object();
  const StyleKind* kind = findStyleKind(op.kind);
  for (const auto& [name, value] : op.parameters) {
    const StyleParameter* parameter = kind ? findParameter(*kind, name) : nullptr;
    if (parameter && parameter->kind == ParameterKind::Choice) {
      parameters[name] = parameter->choices[std::size_t(value)];
    } else {
      parameters[name] = value;
    }
  }
  std::vector<double> ramp, values;
  for (const RampPoint& p : op.ramp.points) ramp.insert(ramp.end(), {p.x, p.y});
  std::vector<std::uint32_t> vertices;
  for (const auto& [vertex, value] : op.mask)
    vertices.push_back(std::uint32_t(vertex)), values.push_back(value);
  out["kind"] = op.kind;
  out["name"] = op.name;
  out["enabled"] = op.enabled ? 1 : 0;
  out["amount"] = op.amount;
  out["seed"] = op.seed;
  out["group"] = op.group;
  out["parameters"] = std::move(parameters);
  out["ramp"] = {{"shape", op.ramp.shape == RampShape::Smooth ? "smooth" : "linear"},
                 {"points", encodeDoubles(ramp)}};
  if (!op.mask.empty())
    out["mask"] = {{"vertices", encodeIntegers(vertices)}, {"values", encodeDoubles(values)}};
  return out;
}

Ramp readRamp(JsonReader reader) {
  Ramp ramp;
  const std::string shape = reader.text("shape", "smooth");
  if (shape != "smooth" && shape != "linear") reader.fail("shape", "\"smooth\" or \"linear\" is wanted here");
  ramp.shape = shape == "linear" ? RampShape::Linear : RampShape::Smooth;
  const auto values = reader.doubles("points");
  if (values.size() % 2 != 0) reader.fail("points", "two values a point are wanted here");
  ramp.points.clear();
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) ramp.points.push_back({values[i], values[i + 1]});
  return ramp;
}

StyleMask readMask(JsonReader reader) {
  StyleMask mask;
  const auto vertices = reader.integers("vertices");
  const auto values = reader.doubles("values");
  if (vertices.size() != values.size()) reader.fail("values", "as many values as vertices are wanted here");
  for (std::size_t i = 0; i < std::min(vertices.size(), values.size()); ++i)
    mask.push_back({VertexId(vertices[i]), values[i]});
  return mask;
}

void readParameters(JsonReader reader, StyleOperator& op) {
  const StyleKind* kind = findStyleKind(op.kind);
  if (kind == nullptr) return;  // the stack's check says so
  for (const std::string& name : reader.keys()) {
    const StyleParameter* parameter = findParameter(*kind, name);
    const bool word = parameter && parameter->kind == ParameterKind::Choice;
    const Status set = word ? setParameter(op, name, reader.text(name.c_str(), ""))
                            : setParameter(op, name, reader.number(name.c_str(), 0, -1e300, 1e300));
    if (!set.ok()) reader.fail(name.c_str(), set.error().message);
  }
}

StyleOperator readOperator(JsonReader& reader) {
  StyleOperator op;
  op.kind = reader.requiredText("kind");
  op.name = reader.requiredText("name");
  op.enabled = reader.integer("enabled", 1, 0, 1) != 0;
  op.amount = reader.number("amount", 1, 0, 1);
  op.seed = reader.integer("seed", 1, 0, ~std::uint64_t{0});
  op.group = reader.text("group", "");
  if (reader.has("parameters")) readParameters(reader.object("parameters"), op);
  if (reader.has("ramp")) op.ramp = readRamp(reader.object("ramp"));
  if (reader.has("mask")) op.mask = readMask(reader.object("mask"));
  return op;
}

}  // namespace

nlohmann::ordered_json stylesJson(const StyleStack& styles) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const StyleOperator& op : styles) out.push_back(operatorJson(op));
  return out;
}

StyleStack readStyles(JsonReader& document) {
  StyleStack styles;
  for (JsonReader& reader : document.objects("styles")) styles.push_back(readOperator(reader));
  if (const Status valid = validate(styles); !valid.ok())
    document.fail(("styles" + valid.error().place).c_str(), valid.error().message);
  return styles;
}

}  // namespace coif::scene
