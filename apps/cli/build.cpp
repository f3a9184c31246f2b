// coif build: a scene's strands, written to files.
#include "coif/io/can_write.h"
#include "coif/scene/evaluate.h"
#include "command.h"
#include "scene_options.h"

namespace coif::cli {

namespace {

struct BuildArguments {
  std::string scene;
  std::vector<std::string> outputs;
  StrandArguments strands;
  EvaluateArguments evaluate;
  std::string meshKind = "cards";
};

Status build(const BuildArguments& arguments, Session& session) {
  COIF_ASSIGN(Scene scene, loadScene(arguments.scene));
  for (const std::string& output : arguments.outputs) COIF_TRY(canSaveStrands(output));
  COIF_TRY(arguments.evaluate.canTell());
  arguments.strands.apply(scene);
  Evaluation evaluation(arguments.evaluate.options());
  StrandExport what;
  what.mesh = arguments.meshKind == "none"    ? StrandMesh::None
              : arguments.meshKind == "tubes" ? StrandMesh::Tubes
                                              : StrandMesh::Cards;
  const Context context = session.context();
  COIF_ASSIGN(const StrandSet* strands, evaluation.strands(scene, context));
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const std::string& output : arguments.outputs) {
    COIF_ASSIGN(const WriteReport written, evaluation.exportTo(scene, output, what, context));
    files.push_back({{"file", output}, {"bytes", written.bytes}, {"notes", written.notes}});
    session.say("wrote " + output);
  }
  COIF_TRY(arguments.evaluate.tell(evaluation.reports(), session));
  nlohmann::ordered_json result = nlohmann::ordered_json::parse(reportJson(evaluation.reports()));
  result["strands"] = strands->strandCount();
  result["points"] = strands->pointCount();
  result["files"] = std::move(files);
  session.finish(result);
  return {};
}

}  // namespace

void addBuild(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<BuildArguments>();
  CLI::App* command = app.add_subcommand("build", "Grow a scene's strands and write them to files");
  command->footer("Example:\n  coif build bob.coif -o bob.usdc -o bob.glb -o bob.hair --strands 100000\n");
  command->add_option("scene", arguments->scene, "The scene, a .coif file")->required();
  command
      ->add_option("-o,--output", arguments->outputs,
                   "A file to write: .usda, .usdc, .glb, .gltf or .hair; repeatable")
      ->required()
      ->allow_extra_args(false);
  command->add_option("--mesh", arguments->meshKind, "Mesh beside the lines in glTF")
      ->check(CLI::IsMember({"none", "cards", "tubes"}));
  arguments->strands.addTo(*command);
  arguments->evaluate.addTo(*command);
  command->callback([arguments, &session] {
    if (const Status status = build(*arguments, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli
