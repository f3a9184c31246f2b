// Checked access to a JSON document: every fault names its path ("hairMesh.bundles.vertices").
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif::scene {

/// Reads members of one object. The first fault is kept; later reads return defaults, so callers test once.
class JsonReader {
 public:
  explicit JsonReader(const nlohmann::json& value) : JsonReader(value, "", fault_) {}

  JsonReader object(const char* key);
  std::vector<JsonReader> objects(const char* key);  ///< a list, required
  std::vector<std::string> keys() const;
  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  std::string text(const char* key, const std::string& fallback);
  std::string requiredText(const char* key);
  double number(const char* key, double fallback, double lo, double hi);
  std::uint64_t integer(const char* key, std::uint64_t fallback, std::uint64_t lo, std::uint64_t hi);
  Vec3f color(const char* key, const Vec3f& fallback);
  std::vector<std::string> texts(const char* key);
  std::vector<std::uint32_t> integers(const char* key);  ///< typed array, required
  std::vector<double> doubles(const char* key);          ///< typed array of finite values, required

  void fail(const char* key, const std::string& message);
  Status status() const;

 private:
  JsonReader(const nlohmann::json& value, std::string path, std::optional<Error>& fault)
      : value_(&value), path_(std::move(path)), sharedFault_(&fault) {}
  const nlohmann::json* find(const char* key, bool required);

  const nlohmann::json* value_;
  std::string path_;
  std::optional<Error> fault_;
  std::optional<Error>* sharedFault_;
};

}  // namespace coif::scene
