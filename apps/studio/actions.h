// What the studio does by itself, beside the document's commands: files, views, tools. With the commands this
// is the one list from which menus, palette and keys come.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace coif::studio {

struct Action {
  std::string name;   ///< snake_case: "view_front"; what the key map names
  std::string label;  ///< "Front"
  std::string menu;   ///< "View", or "View/Look from" for a menu inside it
  std::string key;    ///< Blender's habit; several with spaces between; empty for none
  std::string help;   ///< one sentence
  std::function<void()> act = {};
  std::function<bool()> ticked = {};          ///< of a switch
  std::function<std::string()> refusal = {};  ///< why not now, in a sentence; empty: now
};

/// A command of the document or an action of the studio: a line of a menu or of the palette.
struct MenuEntry {
  std::string name, label, menu, key, help;
  const Action* action = nullptr;  ///< null: a command
};

}  // namespace coif::studio
