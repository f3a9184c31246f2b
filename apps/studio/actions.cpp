// The studio's own actions, and how an entry of a menu, the palette or the key map is carried out.
#include "actions.h"

#include <nlohmann/json.hpp>

#include "studio.h"

namespace coif::studio {
namespace {

const std::string kNoDocument = "no document is open";

}  // namespace

std::vector<Action> Studio::makeActions() {
  std::vector<Action> list;
  for (auto part :
       {&Studio::fileActions, &Studio::selectActions, &Studio::toolActions, &Studio::viewActions,
        &Studio::styleActions, &Studio::motionActions, &Studio::pythonActions, &Studio::helpActions}) {
    for (Action& action : (this->*part)()) list.push_back(std::move(action));
  }
  return list;
}

std::vector<Action> Studio::fileActions() {
  const auto noDocument = [this] { return document_ ? std::string() : kNoDocument; };
  const auto ask = [this](PathUse use) { return [this, use] { askPath(use); }; };
  return {
      {"open", "Open ...", "File", "Ctrl+O", "Opens a head or a .coif document.", ask(PathUse::Open)},
      {"save",
       "Save",
       "File",
       "Ctrl+S",
       "Writes the document.",
       [this] { document_ && !document_->path.empty() ? saveTo(document_->path) : askPath(PathUse::SaveAs); },
       {},
       noDocument},
      {"save_as",
       "Save as ...",
       "File",
       "Ctrl+Shift+S",
       "Writes the document to another file.",
       ask(PathUse::SaveAs),
       {},
       noDocument},
      {"export",
       "Export ...",
       "File",
       "Ctrl+Shift+E",
       "Writes strands as USD, glTF or .hair.",
       [this] { exportOpen_ = true; },
       {},
       noDocument},
      {"screenshot", "Screenshot ...", "File", "F12", "Writes a picture of the window.",
       ask(PathUse::Screenshot)},
      {"write_turntable",
       "Turntable ...",
       "File",
       "Ctrl+F12",
       "Writes pictures from all around.",
       ask(PathUse::Turntable),
       {},
       noDocument},
      {"cancel",
       "Cancel what runs",
       "File",
       "Ctrl+.",
       "Stops a command, an opening or an export that takes its time.",
       [this] { job_.cancel(); },
       {},
       [this] { return job_.busy() ? std::string() : std::string("nothing runs"); }},
      {"quit", "Quit", "File", "Ctrl+Q", "Ends the studio.", [this] { mayClose(); }},
  };
}

std::vector<Action> Studio::selectActions() {
  std::vector<Action> list;
  const auto add = [&](const char* name, const char* label, const char* key, const char* help,
                       SelectKind kind) {
    list.push_back({name, label, "Select/By", key, help, [this, kind] { view_.settings.kind = kind; },
                    [this, kind] { return view_.settings.kind == kind; }});
  };
  list.push_back({"select_by_id",
                  "By id ...",
                  "Select",
                  "Ctrl+Shift+I",
                  "Selects elements by their numbers.",
                  [this] { idsAsked_ = true, idsText_.clear(); },
                  {},
                  [this] { return document_ ? std::string() : kNoDocument; }});
  add("kind_vertex", "Vertices", "1", "A click selects a vertex.", SelectKind::Vertex);
  add("kind_edge", "Edges", "2", "A click selects an edge.", SelectKind::Edge);
  add("kind_face", "Faces", "3", "A click selects a face.", SelectKind::Face);
  add("kind_bundle", "Bundles", "4", "A click selects a bundle, root to tip.", SelectKind::Bundle);
  add("kind_layer", "Layers", "5", "A click selects a whole layer.", SelectKind::Layer);
  add("kind_group", "Groups", "6", "A click selects a group's bundles.", SelectKind::Group);
  return list;
}

std::vector<Action> Studio::helpActions() {
  return {
      {"palette", "Find a command ...", "Help", "F3 Ctrl+Space", "Finds any command by its name.",
       [this] { paletteOpen_ = true, paletteText_.clear(); }},
      {"tour", "Guided tour", "Help", "F1", "The editor in two minutes.",
       [this] { tourOpen_ = true, tourStep_ = 0; }},
      {"key_map", "Keys ...", "Help", "Ctrl+F1", "Shows and changes the keys.",
       [this] { keyMapOpen_ = true; }},
  };
}

std::vector<MenuEntry> Studio::entries() const {
  std::vector<MenuEntry> list;
  const auto addAction = [&](const Action& a) {
    list.push_back({a.name, a.label, a.menu, keyOf(a.name), a.help, &a});
  };
  const auto inFile = [](const Action& a) { return a.menu.starts_with("File"); };
  for (const Action& action : actions_) {
    if (inFile(action)) addAction(action);
  }
  for (const CommandInfo& c : commandInfos()) {
    list.push_back({c.name, c.label, c.menu, keyOf(c.name), c.help, nullptr});
  }
  for (const Action& action : actions_) {
    if (!inFile(action)) addAction(action);
  }
  return list;
}

std::string Studio::keyOf(const std::string& name) const {
  if (const CommandInfo* info = findCommand(name)) return settings_.keyOf(name, info->key);
  for (const Action& action : actions_) {
    if (action.name == name) return settings_.keyOf(name, action.key);
  }
  return {};
}

std::string Studio::refusalOf(const MenuEntry& entry) const {
  if (entry.action != nullptr) return entry.action->refusal ? entry.action->refusal() : std::string();
  return document_ ? document_->editor.refusal(entry.name) : kNoDocument;
}

void Studio::carryOut(const MenuEntry& entry) {
  if (const std::string why = refusalOf(entry); !why.empty()) return say(why, true);
  entry.action != nullptr ? entry.action->act() : begin(entry.name);
}

std::string Studio::commandList() const {
  auto out = nlohmann::json::array();
  for (const MenuEntry& entry : entries()) {
    out.push_back({{"name", entry.name},
                   {"label", entry.label},
                   {"menu", entry.menu},
                   {"key", entry.key},
                   {"help", entry.help},
                   {"kind", entry.action != nullptr ? "action" : "command"}});
  }
  return out.dump(1);
}

}  // namespace coif::studio
