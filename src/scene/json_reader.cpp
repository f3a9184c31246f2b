#include "scene/json_reader.h"

#include <cmath>

#include "scene/typed_array.h"

namespace coif::scene {

namespace {
const nlohmann::json kEmptyObject = nlohmann::json::object();

std::string rangeText(double lo, double hi) {
  char text[96];
  std::snprintf(text, sizeof text, "a number from %g to %g", lo, hi);
  return text;
}
}  // namespace

void JsonReader::fail(const char* key, const std::string& message) {
  if (!*sharedFault_) *sharedFault_ = makeError(ErrorCode::Malformed, message, path_ + key);
}

Status JsonReader::status() const {
  if (*sharedFault_) return **sharedFault_;
  return {};
}

const nlohmann::json* JsonReader::find(const char* key, bool required) {
  const auto it = value_->find(key);
  if (it != value_->end()) return &*it;
  if (required) fail(key, "this entry is missing");
  return nullptr;
}

JsonReader JsonReader::object(const char* key) {
  const nlohmann::json* found = find(key, true);
  if (found && !found->is_object()) fail(key, "an object is wanted here"), found = nullptr;
  return JsonReader(found ? *found : kEmptyObject, path_ + key + ".", *sharedFault_);
}

std::vector<JsonReader> JsonReader::objects(const char* key) {
  std::vector<JsonReader> out;
  const nlohmann::json* found = find(key, true);
  if (!found) return out;
  bool good = found->is_array();
  for (std::size_t i = 0; good && i < found->size(); ++i) {
    good = (*found)[i].is_object();
    out.push_back(JsonReader(good ? (*found)[i] : kEmptyObject, path_ + key + "[" + std::to_string(i) + "].",
                             *sharedFault_));
  }
  if (!good) fail(key, "a list of objects is wanted here"), out.clear();
  return out;
}

std::vector<std::string> JsonReader::keys() const {
  std::vector<std::string> out;
  for (const auto& [key, value] : value_->items()) out.push_back(key);
  return out;
}

std::string JsonReader::text(const char* key, const std::string& fallback) {
  const nlohmann::json* found = find(key, false);
  if (!found) return fallback;
  if (!found->is_string()) return fail(key, "a text is wanted here"), fallback;
  return found->get<std::string>();
}

std::string JsonReader::requiredText(const char* key) {
  if (!find(key, true)) return {};
  return text(key, "");
}

double JsonReader::number(const char* key, double fallback, double lo, double hi) {
  const nlohmann::json* found = find(key, false);
  if (!found) return fallback;
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  if (!(value >= lo && value <= hi)) return fail(key, rangeText(lo, hi) + " is wanted here"), fallback;
  return value;
}

std::uint64_t JsonReader::integer(const char* key, std::uint64_t fallback, std::uint64_t lo,
                                  std::uint64_t hi) {
  const nlohmann::json* found = find(key, false);
  if (!found) return fallback;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() < lo || found->get<std::uint64_t>() > hi) {
    fail(key, "a whole number from " + std::to_string(lo) + " to " + std::to_string(hi) + " is wanted here");
    return fallback;
  }
  return found->get<std::uint64_t>();
}

Vec3f JsonReader::color(const char* key, const Vec3f& fallback) {
  const nlohmann::json* found = find(key, false);
  if (!found) return fallback;
  Vec3f out = fallback;
  bool good = found->is_array() && found->size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    good = (*found)[i].is_number();
    if (good) out[i] = (*found)[i].get<float>();
    good = good && out[i] >= 0 && out[i] <= 1;
  }
  if (!good) return fail(key, "three numbers from 0 to 1 are wanted here"), fallback;
  return out;
}

std::vector<std::string> JsonReader::texts(const char* key) {
  const nlohmann::json* found = find(key, true);
  std::vector<std::string> out;
  if (!found) return out;
  bool good = found->is_array();
  for (std::size_t i = 0; good && i < found->size(); ++i) {
    good = (*found)[i].is_string();
    if (good) out.push_back((*found)[i].get<std::string>());
  }
  if (!good) fail(key, "a list of texts is wanted here");
  return out;
}

std::vector<std::uint32_t> JsonReader::integers(const char* key) {
  const nlohmann::json* found = find(key, true);
  if (!found) return {};
  const auto values =
      found->is_string() ? decodeIntegers(found->get_ref<const std::string&>()) : std::nullopt;
  if (!values)
    return fail(key, "an array of whole numbers (\"u8:\", \"u16:\" or \"u32:\" and base64) is wanted here"),
           std::vector<std::uint32_t>{};
  return *values;
}

std::vector<double> JsonReader::doubles(const char* key) {
  const nlohmann::json* found = find(key, true);
  if (!found) return {};
  const auto values = found->is_string() ? decodeDoubles(found->get_ref<const std::string&>()) : std::nullopt;
  if (!values)
    return fail(key, "an array of numbers (\"f64:\" and base64) is wanted here"), std::vector<double>{};
  for (std::size_t i = 0; i < values->size(); ++i) {
    if (!std::isfinite((*values)[i])) {
      return fail(key, "value " + std::to_string(i) + " is not finite"), std::vector<double>{};
    }
  }
  return *values;
}

}  // namespace coif::scene
