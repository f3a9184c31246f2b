#include "settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coif/io/safe_file.h"
#include "document.h"

namespace coif::studio {
namespace {

std::filesystem::path settingsFile() {
  return stateFolder() / "studio.json";
}

/// Where Maya's keys are others than Blender's.
const std::map<std::string, std::string>& mayaKeys() {
  static const std::map<std::string, std::string> keys = {
      {"kind_vertex", "F9"},
      {"kind_edge", "F10"},
      {"kind_face", "F11"},
      {"extrude", "Ctrl+E"},
      {"divide_edges", "Alt+E"},
      {"frame_all", "A"},
      {"select_all", "Ctrl+Shift+A"},
      {"hide", "Ctrl+H"},
      {"show_all", "Ctrl+Shift+H"},
      {"undo", "Ctrl+Z"},
      {"redo", "Ctrl+Y Shift+Z"},
      {"weld_edges", "Shift+M"},
      {"mesh_next", "4"},
      {"kind_bundle", "F8"},
      {"kind_layer", ""},
      {"kind_group", ""},
      {"hand_select", "Q Escape"},
      {"hand_move", "W"},
      {"hand_rotate", "E"},
      {"hand_scale", "R"},
      {"rotate", "Shift+T"},
      {"scale", "Shift+Y"},
      {"soft_selection", "B"},
      {"shade_dual", "Ctrl+F8"},
      {"color_next", "5"},
  };
  return keys;
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
    out.console = json.value("console", false);
    out.open = json.value("open", out.open);
    Window::Place& at = out.window;
    at.width = std::clamp(json.value("width", at.width), 200, 16384);
    at.height = std::clamp(json.value("height", at.height), 100, 16384);
    at.x = std::clamp(json.value("x", at.x), -1, 16384);
    at.y = std::clamp(json.value("y", at.y), -1, 16384);
    at.maximised = json.value("maximised", false);
    out.tourSeen = json.value("tourSeen", false);
    out.consoleHeight = std::clamp(json.value("consoleHeight", out.consoleHeight), 60.0f, 2000.0f);
    out.leftPanel = std::clamp(json.value("leftPanel", out.leftPanel), 180.0f, 2000.0f);
    out.rightPanel = std::clamp(json.value("rightPanel", out.rightPanel), 180.0f, 2000.0f);
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return out;
}

Status Settings::save() const {
  std::error_code ignored;
  std::filesystem::create_directories(stateFolder(), ignored);
  COIF_ASSIGN(auto file, SafeFile::create(settingsFile()));
  file.write(nlohmann::json{{"recent", recent},
                            {"keys", keys},
                            {"lightTheme", lightTheme},
                            {"mayaMouse", mayaMouse},
                            {"console", console},
                            {"open", open},
                            {"width", window.width},
                            {"height", window.height},
                            {"x", window.x},
                            {"y", window.y},
                            {"maximised", window.maximised},
                            {"leftPanel", leftPanel},
                            {"rightPanel", rightPanel},
                            {"tourSeen", tourSeen},
                            {"consoleHeight", consoleHeight}}
                 .dump(2));
  return file.commit();
}

void Settings::addRecent(const std::filesystem::path& path) {
  const std::string text = std::filesystem::absolute(path).string();
  std::erase(recent, text);
  recent.insert(recent.begin(), text);
  if (recent.size() > 10) recent.resize(10);
}

std::string Settings::keyOf(const std::string& name, const std::string& standard) const {
  if (const auto own = keys.find(name); own != keys.end()) return own->second;
  if (mayaMouse) {
    if (const auto habit = mayaKeys().find(name); habit != mayaKeys().end()) return habit->second;
  }
  return standard;
}

}  // namespace coif::studio
