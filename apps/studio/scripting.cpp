// What Python asks of the studio, from the console inside or from the process that opened it.
#include <fstream>

#include "coif/io/safe_file.h"
#include "studio.h"

namespace coif::studio {
namespace {

using nlohmann::json;

/// A JSON value as the argument wants it. Errors: InvalidArgument.
Result<CommandValue> valueOf(const json& given, const CommandArgument& argument) {
  const auto numbers = [](const json& list) {
    return list.is_array() && std::ranges::all_of(list, [](const json& v) { return v.is_number(); });
  };
  switch (argument.kind) {
    case ArgumentKind::Flag:
      if (given.is_boolean()) return CommandValue(given.get<bool>());
      break;
    case ArgumentKind::Number:
    case ArgumentKind::Integer:
      if (given.is_number()) return CommandValue(given.get<double>());
      break;
    case ArgumentKind::Choice:
    case ArgumentKind::Text:
      if (given.is_string()) return CommandValue(given.get<std::string>());
      break;
    case ArgumentKind::Vector:
      if (numbers(given) && given.size() == 3) return CommandValue(Vec3(given[0], given[1], given[2]));
      break;
    case ArgumentKind::Numbers:
      if (numbers(given)) return CommandValue(given.get<std::vector<double>>());
      break;
  }
  return makeError(ErrorCode::InvalidArgument, argument.name + " is of the wrong kind");
}

Result<CommandArguments> argumentsOf(const CommandInfo& info, const json& given) {
  CommandArguments out;
  for (const auto& [name, value] : given.items()) {
    const auto argument = std::ranges::find(info.arguments, name, &CommandArgument::name);
    if (argument == info.arguments.end())
      return makeError(ErrorCode::InvalidArgument, info.name + " has no argument '" + name + "'");
    COIF_ASSIGN(out[name], valueOf(value, *argument));
  }
  return out;
}

json idsOf(const auto& ids) {
  json out = json::array();
  for (const auto id : ids) out.push_back(std::uint32_t(id));
  return out;
}

}  // namespace

std::vector<Action> Studio::pythonActions() {
  return {
      {"console", "Python console", "Python", "F4", "Shows or hides the console.",
       [this] {
         settings_.console = !settings_.console;
         if (settings_.console) typedAt_ = kNextLine;
         (void)settings_.save();
       },
       [this] { return settings_.console; }},
      {"run_script", "Run a script ...", "Python", "Ctrl+P", "Runs a file of Python on the open document.",
       [this] { askPath(PathUse::RunScript); }},
      {"stop_script",
       "Stop",
       "Python",
       "Ctrl+Shift+P",
       "Interrupts the script; a second time ends Python.",
       [this] { console_.stop(); },
       {},
       [this] { return console_.busy() ? std::string() : "no script is running"; }},
  };
}

void Studio::takeScripts() {
  for (json& message : console_.poll()) {
    requests_.push_back({std::move(message), [this](const json& reply) { console_.answer(reply); }});
  }
  if (channel_) {
    for (json& message : channel_->take()) {
      requests_.push_back({std::move(message), [this](const json& reply) { channel_->send(reply); }});
    }
    if (channel_->closed() && requests_.empty()) channel_.reset();
  }
  // In order, and each after what was begun before it is done.
  restedFrames_ = fine_ && !pictures_->busy() ? restedFrames_ + 1 : 0;
  while (!job_.busy() && !requests_.empty()) {
    const bool waits = requests_.front().message.contains("rest") && document_;
    if (waits && restedFrames_ < 3) {  // the picture is taken in one frame and drawn in the next
      window_.wakeWithin(0.05);
      break;
    }
    const Request request = std::move(requests_.front());
    requests_.erase(requests_.begin());
    answer(request);
  }
  if (document_ && !job_.busy() && !options_.script.empty()) runScript(std::exchange(options_.script, {}));
}

void Studio::answer(const Request& request) {
  const json& m = request.message;
  const auto reply = [id = m.value("id", 0), send = request.answer](const std::string& problem,
                                                                    const json& value = nullptr) {
    problem.empty() ? send({{"id", id}, {"value", value}}) : send({{"id", id}, {"error", problem}});
  };
  const auto asText = [&](const char* key) { return m[key].is_string() ? m[key].get<std::string>() : ""; };
  // A file's fate is told in the status line; its problem, if any, is the answer.
  const auto afterJob = [this, reply] {
    requests_.insert(requests_.begin(), {json{{"id", 0}, {"finish", true}}, [this, reply](const json&) {
                                           reply(messageIsProblem_ ? message_ : "");
                                         }});
  };
  if (m.contains("finish")) return reply("");
  if (m.contains("open")) {
    openPath(asText("open"), options_.style);
    return afterJob();
  }
  if (m.contains("act")) {
    const auto action = std::ranges::find(actions_, asText("act"), &Action::name);
    if (action == actions_.end()) return reply("there is no action '" + asText("act") + "'");
    const std::string why = action->refusal ? action->refusal() : "";
    if (why.empty()) action->act();
    return reply(why);
  }
  if (m.contains("rest")) return reply("");
  if (m.contains("close")) {
    if (document_) document_->forgetAutosave();
    quit_ = true;
    return reply("");
  }
  if (m.contains("screenshot")) {
    pathUse_ = PathUse::Screenshot;
    usePath(asText("screenshot"));
    return reply(messageIsProblem_ ? message_ : "");
  }
  if (!document_) return reply(message_.empty() ? "no document is open" : message_);
  if (m.contains("run")) {
    const CommandInfo* info = findCommand(asText("run"));
    if (info == nullptr) return reply("there is no command '" + asText("run") + "'");
    const auto arguments = argumentsOf(*info, m.value("arguments", json::object()));
    if (!arguments.ok()) return reply(info->name + ": " + arguments.error().text());
    tool_.reset(), forgetAttempt();
    return run(info->name, *arguments, [reply](const std::string& problem) { reply(problem); });
  }
  if (m.contains("state")) return reply("", stateFor(asText("state")));
  if (m.contains("write")) {
    Scene copy = document_->editor.scene();
    if (!copy.head.path.empty())
      copy.head.path = std::filesystem::absolute(document_->editor.scene().headPath());
    const Status written = saveScene(copy, asText("write"));
    return reply(written.ok() ? "" : written.error().text());
  }
  if (m.contains("save")) {
    const std::filesystem::path path =
        asText("save").empty() ? document_->path : std::filesystem::path(asText("save"));
    if (path.empty()) return reply("the document has no name yet: save(path)");
    saveTo(path);
    return reply(messageIsProblem_ ? message_ : "");
  }
  if (m.contains("export")) {
    exportTo(asText("export"));
    return afterJob();
  }
  reply("this is no request that the studio knows");
}

json Studio::stateFor(const std::string& what) const {
  const Editor& editor = document_->editor;
  if (what == "selected_vertices") return idsOf(editor.state().selection.vertices);
  if (what == "selected_bundles") return idsOf(selectedBundles(editor.mesh(), editor.state().selection));
  if (what == "steps") return editor.stepLabels();
  if (what == "undo_count") return editor.undoCount();
  if (what == "modified") return editor.modified();
  if (what == "python_log") return editor.pythonLog();
  if (what == "title") return document_->title();
  return nullptr;
}

void Studio::runScript(const std::filesystem::path& path) {
  const auto bytes = readFile(path, 1 << 24);
  if (!bytes.ok()) return say(bytes.error().text(), true);
  settings_.console = true;
  console_.execute(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()), path.string());
  say("running " + path.filename().string());
}

}  // namespace coif::studio
