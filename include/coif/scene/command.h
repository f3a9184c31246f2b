// Commands: everything that an editor does to a document, by name and with named arguments, so that a menu, a
// key, a palette, a script and a test all go the same way.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif {

/// A value of an argument. Integers travel as double; lists of ids too.
using CommandValue = std::variant<bool, double, std::string, Vec3, std::vector<double>>;
using CommandArguments = std::map<std::string, CommandValue>;

enum class ArgumentKind { Flag, Number, Integer, Choice, Text, Vector, Numbers };

/// What a panel or a palette needs to ask for an argument.
struct CommandArgument {
  std::string name;  ///< snake_case, as in Python
  ArgumentKind kind = ArgumentKind::Number;
  CommandValue standard;              ///< what it is when not given
  double least = -1e30, most = 1e30;  ///< of numbers
  std::vector<std::string> choices = {};
  std::string help;  ///< one sentence, with the unit
};

struct CommandInfo {
  std::string name;   ///< snake_case, as in Python: "extrude"
  std::string label;  ///< "Extrude"
  std::string menu;   ///< "Mesh"; one menu a command
  std::string key;    ///< default key: "E", "Ctrl+Z"; empty for none
  std::string help;   ///< one sentence
  std::vector<CommandArgument> arguments = {};
  bool changesMesh = false;  ///< its undo step holds the mesh
};

/// Every command, in menu order.
std::span<const CommandInfo> commandInfos();
/// Null when there is none of that name.
const CommandInfo* findCommand(std::string_view name);

/// The call as a line of Python: `editor.extrude(distance=0.5)`.
std::string pythonLine(std::string_view command, const CommandArguments& arguments);

}  // namespace coif
