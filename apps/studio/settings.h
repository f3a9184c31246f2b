// What the studio remembers between runs: recent files, theme, habits, keys.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "coif/base/result.h"

namespace coif::studio {

struct Settings {
  std::vector<std::string> recent;          ///< newest first, at most ten
  std::map<std::string, std::string> keys;  ///< command → key, where it is not the default
  bool lightTheme = false, mayaMouse = false, console = false, tourSeen = false;
  int width = 1280, height = 800;         ///< of the window, pixels
  std::map<std::string, bool> open = {};  ///< which panels are
  float consoleHeight = 170;              ///< at a scale of 1

  static Settings load();  ///< defaults where there is none or it cannot be understood
  Status save() const;
  void addRecent(const std::filesystem::path& path);
  /// The artist's own, else the habit's, else `standard`.
  std::string keyOf(const std::string& name, const std::string& standard) const;
};

}  // namespace coif::studio
