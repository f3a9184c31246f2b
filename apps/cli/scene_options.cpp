#include "scene_options.h"

#include <iostream>

#include "coif/io/can_write.h"
#include "coif/io/safe_file.h"
#include "coif/scene/dynamics_text.h"
#include "values.h"

namespace coif::cli {

void StrandArguments::addTo(CLI::App& command) {
  command.add_option("--strands", count, "How many strands")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1} << 32));
  auto* fixed = command.add_option("--points", points, "Points a strand")->check(CLI::Range(2u, 65536u));
  command
      .add_option("--tolerance", tolerance,
                  "As many points as keep the chord error below this, in scene units")
      ->check(numberAbove0(1e30))
      ->excludes(fixed);
  command.add_option("--seed", seed, "Seed of the root distribution")->check(wholeNumber());
  command.add_option("--width", width, "Hair diameter at the root, in scene units")
      ->check(numberAbove0(1e30));
}

void StrandArguments::apply(Scene& scene) const {
  StrandSettings& settings = scene.strands;
  if (count) settings.count = std::size_t(*count);
  if (points) settings.points = *points, settings.tolerance = 0;
  if (tolerance) settings.tolerance = *tolerance;
  if (seed) settings.seed = *seed;
  if (width) settings.width = *width;
}

namespace {

Status setOne(DynamicsSettings& settings, const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos)
    return makeError(ErrorCode::InvalidArgument, "NAME=VALUE is wanted, not '" + text + "'");
  return setDynamics(settings, text.substr(0, at), text.substr(at + 1));
}

/// A value that no scene could take is bad usage, found before the scene is read.
std::string checkSetting(const std::string& text) {
  DynamicsSettings any;
  const Status status = setOne(any, text);
  return status.ok() ? "" : status.error().text();
}

}  // namespace

void DynamicsArguments::addTo(CLI::App& command) {
  const auto add = [&](const char* option, const char* setting, const char* help) {
    return command.add_option_function<std::string>(
        option, [this, setting](const std::string& value) { named.emplace_back(setting, value); }, help);
  };
  add("--solver", "solver", "Instead of the scene's")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kMethodNames), std::end(kMethodNames))));
  add("--wind", "wind", "Kind of wind, instead of the scene's")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kWindNames), std::end(kWindNames))));
  add("--wisps", "wisps", "Simulate so many wisps of three guides, not the hair mesh; 0: the hair mesh")
      ->check(CLI::Validator([](std::string& value) { return checkSetting("wisps=" + value); }, "N"));
  add("--precision", "precision", "Of the solver")
      ->check(
          CLI::IsMember(std::vector<std::string>(std::begin(kPrecisionNames), std::end(kPrecisionNames))));
  std::string names;
  for (const std::string& name : dynamicsNames()) names += (names.empty() ? "" : ", ") + name;
  command
      .add_option("--set", set, "NAME=VALUE, a dynamics setting instead of the scene's; repeatable: " + names)
      ->check(CLI::Validator(checkSetting, "NAME=VALUE"))
      ->allow_extra_args(false);
}

Status DynamicsArguments::apply(Scene& scene) const {
  for (const auto& [name, value] : named) COIF_TRY(setDynamics(scene.dynamics, name, value));
  for (const std::string& text : set) COIF_TRY(setOne(scene.dynamics, text));
  return {};
}

void EvaluateArguments::addTo(CLI::App& command) {
  std::vector<std::string> stages(std::begin(kStages), std::end(kStages));
  stages.push_back("all");
  command.add_flag("--explain", explain, "Say what each stage did, and why");
  command.add_option("--report", reportFile, "Write the same as JSON to this file");
  command.add_option("--force", force, "Run this stage even where it could be skipped or reused; repeatable")
      ->check(CLI::IsMember(stages))
      ->allow_extra_args(false);
  command.add_flag("--no-head", noHead, "Leave the head out: roots stay on the cage");
}

EvaluateOptions EvaluateArguments::options() const {
  EvaluateOptions out;
  out.useHead = !noHead;
  out.force.insert(force.begin(), force.end());
  return out;
}

Status EvaluateArguments::canTell() const {
  return reportFile.empty() ? Status() : canWrite(reportFile);
}

Status EvaluateArguments::tell(const std::vector<StageReport>& stages, const Session& session) const {
  if (explain && !session.json) std::cout << explainText(stages);
  if (reportFile.empty()) return {};
  COIF_ASSIGN(auto file, SafeFile::create(reportFile));
  file.write(reportJson(stages));
  return file.commit();
}

}  // namespace coif::cli
