// coif convert: strands from one format to another.
#include "coif/io/strand_io.h"
#include "command.h"

namespace coif::cli {

namespace {

Status convert(const std::string& from, const std::string& to, Session& session) {
  COIF_ASSIGN(const StrandSet strands, loadStrands(from));
  StrandExport what;
  what.strands = &strands;
  COIF_ASSIGN(const WriteReport written, saveStrands(what, to, session.context()));
  session.say("wrote " + to + ": " + std::to_string(strands.strandCount()) + " strands, " +
              std::to_string(strands.pointCount()) + " points");
  for (const std::string& note : written.notes) session.say("  " + note);
  session.finish({{"strands", strands.strandCount()},
                  {"points", strands.pointCount()},
                  {"bytes", written.bytes},
                  {"notes", written.notes}});
  return {};
}

}  // namespace

void addConvert(CLI::App& app, Session& session) {
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App* command =
      app.add_subcommand("convert", "Convert strands between .hair, .usda, .usdc, .glb and .gltf");
  command->footer("Example:\n  coif convert wWavy.hair wWavy.usdc\n");
  command->add_option("input", files->first, "The strands to read")->required();
  command->add_option("output", files->second, "The file to write; its extension chooses the format")
      ->required();
  command->callback([files, &session] {
    if (const Status status = convert(files->first, files->second, session); !status.ok())
      session.fail(status.error());
  });
}

}  // namespace coif::cli
