// coif check: every invariant of a scene's hair mesh.
#include "coif/hairmesh/invariants.h"
#include "coif/scene/evaluate.h"
#include "command.h"

namespace coif::cli {

namespace {

Status check(const std::string& path, Session& session) {
  COIF_ASSIGN(const Scene scene, loadScene(path));
  nlohmann::ordered_json faults = nlohmann::ordered_json::array();
  for (const InvariantFault& fault : checkInvariants(scene.hairMesh)) {
    faults.push_back({{"invariant", fault.name}, {"element", fault.element}, {"message", fault.message}});
    session.say(path + ": " + fault.element + ": " + fault.message + " (" + fault.name + ")");
  }
  Evaluation evaluation;
  if (const auto head = evaluation.head(scene, session.context()); !head.ok()) {
    faults.push_back(
        {{"invariant", "head"}, {"element", head.error().file}, {"message", head.error().message}});
    session.say(path + ": " + head.error().text());
  }
  if (faults.empty()) {
    session.say(path + ": all invariants hold, " + std::to_string(scene.hairMesh.bundles().size()) +
                " bundles, " + std::to_string(scene.hairMesh.vertices().size()) + " vertices");
  } else {
    session.exit = Exit::InputFault;
  }
  session.finish({{"faults", faults}});
  return {};
}

}  // namespace

void addCheck(CLI::App& app, Session& session) {
  auto path = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("check", "Check every invariant of a scene; exit status 1 on a fault");
  command->footer("Example:\n  coif check bob.coif\n");
  command->add_option("scene", *path, "The scene, a .coif file")->required();
  command->callback([path, &session] {
    if (const Status status = check(*path, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli
