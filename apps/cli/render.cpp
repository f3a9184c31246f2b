// coif render: a picture of a scene.
#include "command.h"

#ifdef COIF_WITH_PREVIEW
#include <iostream>

#include "coif/io/safe_file.h"
#include "coif/preview/preview.h"
#include "coif/scene/evaluate.h"
#include "scene_options.h"

namespace coif::cli {

namespace {

struct RenderArguments {
  std::string scene, output, size = "1024x1024", camera, lod = "auto";
  std::vector<float> color;
  StrandArguments strands;
  EvaluateArguments evaluate;
  bool hairMesh = false, noStrands = false, noShadows = false, noLod = false, transparent = false;
};

bool parseSize(const std::string& text, int& width, int& height) {
  int used = 0;
  return std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &used) == 2 && used == int(text.size()) &&
         width >= 1 && height >= 1 && width <= 8192 && height <= 8192;
}

bool parseAngles(const std::string& text, double& azimuth, double& elevation) {
  int used = 0;
  return std::sscanf(text.c_str(), "%lf,%lf%n", &azimuth, &elevation, &used) == 2 &&
         used == int(text.size()) && std::abs(azimuth) <= 1e6 && std::abs(elevation) <= 90;
}

std::string checkSize(const std::string& text) {
  int width, height;
  return parseSize(text, width, height)
             ? ""
             : "--size wants WIDTHxHEIGHT from 1x1 to 8192x8192, not '" + text + "'";
}

std::string checkCamera(const std::string& text) {
  double azimuth, elevation;
  return parseAngles(text, azimuth, elevation)
             ? ""
             : "--camera wants AZIMUTH,ELEVATION in degrees, not '" + text + "'";
}

/// Frames the hair and the face below it, not a whole body. Hair fills no corner of its box, so the box is
/// drawn in.
Box framed(const StrandSet* strands, const HairMesh& mesh, UpAxis upAxis) {
  std::vector<Vec3> points;
  for (const HairVertex& vertex : mesh.vertices()) {
    if (vertex.layer == 0) points.push_back(vertex.position);
  }
  const Box scalp = bounds(points);
  Vec3 chin = scalp.lo;
  const int up = upAxis == UpAxis::Y ? 1 : 2;
  chin[up] -= 0.6 * (scalp.hi[up] - scalp.lo[up]);
  points.push_back(chin);
  if (strands) {
    for (const Vec3f& point : strands->points) points.push_back(point.cast<double>());
  }
  for (const HairVertex& vertex : mesh.vertices()) points.push_back(vertex.position);
  Box box = bounds(points);
  const Vec3 inset = 0.04 * (box.hi - box.lo);
  box.lo += inset, box.hi -= inset;
  return box;
}

/// "auto", "off" or a part of the strands.
bool parseLod(const std::string& text, PreviewOptions& options) {
  if (text == "auto") return true;
  if (text == "off") return options.lod = false, true;
  int used = 0;
  return std::sscanf(text.c_str(), "%lf%n", &options.strandFraction, &used) == 1 &&
         used == int(text.size()) && options.strandFraction > 0 && options.strandFraction <= 1;
}

std::string checkLod(const std::string& text) {
  PreviewOptions options;
  return parseLod(text, options)
             ? ""
             : "--lod wants 'auto', 'off' or a part of the strands above 0 and up to 1, not '" + text + "'";
}

Status render(const RenderArguments& arguments, Session& session) {
  COIF_ASSIGN(Scene scene, loadScene(arguments.scene));
  arguments.strands.apply(scene);
  Evaluation evaluation(arguments.evaluate.options());
  const Context context = session.context();
  PreviewScene shown;
  if (!arguments.noStrands) {
    COIF_ASSIGN(shown.strands, evaluation.strands(scene, context));
  }
  COIF_ASSIGN(const HairMesh* mesh, evaluation.placedMesh(scene, context));
  if (arguments.hairMesh) shown.hairMesh = mesh;
  COIF_ASSIGN(const Surface* head, evaluation.head(scene, context));
  if (head) shown.head = &head->mesh();
  PreviewOptions options;
  parseSize(arguments.size, options.width, options.height);
  options.hairColor = arguments.color.size() == 3
                          ? Vec3f(arguments.color[0], arguments.color[1], arguments.color[2])
                          : scene.look.hairColor;
  options.shadows = !arguments.noShadows;
  parseLod(arguments.lod, options);
  if (arguments.noLod) options.lod = false;
  options.transparentBackground = arguments.transparent;
  double azimuth = scene.look.azimuthDeg, elevation = scene.look.elevationDeg;
  if (!arguments.camera.empty()) parseAngles(arguments.camera, azimuth, elevation);
  shown.camera = frameBox(framed(shown.strands, *mesh, scene.upAxis), scene.upAxis, azimuth, elevation,
                          double(options.width) / options.height);
  COIF_ASSIGN(Preview preview, Preview::create());
  COIF_ASSIGN(const Picture picture, preview.render(shown, options, context));
  COIF_ASSIGN(const auto png, encodePng(picture.image));
  COIF_ASSIGN(auto file, SafeFile::create(arguments.output));
  file.write(png);
  COIF_TRY(file.commit());
  session.say("wrote " + arguments.output + " with " + preview.renderer());
  for (const std::string& note : picture.notes) session.say("  " + note);
  if (arguments.evaluate.explain && !session.json) std::cout << explainText(evaluation.reports());
  session.finish({{"picture", arguments.output},
                  {"renderer", preview.renderer()},
                  {"seconds", picture.seconds},
                  {"strandsDrawn", picture.strandsDrawn},
                  {"segmentsDrawn", picture.segmentsDrawn},
                  {"widthScale", picture.widthScale},
                  {"notes", picture.notes}});
  return {};
}

}  // namespace

