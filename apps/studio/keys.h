// Keys as menus write them: "E", "Ctrl+Shift+Z", "NumpadAdd", "Home".
#pragma once

#include <string>
#include <vector>

namespace coif::studio {

/// What went down since the last frame, as the window's queue hands it out.
class Keys {
 public:
  void down(int key, int modifiers) { downs_.push_back({key, modifiers, 0}); }
  void character(unsigned codepoint) { downs_.push_back({0, 0, codepoint}); }
  /// What was typed of "0 … 9 . -", and Tab as '\t' and Backspace as '\b', in order.
  std::string typed() const;
  /// The last combination that went down, as menus write it; empty: none that has a name.
  std::string lastName() const;
  bool none() const { return downs_.empty(); }
  void clear() { downs_.clear(); }
  /// Whether one of the combinations (spaces between) went down, with just these modifiers.
  bool pressed(const std::string& keys) const;

 private:
  bool pressedOne(const std::string& key) const;
  struct Down {
    int key, modifiers;
    unsigned character;  // of a character as the keyboard's layout has it; then there is no key
  };
  std::vector<Down> downs_;
};

}  // namespace coif::studio
