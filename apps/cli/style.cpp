// coif style: the operators that a scene's strands go through.
#include <algorithm>
#include <cstdio>

#include "coif/scene/editor.h"
#include "coif/style/style_kinds.h"
#include "command.h"
#include "values.h"

namespace coif::cli {

namespace {

using Json = nlohmann::ordered_json;

struct StyleArguments {
  std::string scene, output;
  std::vector<std::string> add, set, remove;
  bool kinds = false, clear = false;
};

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string valueText(const StyleParameter& p, double value) {
  if (p.kind == ParameterKind::Choice) return p.choices[std::size_t(value)];
  if (p.kind == ParameterKind::Flag) return value != 0 ? "on" : "off";
  return numberText(value) + (p.unit.empty() ? "" : " " + p.unit);
}

void listKinds(const Session& session) {
  Json kinds = Json::array();
  for (const StyleKind& kind : styleKinds()) {
    session.say(kind.name + ": " + kind.help);
    Json parameters = Json::array();
    for (const StyleParameter& p : kind.parameters) {
      std::string range = numberText(p.least) + " … " + numberText(p.most);
      if (!p.choices.empty()) {
        range.clear();
        for (const std::string& word : p.choices) range += (range.empty() ? "" : "|") + word;
      }
      if (p.kind == ParameterKind::Flag) range = "on|off";
      session.say("  " + p.name + " = " + valueText(p, p.standard) + " (" + range + "): " + p.help);
      parameters.push_back({{"name", p.name},
                            {"label", p.label},
                            {"unit", p.unit},
                            {"standard", p.standard},
                            {"least", p.least},
                            {"most", p.most},
                            {"choices", p.choices},
                            {"help", p.help}});
    }
    kinds.push_back({{"kind", kind.name},
                     {"label", kind.label},
                     {"help", kind.help},
                     {"parameters", std::move(parameters)}});
  }
  session.finish({{"kinds", std::move(kinds)}});
}

/// An operator by its name, or the last of a kind.
std::string operatorNamed(const StyleStack& stack, const std::string& given) {
  if (indexOf(stack, given) != kNone) return given;
  const auto last =
      std::find_if(stack.rbegin(), stack.rend(), [&](const StyleOperator& op) { return op.kind == given; });
  return last == stack.rend() ? given : last->name;
}

/// OPERATOR.PARAMETER=VALUE.
Status setOne(Editor& editor, const std::string& text) {
  const std::size_t equals = text.find('='), dot = text.rfind('.', equals);
  if (equals == std::string::npos || dot == std::string::npos || dot == 0)
    return makeError(ErrorCode::InvalidArgument, "--set wants OPERATOR.PARAMETER=VALUE, not '" + text + "'");
  CommandArguments arguments{{"operator", operatorNamed(editor.state().styles, text.substr(0, dot))},
                             {"parameter", text.substr(dot + 1, equals - dot - 1)}};
  const std::string value = text.substr(equals + 1);
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (!value.empty() && *end == '\0') {
    arguments["value"] = number;
  } else {
    arguments["text"] = value;
  }
  return editor.run("set_operator", arguments);
}

Json describe(const StyleStack& stack, const Session& session) {
  Json out = Json::array();
  for (const StyleOperator& op : stack) {
    const StyleKind& kind = *findStyleKind(op.kind);
    std::string line = op.name + " (" + op.kind + (op.enabled ? "" : ", off") + ", amount " +
                       numberText(op.amount) + (op.group.empty() ? "" : ", group " + op.group) +
                       (op.mask.empty() ? "" : ", masked") + ")";
    Json parameters;
    for (const StyleParameter& p : kind.parameters) {
      const double value = parameterOf(op, p.name);
      if (value != p.standard) line += ", " + p.name + " " + valueText(p, value);
      parameters[p.name] = value;
    }
    session.say(line);
    out.push_back({{"name", op.name},
                   {"kind", op.kind},
                   {"enabled", op.enabled},
                   {"amount", op.amount},
                   {"group", op.group},
                   {"seed", op.seed},
                   {"parameters", std::move(parameters)}});
  }
  if (stack.empty()) session.say("the strands are as the hair mesh has them: no operator");
  return out;
}

Status styleScene(const StyleArguments& arguments, Session& session) {
  COIF_ASSIGN(Scene scene, loadScene(arguments.scene));
  if (arguments.clear) scene.styles.clear();
  Editor editor(std::move(scene));
  for (const std::string& given : arguments.remove)
    COIF_TRY(editor.run("remove_operator", {{"operator", operatorNamed(editor.state().styles, given)}}));
  for (const std::string& kind : arguments.add) COIF_TRY(editor.run("add_operator", {{"kind", kind}}));
  for (const std::string& text : arguments.set) COIF_TRY(setOne(editor, text));
  Json result;
  result["operators"] = describe(editor.state().styles, session);
  if (!arguments.output.empty()) {
    COIF_TRY(editor.save(arguments.output));
    session.say("wrote " + arguments.output);
    result["scene"] = arguments.output;
  }
  session.finish(result);
  return {};
}

}  // namespace

void addStyle(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<StyleArguments>();
  CLI::App* command = app.add_subcommand("style", "Curl, clump and cut a scene's strands");
  command->footer(
      "Without -o it says what operators the scene has. An operator is named by its name or its kind.\n"
      "Example:\n  coif style long.coif --add clump --add curl --set curl.radius=0.8 -o curly.coif\n");
  std::vector<std::string> kinds;
  for (const StyleKind& kind : styleKinds()) kinds.push_back(kind.name);
  auto* scene = command->add_option("scene", arguments->scene, "The scene, a .coif file");
  command->add_flag("--list-kinds", arguments->kinds,
                    "Say which operators there are and what they can be told");
  command->add_flag("--clear", arguments->clear, "Start from no operator");
  command->add_option("--remove", arguments->remove, "Take an operator away; repeatable")
      ->allow_extra_args(false);
  command->add_option("--add", arguments->add, "Put an operator at the end of the stack; repeatable")
      ->check(CLI::IsMember(kinds))
      ->allow_extra_args(false);
  command
      ->add_option("--set", arguments->set,
                   "OPERATOR.PARAMETER=VALUE, also amount, enabled, seed and group; repeatable")
      ->allow_extra_args(false);
  command->add_option("-o,--output", arguments->output, "The scene to write")->check(sceneOut());
  command->callback([arguments, scene, &session] {
    if (arguments->kinds) return listKinds(session);
    if (scene->empty()) return session.usage("coif style wants a scene, or --list-kinds");
    const bool changes =
        arguments->clear || !arguments->add.empty() || !arguments->set.empty() || !arguments->remove.empty();
    if (changes && arguments->output.empty()) return session.usage("name the scene to write with -o");
    if (const Status status = styleScene(*arguments, session); !status.ok()) {
      const Error& error = status.error();
      const bool usage = error.code != ErrorCode::Cancelled && error.file.empty();
      if (usage) return session.usage(error.text());
      session.fail(error);
    }
  });
}

}  // namespace coif::cli
