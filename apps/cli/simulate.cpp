// coif simulate: a scene's hair in motion; coif drape: let it hang and keep the shape.
#include <fstream>
#include <iostream>
#include <sstream>

#include "coif/io/can_write.h"
#include "coif/io/safe_file.h"
#include "coif/scene/dynamics_text.h"
#include "coif/scene/evaluate.h"
#include "command.h"
#include "scene_options.h"
#include "values.h"

namespace coif::cli {

namespace {

struct SimulateArguments {
  std::string scene, headMotion, output;
  SimulateOptions what;
  DynamicsArguments dynamics;
  StrandArguments strands;
  EvaluateArguments evaluate;
};

struct DrapeArguments {
  std::string scene, output;
  DrapeOptions options;
  std::optional<double> droop;
  EvaluateArguments evaluate;
};

/// A line a frame: x y z of the position, then x y z w of the turn as a quaternion.
Result<std::vector<RigidPose>> readPoses(const std::string& path) {
  COIF_ASSIGN(const auto bytes, readFile(path, std::uint64_t{1} << 26));
  std::istringstream text(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  std::vector<RigidPose> poses;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    std::replace(line.begin(), line.end(), ',', ' ');
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::istringstream fields(line);
    double v[7];
    for (double& value : v) fields >> value;
    const Eigen::Quaterniond turn(v[6], v[3], v[4], v[5]);
    std::string rest;
    if (!fields || fields >> rest || !(turn.norm() > 1e-6) || !std::isfinite(turn.norm()))
      return makeError(ErrorCode::Malformed,
                       "seven numbers are wanted: x y z of the head, x y z w of its turn",
                       "line " + std::to_string(number), path);
    poses.push_back({turn.normalized().toRotationMatrix(), Vec3(v[0], v[1], v[2])});
  }
  if (poses.empty()) return makeError(ErrorCode::Malformed, "there is no pose in this file", "", path);
  return poses;
}

Status simulate(const SimulateArguments& arguments, Session& session) {
  COIF_ASSIGN(Scene scene, loadScene(arguments.scene));
  arguments.strands.apply(scene);
  COIF_TRY(arguments.dynamics.apply(scene));
  SimulateOptions what = arguments.what;
  if (!arguments.headMotion.empty()) {
    COIF_ASSIGN(what.motion.poses, readPoses(arguments.headMotion));
  }
  const std::string extension = extensionOf(arguments.output);
  const bool cache = extension == ".coifcache";
  if (!cache && extension != ".usda" && extension != ".usdc" && extension != ".usd" && extension != ".abc") {
    return makeError(ErrorCode::Unsupported,
                     "hair in motion is written as .coifcache, .usda, .usdc or .abc (glTF and .hair hold one "
                     "pose)",
                     "", arguments.output);
  }
  COIF_TRY(cache ? canWrite(arguments.output) : canSaveStrands(arguments.output));
  COIF_TRY(arguments.evaluate.canTell());
  if (cache) what.cache = arguments.output;
  Evaluation evaluation(arguments.evaluate.options());
  const Context context = session.context();
  COIF_ASSIGN(const DynamicsCache* motion, evaluation.simulate(scene, what, context));
  std::vector<std::string> notes;
  if (!cache) {
    COIF_ASSIGN(const WriteReport written, evaluation.exportMotion(scene, what, arguments.output, context));
    notes = written.notes;
  }
  session.say("wrote " + arguments.output + ": " + std::to_string(motion->frameCount()) + " frames of " +
              std::to_string(motion->vertexCount) + " points");
  COIF_TRY(arguments.evaluate.tell(evaluation.reports(), session));
  nlohmann::ordered_json result = nlohmann::ordered_json::parse(reportJson(evaluation.reports()));
  result["frames"] = motion->frameCount();
  result["vertices"] = motion->vertexCount;
  result["file"] = arguments.output;
  result["notes"] = notes;
  if (const SimulationReport* report = evaluation.simulationReport()) {
    result["dynamics"] = {{"chains", report->chains},
                          {"links", report->links},
                          {"steps", report->steps},
                          {"seconds", report->seconds},
                          {"maxNewton", report->maxNewton},
                          {"meanNewton", report->meanNewton},
                          {"maxStretch", report->maxStretch},
                          {"resets", report->resets},
                          {"unconverged", report->unconverged}};
  }
  session.finish(result);
  return {};
}

Status drape(const DrapeArguments& arguments, Session& session) {
  COIF_ASSIGN(Scene scene, loadScene(arguments.scene));
  COIF_TRY(canWrite(arguments.output));
  COIF_TRY(arguments.evaluate.canTell());
  const double droop = scene.dynamics.droop;
  if (arguments.droop) scene.dynamics.droop = *arguments.droop;
  Evaluation evaluation(arguments.evaluate.options());
  COIF_ASSIGN(const DrapeReport report, evaluation.drape(scene, arguments.options, session.context()));
  scene.dynamics.droop = droop;
  COIF_TRY(saveScene(scene, arguments.output));
  std::ostringstream text;
  text << "wrote " << arguments.output << ": " << (report.settled ? "settled" : "still moving") << " after "
       << double(report.frames) / 24 << " s, greatest move " << report.greatestMove;
  session.say(text.str());
  COIF_TRY(arguments.evaluate.tell(evaluation.reports(), session));
  session.finish({{"scene", arguments.output},
                  {"settled", report.settled},
                  {"frames", report.frames},
                  {"greatestMove", report.greatestMove},
                  {"lastMove", report.lastMove}});
  return {};
}

}  // namespace

void addSimulate(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand("simulate", "Move a scene's hair and write the frames");
  command->footer(
      "A .coifcache that is already there is gone on with if it is of the same simulation.\n"
      "Example:\n  coif simulate long.coif --frames 48 --fps 24 -o long.coifcache\n");
  command->add_option("scene", arguments->scene, "The scene, a .coif file")->required();
  command->add_option("-o,--output", arguments->output, "A .coifcache, .usda, .usdc or .abc file to write")
      ->required();
  command->add_option("--frames", arguments->what.frames, "How many frames")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  command->add_option("--fps", arguments->what.framesPerSecond, "Frames a second")->check(number(1e-3, 1e5));
  arguments->dynamics.addTo(*command);
  command->add_option("--head-motion", arguments->headMotion,
                      "A text file, a line a frame: x y z of the head, x y z w of its turn");
  arguments->strands.addTo(*command);
  arguments->evaluate.addTo(*command);
  command->callback([arguments, &session] {
    if (const Status status = simulate(*arguments, session); !status.ok()) session.fail(status.error());
  });
}

void addDrape(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<DrapeArguments>();
  CLI::App* command = app.add_subcommand("drape", "Let a scene's hair hang under gravity and keep the shape");
  command->footer("Example:\n  coif drape long.coif -o draped.coif --droop 0.5\n");
  command->add_option("scene", arguments->scene, "The scene, a .coif file")->required();
  command->add_option("-o,--output", arguments->output, "The scene to write")->required()->check(sceneOut());
  command->add_option("--seconds", arguments->options.seconds, "Time at most")->check(number(0.01, 3600));
  command
      ->add_option("--settled", arguments->options.tolerance,
                   "Stop when nothing moves further in 1/24 s, as a fraction of the hair's size")
      ->check(number(0, 1e30));
  command->add_option("--droop", arguments->droop, "How limp; instead of the scene's")->check(number(0, 1e6));
  arguments->evaluate.addTo(*command);
  command->callback([arguments, &session] {
    if (const Status status = drape(*arguments, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli
