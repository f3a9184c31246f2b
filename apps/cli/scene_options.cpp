#include "scene_options.h"

#include <iostream>

#include "coif/io/safe_file.h"

namespace coif::cli {

void StrandArguments::addTo(CLI::App& command) {
  command.add_option("--strands", count, "How many strands")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1} << 32));
  auto* fixed = command.add_option("--points", points, "Points a strand")->check(CLI::Range(2u, 65536u));
  command
      .add_option("--tolerance", tolerance,
                  "As many points as keep the chord error below this, in scene units")
      ->check(CLI::PositiveNumber)
      ->excludes(fixed);
  command.add_option("--seed", seed, "Seed of the root distribution");
  command.add_option("--width", width, "Hair diameter at the root, in scene units")
      ->check(CLI::PositiveNumber);
}

void StrandArguments::apply(Scene& scene) const {
  StrandSettings& settings = scene.strands;
  if (count) settings.count = std::size_t(*count);
  if (points) settings.points = *points, settings.tolerance = 0;
  if (tolerance) settings.tolerance = *tolerance;
  if (seed) settings.seed = *seed;
  if (width) settings.width = *width;
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

Status EvaluateArguments::tell(const std::vector<StageReport>& stages, const Session& session) const {
  if (explain && !session.json) std::cout << explainText(stages);
  if (reportFile.empty()) return {};
  COIF_ASSIGN(auto file, SafeFile::create(reportFile));
  file.write(reportJson(stages));
  return file.commit();
}

}  // namespace coif::cli
