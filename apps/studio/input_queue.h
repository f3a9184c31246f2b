// What keyboard and mouse did, in order, until the window's frames have seen it.
#pragma once

#include <deque>
#include <vector>

namespace coif::studio {

/// In a slow frame a key goes down and up again, the next one follows, the mouse presses, moves and lets go.
/// Handed out all at once, the first would be lost and the second be meant for what the first has yet to
/// open. So each frame is handed as much as it can tell apart: one key or one button, text that is being
/// typed and moves of the mouse as they come; and after a key or a button the keyboard waits until what it
/// opened has taken the keyboard.
class InputQueue {
 public:
  struct Event {
    enum class Kind { Key, Character, Button, Move, Wheel } kind = Kind::Move;
    int code = 0;         ///< key or button as GLFW numbers them, or codepoint
    int scancode = 0;     ///< of a key
    int modifiers = 0;    ///< of a key or button, GLFW's bits
    bool down = false;    ///< of a key or button
    double x = 0, y = 0;  ///< place in the window, or steps of the wheel
  };

  void push(const Event& event);
  /// A key that is held repeats by itself: no use where frames are slower than it does.
  void pushRepeat(const Event& key);
  /// What the next frame may see. typing: a text field has the keyboard.
  std::vector<Event> next(bool typing);
  bool empty() const { return events_.empty(); }
  void clear() { *this = {}; }

 private:
  // A field asks for the keyboard while it is first drawn, has it in the frame after, and says so in the
  // third.
  static constexpr int kSettleFrames = 3;
  struct Given {
    bool key = false, text = false, button = false, move = false, wheel = false;
  };
  bool fits(const Event& event, const Given& given, bool typing) const;
  std::deque<Event> events_;
  int sinceKey_ = kSettleFrames, sinceButton_ = kSettleFrames;  // frames
};

}  // namespace coif::studio
