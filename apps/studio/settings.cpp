#include "settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coif/io/safe_file.h"
#include "coif/scene/command.h"
#include "document.h"

namespace coif::studio {
namespace {

std::filesystem::path settingsFile() {
  return stateFolder() / "studio.json";
}

}  // namespace

Settings Settings::load() {
  Settings out;
  const auto bytes = readFile(settingsFile(), 1 << 20);
  if (!bytes.ok()) return out;
  const char* text = reinterpret_cast<const char*>(bytes->data());
  try {
    const auto json = nlohmann::json::parse(text, text + bytes->size());
    out.recent = json.value("recent", out.recent);
    out.keys = json.value("keys", out.keys);
    out.lightTheme = json.value("lightTheme", false);
    out.mayaMouse = json.value("mayaMouse", false);
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return out;
}

Status Settings::save() const {
  std::error_code ignored;
  std::filesystem::create_directories(stateFolder(), ignored);
  COIF_ASSIGN(auto file, SafeFile::create(settingsFile()));
  file.write(
      nlohmann::json{{"recent", recent}, {"keys", keys}, {"lightTheme", lightTheme}, {"mayaMouse", mayaMouse}}
          .dump(2));
  return file.commit();
}

void Settings::addRecent(const std::filesystem::path& path) {
  const std::string text = std::filesystem::absolute(path).string();
  std::erase(recent, text);
  recent.insert(recent.begin(), text);
  if (recent.size() > 10) recent.resize(10);
}

std::string Settings::keyOf(const std::string& command) const {
  if (const auto own = keys.find(command); own != keys.end()) return own->second;
  const CommandInfo* info = findCommand(command);
  return info == nullptr ? std::string() : info->key;
}

}  // namespace coif::studio
