// What the studio remembers between runs: recent files, theme, habits, keys.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "window.h"

namespace coif::studio {

struct Settings {
  std::vector<std::string> recent;          ///< newest first, at most ten
  std::map<std::string, std::string> keys;  ///< command → key, where it is not the default
  bool lightTheme = false, mayaMouse = false, console = false, tourSeen = false;
  Window::Place window;
  std::map<std::string, bool> open = {};                         ///< which panels are
  float consoleHeight = 170, leftPanel = 190, rightPanel = 300;  ///< at a scale of 1

  static Settings load();  ///< defaults where there is none or it cannot be understood
  Status save() const;
  void addRecent(const std::filesystem::path& path);
  /// The artist's own, else the habit's, else `standard`.
  std::string keyOf(const std::string& name, const std::string& standard) const;
};

}  // namespace coif::studio
