#include "scene/editor/command_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace coif {
namespace editor {

CommandArgument number(std::string name, double standard, double least, double most, std::string help) {
  return {std::move(name), ArgumentKind::Number, standard, least, most, {}, std::move(help)};
}
CommandArgument integer(std::string name, double standard, double least, double most, std::string help) {
  return {std::move(name), ArgumentKind::Integer, standard, least, most, {}, std::move(help)};
}
CommandArgument flag(std::string name, bool standard, std::string help) {
  return {std::move(name), ArgumentKind::Flag, standard, 0, 1, {}, std::move(help)};
}
CommandArgument choice(std::string name, std::vector<std::string> choices, std::string help) {
  const CommandValue first = choices.front();
  return {std::move(name), ArgumentKind::Choice, first, 0, 0, std::move(choices), std::move(help)};
}
CommandArgument vector(std::string name, const Vec3& standard, std::string help) {
  return {std::move(name), ArgumentKind::Vector, standard, -1e30, 1e30, {}, std::move(help)};
}
CommandArgument text(std::string name, std::string standard, std::string help) {
  return {std::move(name), ArgumentKind::Text, std::move(standard), 0, 0, {}, std::move(help)};
}
CommandArgument numbers(std::string name, std::string help) {
  return {std::move(name), ArgumentKind::Numbers, std::vector<double>{}, -1e30, 1e30, {}, std::move(help)};
}

const std::vector<Command>& commands() {
  static const std::vector<Command> all = [] {
    std::vector<Command> list;
    list.push_back({{"undo", "Undo", "Edit", "Ctrl+Z", "Takes the last step back."}, {}});
    list.push_back({{"redo", "Redo", "Edit", "Ctrl+Shift+Z", "Does the step taken back again."}, {}});
    for (auto part : {selectCommands, meshCommands, moveCommands, brushCommands, settingCommands,
                      styleCommands, motionCommands, fileCommands}) {
      for (Command& command : part()) list.push_back(std::move(command));
    }
    return list;
  }();
  return all;
}

const Command* find(std::string_view name) {
  const auto& all = commands();
  const auto found = std::ranges::find_if(all, [&](const Command& c) { return c.info.name == name; });
  return found == all.end() ? nullptr : &*found;
}

namespace {

/// Why a value does not do; empty when it does.
std::string faultOf(const CommandArgument& argument, const CommandValue& value) {
  if (value.index() != argument.standard.index()) return "is of the wrong kind";
  const auto outside = [&](double v) { return !(v >= argument.least && v <= argument.most); };
  if (const auto* v = std::get_if<double>(&value)) {
    if (outside(*v)) {
      if (!std::isfinite(*v)) return "must be finite";
      char range[64];
      std::snprintf(range, sizeof range, "must lie between %g and %g", argument.least, argument.most);
      return range;
    }
    if (argument.kind == ArgumentKind::Integer && *v != std::floor(*v)) return "must be a whole number";
  } else if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    if (std::ranges::any_of(*list, outside)) return "holds a number that is not finite";
  } else if (const auto* vec = std::get_if<Vec3>(&value)) {
    if (!vec->allFinite()) return "must be finite";
  } else if (argument.kind == ArgumentKind::Choice &&
             std::ranges::find(argument.choices, std::get<std::string>(value)) == argument.choices.end()) {
    std::string known;
    for (const std::string& c : argument.choices) known += (known.empty() ? "" : ", ") + c;
    return "must be one of " + known;
  }
  return {};
}

}  // namespace

Result<Arguments> complete(const Command& command, const CommandArguments& given) {
  CommandArguments values;
  for (const CommandArgument& argument : command.info.arguments) values[argument.name] = argument.standard;
  for (const auto& [name, value] : given) {
    const auto& known = command.info.arguments;
    const auto argument = std::ranges::find(known, name, &CommandArgument::name);
    if (argument == known.end()) return refuse(command.info.name + " has no argument '" + name + "'");
    if (const std::string fault = faultOf(*argument, value); !fault.empty()) {
      return refuse(command.info.name + ": " + name + " " + fault);
    }
    values[name] = value;
  }
  return Arguments(std::move(values));
}

Result<std::vector<Vec3>> pointsOf(const std::vector<double>& numbers, const char* what) {
  if (numbers.size() % 3 != 0) return refuse(std::string(what) + " must hold three numbers a point");
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return points;
}

}  // namespace editor

std::span<const CommandInfo> commandInfos() {
  static const std::vector<CommandInfo> infos = [] {
    std::vector<CommandInfo> list;
    for (const editor::Command& command : editor::commands()) list.push_back(command.info);
    return list;
  }();
  return infos;
}

const CommandInfo* findCommand(std::string_view name) {
  const editor::Command* command = editor::find(name);
  return command == nullptr ? nullptr : &command->info;
}

}  // namespace coif
