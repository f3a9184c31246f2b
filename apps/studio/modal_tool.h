// A tool that follows mouse and keys until it is confirmed or dropped. It only ever fills in a command's
// arguments; what the command would do is shown meanwhile.
#pragma once

#include <string>

#include "keys.h"
#include "tool_settings.h"
#include "viewport.h"

namespace coif::studio {

class ModalTool {
 public:
  virtual ~ModalTool() = default;
  /// Follows this frame's mouse and keys.
  virtual void update(const Viewport& view, const Keys& keys) = 0;
  virtual std::string command() const = 0;
  virtual CommandArguments arguments() const = 0;
  virtual std::string status() const = 0;           ///< what is going on and which keys help
  virtual std::string label() const { return {}; }  ///< the numbers, beside the mouse
  virtual void draw(const Viewport&) const {}
  virtual bool usesWheel() const { return false; }  ///< then it does not zoom
  bool confirmed() const { return confirmed_; }
  bool dropped() const { return dropped_; }

 protected:
  /// Enter or the left button confirm, Escape or the right button drop; a tool that began with a press is
  /// confirmed by the release.
  void takeEnd(const Keys& keys, bool byRelease) {
    const ImGuiIO& io = ImGui::GetIO();
    confirmed_ = keys.pressed("Enter") ||
                 (byRelease ? !io.MouseDown[0] : ImGui::IsMouseClicked(0) && !io.WantCaptureMouse);
    dropped_ = keys.pressed("Escape") || ImGui::IsMouseClicked(1);
  }
  void confirm() { confirmed_ = true; }
  void dropConfirmation() { confirmed_ = false; }

 private:
  bool confirmed_ = false, dropped_ = false;
};

/// Numbers typed while a tool runs: digits, '.', '-', Backspace; Tab begins the next one.
class TypedNumbers {
 public:
  void take(const Keys& keys);
  bool any() const { return !texts_[0].empty() || at_ > 0; }
  double number(std::size_t i) const;
  std::string text() const;

 private:
  std::string texts_[3];
  std::size_t at_ = 0;
};

}  // namespace coif::studio