void addRender(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "Make a picture of a scene");
  command->footer("Example:\n  coif render bob.coif -o bob.png --size 1024x1024 --camera 30,8\n");
  command->add_option("scene", arguments->scene, "The scene, a .coif file")->required();
  command->add_option("-o,--output", arguments->output, "The PNG file to write")->required();
  command->add_option("--size", arguments->size, "Pixels, WIDTHxHEIGHT")
      ->check(CLI::Validator(checkSize, "WxH"));
  command->add_option("--camera", arguments->camera, "Azimuth and elevation in degrees; 0,0 looks along -z")
      ->check(CLI::Validator(checkCamera, "AZ,EL"));
  command->add_option("--color", arguments->color, "Hair colour, linear R G B from 0 to 1")
      ->expected(3)
      ->check(CLI::Range(0.0f, 1.0f));
  command->add_flag("--hair-mesh", arguments->hairMesh, "Draw the hair mesh over the picture");
  command->add_flag("--no-strands", arguments->noStrands, "Leave the strands out");
  command->add_flag("--no-shadows", arguments->noShadows, "Leave the shadow pass out");
  command
      ->add_option("--lod", arguments->lod,
                   "Strands to draw: auto (by their width on the screen), a part from 0 to 1, or off")
      ->check(CLI::Validator(checkLod, "auto|F|off"));
  command->add_flag("--no-lod", arguments->noLod, "Draw every strand and every point: --lod off");
  command->add_flag("--transparent", arguments->transparent, "Transparent background");
  arguments->strands.addTo(*command);
  arguments->evaluate.addTo(*command);
  command->callback([arguments, &session] {
    if (const Status status = render(*arguments, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli

#else

namespace coif::cli {

void addRender(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("render", "Make a picture of a scene (left out of this build)");
  command->allow_extras();
  command->callback(
      [&session] { session.usage("this Coif was built without the preview room, so it cannot render"); });
}

}  // namespace coif::cli

#endif
