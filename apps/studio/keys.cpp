#include "keys.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <map>

namespace coif::studio {
namespace {

const std::map<std::string, int>& namedKeys() {
  static const std::map<std::string, int> named = {{"NumpadAdd", GLFW_KEY_KP_ADD},
                                                   {"NumpadSubtract", GLFW_KEY_KP_SUBTRACT},
                                                   {"NumpadDecimal", GLFW_KEY_KP_DECIMAL},
                                                   {"Home", GLFW_KEY_HOME},
                                                   {"Tab", GLFW_KEY_TAB},
                                                   {"Escape", GLFW_KEY_ESCAPE},
                                                   {"Enter", GLFW_KEY_ENTER},
                                                   {"Up", GLFW_KEY_UP},
                                                   {"Down", GLFW_KEY_DOWN},
                                                   {"Space", GLFW_KEY_SPACE},
                                                   {"Delete", GLFW_KEY_DELETE},
                                                   {"Backspace", GLFW_KEY_BACKSPACE}};
  return named;
}

int codeOf(const std::string& name) {
  const auto& named = namedKeys();
  if (const auto found = named.find(name); found != named.end()) return found->second;
  if (name.size() == 7 && name.starts_with("Numpad")) return GLFW_KEY_KP_0 + (name.back() - '0');
  if (name.size() == 1) return name.front();  // GLFW's codes of letters and digits are their ASCII codes
  if (name.size() > 1 && name.front() == 'F') return GLFW_KEY_F1 + std::stoi(name.substr(1)) - 1;
  return GLFW_KEY_UNKNOWN;
}

}  // namespace

bool Keys::pressed(const std::string& keys) const {
  if (downs_.empty()) return false;
  for (std::size_t from = 0, to; from < keys.size(); from = to + 1) {
    to = std::min(keys.find(' ', from), keys.size());
    if (pressedOne(keys.substr(from, to - from))) return true;
  }
  return false;
}

bool Keys::pressedOne(const std::string& key) const {
  int modifiers = 0;
  std::size_t from = 0;
  for (std::size_t plus; (plus = key.find('+', from)) != std::string::npos; from = plus + 1) {
    const std::string modifier = key.substr(from, plus - from);
    modifiers |= modifier == "Ctrl" ? GLFW_MOD_CONTROL : modifier == "Shift" ? GLFW_MOD_SHIFT : GLFW_MOD_ALT;
  }
  const int code = codeOf(key.substr(from));
  return code != GLFW_KEY_UNKNOWN && std::ranges::any_of(downs_, [&](const Down& d) {
           return d.key == code && d.modifiers == modifiers;
         });
}

std::string Keys::lastName() const {
  const auto down =
      std::ranges::find_if(downs_.rbegin(), downs_.rend(), [](const Down& d) { return d.key != 0; });
  if (down == downs_.rend()) return {};
  std::string name;
  const auto& named = namedKeys();
  const auto known =
      std::ranges::find_if(named, [&](const auto& entry) { return entry.second == down->key; });
  if (known != named.end()) {
    name = known->first;
  } else if (down->key >= GLFW_KEY_F1 && down->key <= GLFW_KEY_F25) {
    name = "F" + std::to_string(down->key - GLFW_KEY_F1 + 1);
  } else if (down->key >= GLFW_KEY_KP_0 && down->key <= GLFW_KEY_KP_9) {
    name = "Numpad" + std::to_string(down->key - GLFW_KEY_KP_0);
  } else if (down->key > ' ' && down->key < 128) {
    name = std::string(1, char(down->key));
  } else {
    return {};
  }
  return std::string(down->modifiers & GLFW_MOD_CONTROL ? "Ctrl+" : "") +
         (down->modifiers & GLFW_MOD_SHIFT ? "Shift+" : "") + (down->modifiers & GLFW_MOD_ALT ? "Alt+" : "") +
         name;
}

std::string Keys::typed() const {
  std::string out;
  for (const Down& d : downs_) {
    if (d.character != 0 && d.character < 128 &&
        std::string("0123456789.-").find(char(d.character)) != std::string::npos)
      out += char(d.character);
    if (d.key == GLFW_KEY_TAB && d.modifiers == 0) out += '\t';
    if (d.key == GLFW_KEY_BACKSPACE) out += '\b';
  }
  return out;
}

}  // namespace coif::studio
