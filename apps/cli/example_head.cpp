// coif example-head: the head that Coif generates itself, for demos and tests.
#include "coif/scalp/example_head.h"

#include "coif/io/mesh_io.h"
#include "command.h"

namespace coif::cli {

void addExampleHead(CLI::App& app, Session& session) {
  auto output = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("example-head", "Write the generated example head as an OBJ file");
  command->footer("Example:\n  coif example-head -o head.obj\n");
  command->add_option("-o,--output", *output, "The OBJ file to write")->required();
  command->callback([output, &session] {
    const PolygonMesh head = makeExampleHead();
    if (const Status status = savePolygonMesh(head, *output); !status.ok())
      return session.fail(status.error());
    session.say("wrote " + *output + ": " + std::to_string(head.faceCount()) + " polygons");
    session.finish({{"polygons", head.faceCount()}, {"vertices", head.vertexCount()}});
  });
}

}  // namespace coif::cli
