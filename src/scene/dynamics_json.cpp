#include "scene/dynamics_json.h"

#include <cstdio>

#include "scene/typed_array.h"

namespace coif::scene {

namespace {

constexpr std::size_t kCapsuleNumbers = 8;  // a, b, radius, withHead

/// Every plain number of the settings, by name: one list for writing and reading. validate() knows the
/// ranges.
template <class Settings, class Visit>
void forNumbers(Settings& s, Visit&& visit) {
  visit("longestStep", s.longestStep);
  visit("tolerance", s.tolerance);
  visit("sleepSpeed", s.sleepSpeed);
  visit("sleepSeconds", s.sleepSeconds);
  visit("settleSeconds", s.settleSeconds);
  visit("gravity", s.gravity);
  visit("droop", s.droop);
  visit("lateral", s.lateral);
  visit("drag", s.drag);
  visit("gustSpeed", s.gustSpeed);
  visit("gustSize", s.gustSize);
  visit("gustSeconds", s.gustSeconds);
  visit("shelter", s.shelter);
  visit("thickness", s.thickness);
  visit("contactStiffness", s.contactStiffness);
  visit("friction", s.friction);
  visit("repulsion", s.repulsion);
  visit("density", s.density);
  visit("cell", s.cell);
  visit("hairFriction", s.hairFriction);
}

template <std::size_t N>
int indexOf(JsonReader& reader, const char* key, const char* const (&names)[N], int fallback) {
  const std::string text = reader.text(key, names[fallback]);
  std::string wanted;
  for (std::size_t i = 0; i < N; ++i) {
    if (text == names[i]) return int(i);
    wanted += (i == 0 ? "\"" : i + 1 == N ? " or \"" : ", \"") + std::string(names[i]) + "\"";
  }
  reader.fail(key, wanted + " is wanted here");
  return fallback;
}

}  // namespace

nlohmann::ordered_json dynamicsJson(const DynamicsSettings& s) {
  nlohmann::ordered_json out;
  out["solver"] = kMethodNames[int(s.method)];
  forNumbers(s, [&](const char* name, double value) { out[name] = value; });
  out["precision"] = kPrecisionNames[int(s.singlePrecision)];
  out["wisps"] = s.wisps;
  out["guidePoints"] = s.guidePoints;
  out["skipBending"] = std::uint32_t(s.skipBending);
  out["wind"] = kWindNames[int(s.wind)];
  const std::vector<double> wind{s.windVelocity[0], s.windVelocity[1], s.windVelocity[2]};
  out["windVelocity"] = encodeDoubles(wind);
  out["seed"] = s.seed;
  out["airCells"] = s.airCells;
  out["collide"] = std::uint32_t(s.collide);
  std::vector<double> capsules;
  for (const BodyCapsule& c : s.capsules) {
    capsules.insert(capsules.end(),
                    {c.a[0], c.a[1], c.a[2], c.b[0], c.b[1], c.b[2], c.radius, double(c.withHead)});
  }
  out["capsules"] = encodeDoubles(capsules);
  return out;
}

DynamicsSettings readDynamics(JsonReader reader) {
  DynamicsSettings s;
  s.method = DynamicsMethod(indexOf(reader, "solver", kMethodNames, int(s.method)));
  forNumbers(s, [&](const char* name, double& value) { value = reader.number(name, value, -1e30, 1e30); });
  s.singlePrecision = indexOf(reader, "precision", kPrecisionNames, int(s.singlePrecision)) == 1;
  s.wisps = std::size_t(reader.integer("wisps", s.wisps, 0, 10000));
  s.guidePoints = std::uint32_t(reader.integer("guidePoints", s.guidePoints, 2, 256));
  s.skipBending = reader.integer("skipBending", std::uint64_t(s.skipBending), 0, 1) != 0;
  s.wind = WindKind(indexOf(reader, "wind", kWindNames, int(s.wind)));
  if (reader.has("windVelocity")) {
    const auto wind = reader.doubles("windVelocity");
    if (wind.size() == 3) {
      s.windVelocity = Vec3(wind[0], wind[1], wind[2]);
    } else if (reader.status().ok()) {
      reader.fail("windVelocity", "three values are wanted here");
    }
  }
  s.seed = reader.integer("seed", s.seed, 0, ~std::uint64_t{0});
  s.airCells = int(reader.integer("airCells", std::uint64_t(s.airCells), 4, 128));
  s.collide = reader.integer("collide", std::uint64_t(s.collide), 0, 1) != 0;
  if (reader.has("capsules")) {
    const auto values = reader.doubles("capsules");
    if (values.size() % kCapsuleNumbers != 0)
      reader.fail("capsules", "eight values a capsule are wanted here");
    for (std::size_t i = 0; i + kCapsuleNumbers <= values.size(); i += kCapsuleNumbers) {
      const double* v = &values[i];
      s.capsules.push_back({Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5]), v[6], v[7] != 0});
    }
  }
  if (const Status status = validate(s); !status.ok() && reader.status().ok())
    reader.fail(status.error().place.c_str(), status.error().message);
  return s;
}

}  // namespace coif::scene

namespace coif {

std::vector<std::string> dynamicsNames() {
  std::vector<std::string> names;
  const nlohmann::ordered_json json = scene::dynamicsJson({});
  for (const auto& [name, value] : json.items())
    if (name != "capsules") names.push_back(name);
  return names;
}

Status setDynamics(DynamicsSettings& settings, const std::string& name, const std::string& value) {
  nlohmann::json json = nlohmann::json::parse(scene::dynamicsJson(settings).dump());  // as from a file
  if (!json.contains(name) || name == "capsules") {
    std::string all;
    for (const std::string& known : dynamicsNames()) all += (all.empty() ? "" : ", ") + known;
    return makeError(ErrorCode::InvalidArgument,
                     "there is no dynamics setting named '" + name + "'; there are " + all);
  }
  const auto unsuited = [&](const std::string& why) {
    return makeError(ErrorCode::InvalidArgument, why + ", not '" + value + "'", name);
  };
  if (name == "windVelocity") {
    std::vector<double> v(3);
    int used = 0;
    if (std::sscanf(value.c_str(), "%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &used) != 3 ||
        std::size_t(used) != value.size())
      return unsuited("three numbers with commas between them are wanted");
    json[name] = scene::encodeDoubles(v);
  } else if (json[name].is_string()) {
    json[name] = value;
  } else {
    json[name] = nlohmann::json::parse(value, nullptr, false);
    if (!json[name].is_number()) return unsuited("a number is wanted");
  }
  scene::JsonReader reader(json);
  const DynamicsSettings read = scene::readDynamics(reader);
  if (!reader.status().ok()) return unsuited(reader.status().error().message);
  settings = read;
  return {};
}

}  // namespace coif
