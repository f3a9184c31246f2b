// coif info: what is in a file.
#include <algorithm>

#include "coif/io/mesh_io.h"
#include "coif/io/strand_io.h"
#include "coif/scalp/mesh_report.h"
#include "coif/scene/scene.h"
#include "command.h"
#include "values.h"

namespace coif::cli {

namespace {

using Json = nlohmann::ordered_json;

Json sceneInfo(const Scene& scene, Session& session) {
  const HairMesh& mesh = scene.hairMesh;
  std::size_t pinned = 0;
  for (const HairVertex& vertex : mesh.vertices()) pinned += vertex.pinned;
  session.say("Coif scene '" + scene.name + "', head " + scene.headPath().string());
  session.say("  hair mesh: " + std::to_string(mesh.vertices().size()) + " vertices (" +
              std::to_string(pinned) + " pinned), " + std::to_string(mesh.bundles().size()) + " bundles, " +
              std::to_string(mesh.layerCount()) + " layers, " + std::to_string(mesh.splits().size()) +
              " separated edges");
  for (const std::string& group : mesh.groupNames()) session.say("  group " + group);
  session.say("  strands: " + std::to_string(scene.strands.count) + " of " +
              std::to_string(scene.strands.points) + " points, seed " + std::to_string(scene.strands.seed));
  return {{"kind", "scene"},
          {"name", scene.name},
          {"head", scene.headPath().string()},
          {"metersPerUnit", scene.metersPerUnit},
          {"vertices", mesh.vertices().size()},
          {"pinned", pinned},
          {"bundles", mesh.bundles().size()},
          {"layers", mesh.layerCount()},
          {"separatedEdges", mesh.splits().size()},
          {"groups", std::vector<std::string>(mesh.groupNames().begin(), mesh.groupNames().end())},
          {"strands", scene.strands.count}};
}

Json strandInfo(const StrandSet& strands, Session& session) {
  std::uint64_t fewest = strands.strandCount() ? ~std::uint64_t{0} : 0, most = 0;
  double shortest = strands.strandCount() ? 1e300 : 0, longest = 0, sum = 0;
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    const auto points = strands.strand(s);
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += double((points[i] - points[i - 1]).norm());
    fewest = std::min<std::uint64_t>(fewest, points.size()),
    most = std::max<std::uint64_t>(most, points.size());
    shortest = std::min(shortest, length), longest = std::max(longest, length), sum += length;
  }
  const double mean = strands.strandCount() ? sum / double(strands.strandCount()) : 0;
  session.say("strands: " + std::to_string(strands.strandCount()) +
              ", points: " + std::to_string(strands.pointCount()) + " (" + std::to_string(fewest) + " to " +
              std::to_string(most) + " a strand)");
  session.say("  length: " + std::to_string(shortest) + " to " + std::to_string(longest) + ", mean " +
              std::to_string(mean));
  if (!strands.information.empty()) session.say("  " + strands.information);
  return {{"kind", "strands"},
          {"strands", strands.strandCount()},
          {"points", strands.pointCount()},
          {"fewestPoints", fewest},
          {"mostPoints", most},
          {"shortest", shortest},
          {"longest", longest},
          {"meanLength", mean},
          {"widths", !strands.widths.empty()},
          {"ids", !strands.ids.empty()},
          {"rootUvs", !strands.rootUvs.empty()},
          {"groups", strands.groupNames}};
}

Json meshInfo(const PolygonMesh& mesh, Session& session) {
  const MeshReport report = inspect(mesh);
  session.say("mesh: " + std::to_string(mesh.vertexCount()) + " vertices, " +
              std::to_string(mesh.faceCount()) + " polygons");
  session.say(report.text());
  for (const std::string& note : mesh.notes) session.say(note);
  Json shells = Json::array(), findings = Json::array();
  for (const Shell& shell : report.shells) {
    shells.push_back({{"faces", shell.faceCount},
                      {"closed", shell.closed},
                      {"genus", shell.genus},
                      {"loops", shell.boundaryLoops}});
  }
  for (const MeshFinding& finding : report.findings) {
    findings.push_back({{"fault", name(finding.fault)}, {"count", finding.count}, {"text", finding.text}});
  }
  return {{"kind", "mesh"},
          {"vertices", mesh.vertexCount()},
          {"polygons", mesh.faceCount()},
          {"groups", mesh.groupNames},
          {"shells", shells},
          {"findings", findings},
          {"notes", mesh.notes}};
}

/// Strands and meshes share extensions: a file with strands is read as strands.
Status info(const std::string& path, Session& session) {
  if (extensionOf(path) == ".coif") {
    COIF_ASSIGN(const Scene scene, loadScene(path));
    session.finish(sceneInfo(scene, session));
    return {};
  }
  const auto strands = loadStrands(path);
  if (strands.ok() && strands->strandCount() > 0) {
    session.finish(strandInfo(*strands, session));
    return {};
  }
  const auto mesh = loadPolygonMesh(path);
  if (mesh.ok()) {
    session.finish(meshInfo(*mesh, session));
    return {};
  }
  // Neither: the reader that knows the extension has the better sentence.
  return !strands.ok() && strands.error().code != ErrorCode::Unsupported ? strands.error() : mesh.error();
}

}  // namespace

void addInfo(CLI::App& app, Session& session) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("info", "Say what is in a scene, a mesh or a strand file");
  command->footer("Example:\n  coif info head.obj\n");
  command->add_option("file", *path, "The file to look into")->required();
  command->callback([path, &session] {
    if (const Status status = info(*path, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli
