#include "input_queue.h"

#include <GLFW/glfw3.h>

#include <algorithm>

namespace coif::studio {
namespace {

using Event = InputQueue::Event;

bool isModifier(int key) {
  return key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER;
}

bool isShift(int key) {
  return key == GLFW_KEY_LEFT_SHIFT || key == GLFW_KEY_RIGHT_SHIFT;
}

/// A key that types a character and does nothing else.
bool isText(const Event& event) {
  return event.code >= GLFW_KEY_SPACE && event.code <= GLFW_KEY_WORLD_2 &&
         (event.modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) == 0;
}

}  // namespace

void InputQueue::push(const Event& event) {
  using Kind = Event::Kind;
  if (!events_.empty() && events_.back().kind == event.kind) {
    if (event.kind == Kind::Move) events_.pop_back();
    if (event.kind == Kind::Wheel) {
      events_.back().x += event.x, events_.back().y += event.y;
      return;
    }
  }
  events_.push_back(event);
}

void InputQueue::pushRepeat(const Event& key) {
  if (events_.empty()) events_.push_back(key);
}

bool InputQueue::fits(const Event& event, const Given& given, bool typing) const {
  const bool keysSettled = sinceKey_ >= kSettleFrames;
  const bool settled = keysSettled && sinceButton_ >= kSettleFrames;
  switch (event.kind) {
    case Event::Kind::Move:
      return !given.button && !given.key;  // the key may have begun what the mouse then does
    case Event::Kind::Wheel:
      return !given.button && !given.key;
    case Event::Kind::Button:
      // Where the pointer is was seen before; what is pressed may have been opened by a key.
      return !given.button && !given.key && !given.move && !given.wheel && (!event.down || keysSettled);
    case Event::Kind::Character:
      return true;  // it follows its key
    case Event::Kind::Key:
      break;
  }
  if (given.button || given.key) return false;
  if (isModifier(event.code)) return (typing && isShift(event.code)) || (!given.text && !given.wheel);
  if (typing && isText(event)) return !event.down || settled;
  return !given.text && (!event.down || settled);
}

std::vector<Event> InputQueue::next(bool typing) {
  std::vector<Event> out;
  Given given;
  sinceKey_ = std::min(sinceKey_ + 1, kSettleFrames);
  sinceButton_ = std::min(sinceButton_ + 1, kSettleFrames);
  while (!events_.empty() && fits(events_.front(), given, typing)) {
    const Event event = events_.front();
    events_.pop_front();
    out.push_back(event);
    switch (event.kind) {
      case Event::Kind::Move:
        given.move = true;
        break;
      case Event::Kind::Wheel:
        given.wheel = true;
        break;
      case Event::Kind::Character:
        break;
      case Event::Kind::Button:
        given.button = true;
        if (event.down) sinceButton_ = 0;
        break;
      case Event::Kind::Key:
        if (isModifier(event.code)) break;
        (typing && isText(event) ? given.text : given.key) = true;
        if (given.key && event.down) sinceKey_ = 0;
    }
  }
  return out;
}

}  // namespace coif::studio
