// coif new: from a head model to a scene with a hairstyle.
#include "coif/io/can_write.h"
#include "coif/io/mesh_io.h"
#include "coif/place/place.h"
#include "coif/scalp/cage.h"
#include "coif/scalp/weld.h"
#include "coif/scene/new_scene.h"
#include "command.h"
#include "region_option.h"
#include "values.h"

namespace coif::cli {

namespace {

struct NewArguments {
  std::string scalp, region = "auto", cage, style, output;
  std::optional<double> metersPerUnit, weldTolerance;
  std::string up, forward, mirror;
};

Result<std::optional<Vec3>> axis(const std::string& text) {
  if (text.empty()) return std::optional<Vec3>();
  const std::string names = "xyz";
  const bool negative = text.front() == '-';
  const std::size_t found = names.find(char(std::tolower(text.back())));
  if (text.size() != (negative ? 2u : 1u) || found == std::string::npos) {
    return makeError(ErrorCode::InvalidArgument,
                     "'" + text + "' is no axis: x, y, z, -x, -y or -z is wanted");
  }
  Vec3 out = Vec3::Zero();
  out[int(found)] = negative ? -1 : 1;
  return std::optional<Vec3>(out);
}

Result<Cage> cageOf(const NewArguments& arguments, const Surface& head, const Region& region,
                    const Context& context) {
  CageOptions options;
  options.count = int(suggestedCageCount(arguments.style));
  if (arguments.cage == "exact") {
    options.exact = true;
  } else if (!arguments.cage.empty()) {
    options.count = std::stoi(arguments.cage);
  }
  if (arguments.mirror == "none") {
    options.useMirror = false;
  } else if (!arguments.mirror.empty()) {
    COIF_ASSIGN(const auto v, numbers(arguments.mirror, 6));
    COIF_ASSIGN(options.mirror, givenMirrorPlane(head, Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])));
  }
  return buildCage(head.mesh(), head, region, options, context);
}

Status makeScene(const NewArguments& arguments, Session& session) {
  const Context context = session.context();
  CapOptions cap;
  COIF_ASSIGN(cap.head.up, axis(arguments.up));
  COIF_ASSIGN(cap.head.forward, axis(arguments.forward));
  context.report("reading the head", 0);
  COIF_ASSIGN(PolygonMesh mesh, loadPolygonMesh(arguments.scalp));
  COIF_TRY(canWrite(arguments.output));
  if (arguments.weldTolerance) {
    COIF_ASSIGN(Welded welded, weld(mesh, {*arguments.weldTolerance}));
    session.say(welded.report.text());
    mesh = std::move(welded.mesh);
  }
  const Surface head(mesh);
  context.report("finding the scalp", 0.2);
  COIF_ASSIGN(const Region region, regionFromText(arguments.region, head, cap));
  for (const std::string& note : region.notes) session.say("  " + note);
  context.report("laying the cage", 0.4);
  COIF_ASSIGN(const Cage cage, cageOf(arguments, head, region, context));
  for (const std::string& note : cage.notes) session.say("  " + note);
  context.report("modelling the hairstyle", 0.6);
  COIF_ASSIGN(Hairstyle hairstyle, modelHairstyle(arguments.style, cage, head, context));

  const std::size_t pinned = hairstyle.report.pinned;
  COIF_ASSIGN(Scene scene,
              sceneOnHead(arguments.scalp, mesh, cage, std::move(hairstyle), arguments.metersPerUnit));
  scene.name = arguments.style;
  COIF_TRY(saveScene(scene, arguments.output));
  session.say("wrote " + arguments.output + ": " + arguments.style + ", " +
              std::to_string(scene.hairMesh.bundles().size()) + " bundles, " +
              std::to_string(scene.hairMesh.vertices().size()) + " vertices (" + std::to_string(pinned) +
              " pinned)");
  session.finish({{"scene", arguments.output},
                  {"bundles", scene.hairMesh.bundles().size()},
                  {"vertices", scene.hairMesh.vertices().size()},
                  {"pinned", pinned},
                  {"metersPerUnit", scene.metersPerUnit},
                  {"notes", region.notes}});
  return {};
}

/// "exact" or a number of quads.
std::string checkCage(const std::string& text) {
  if (text == "exact") return "";
  const bool digits =
      !text.empty() && text.size() < 7 && text.find_first_not_of("0123456789") == std::string::npos;
  if (digits && std::stoul(text) >= 4 && std::stoul(text) <= 100000) return "";
  return "'exact' or a number of quads from 4 to 100000 is wanted, not '" + text + "'";
}

}  // namespace

void addNew(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<NewArguments>();
  std::vector<std::string> styles(hairstyleNames().begin(), hairstyleNames().end());
  CLI::App* command = app.add_subcommand("new", "Model a hairstyle on a head");
  command->footer("Example:\n  coif new --scalp head.obj --style bob -o bob.coif\n");
  command->add_option("--scalp", arguments->scalp, "The head: OBJ, PLY, OFF, STL, GLB, glTF or USD")
      ->required();
  command->add_option("--style", arguments->style, "The hairstyle")->required()->check(CLI::IsMember(styles));
  command->add_option("-o,--output", arguments->output, "The scene to write, a .coif file")
      ->required()
      ->check(sceneOut());
  command->add_option("--region", arguments->region, std::string("Where hair grows: ") + kRegionHelp);
  command
      ->add_option("--cage", arguments->cage,
                   "Number of quads of the root layer, or 'exact' for the head's own polygons")
      ->check(CLI::Validator(checkCage, "N|exact"));
  command->add_option("--meters-per-unit", arguments->metersPerUnit, "Unit of the head's file")
      ->check(number(1e-12, 1e12));
  command->add_option("--weld", arguments->weldTolerance, "First weld vertices closer than this")
      ->check(number(0, 1e30));
  command->add_option("--mirror", arguments->mirror,
                      "Mirror plane as px,py,pz,nx,ny,nz, or 'none'; found unless given");
  command->add_option("--up", arguments->up, "Up axis of the head, such as z");
  command->add_option("--forward", arguments->forward, "Axis that the face looks along, such as -y");
  command->callback([arguments, &session] {
    if (const Status status = makeScene(*arguments, session); !status.ok()) {
      // A wrong word on the command line is bad usage; anything else is the input's fault.
      const Error& error = status.error();
      const bool usage = error.code == ErrorCode::InvalidArgument && error.file.empty();
      if (usage) return session.usage(error.text());
      session.fail(inFile(error, arguments->scalp));
    }
  });
}

}  // namespace coif::cli
