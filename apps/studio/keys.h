// Keys as menus write them: "E", "Ctrl+Shift+Z", "NumpadAdd", "Home".
#pragma once

#include <string>
#include <vector>

namespace coif::studio {

/// What went down since the last frame. Fed by the window's own key events, not by the keys' state once a
/// frame: in a slow frame a key may go down and up again.
class Keys {
 public:
  void down(int key, int modifiers) { downs_.push_back({key, modifiers}); }
  void clear() { downs_.clear(); }
  /// Whether the combination went down, with just these modifiers.
  bool pressed(const std::string& key) const;

 private:
  struct Down {
    int key, modifiers;
  };
  std::vector<Down> downs_;
};

/// 0 … 9, '.' and '-' typed in this frame, for numbers typed while a tool runs.
std::string typedNumber();

}  // namespace coif::studio
