#include "render_options.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>
#include <utility>

#include "coif/base/check.h"
#include "coif/light/hair_color.h"
#include "coif/preview/names.h"
#include "values.h"

namespace coif::cli {
namespace {

constexpr HairColor kColors[] = {HairColor::Black, HairColor::Brown, HairColor::Red,
                                 HairColor::Blond, HairColor::Grey,  HairColor::Dyed};

CLI::IsMember oneOf(std::span<const char* const> names, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words(names.begin(), names.end());
  words.insert(words.end(), more.begin(), more.end());
  return CLI::IsMember(words);
}

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

bool parseFraction(const std::string& text, double& fraction) {
  int used = 0;
  return std::sscanf(text.c_str(), "%lf%n", &fraction, &used) == 1 && used == int(text.size()) &&
         fraction > 0 && fraction <= 1;
}

std::string checkSize(const std::string& text) {
  int width, height;
  return parseSize(text, width, height) ? ""
                                        : "WIDTHxHEIGHT from 1x1 to 8192x8192 is wanted, not '" + text + "'";
}
std::string checkCamera(const std::string& text) {
  double azimuth, elevation;
  return parseAngles(text, azimuth, elevation)
             ? ""
             : "AZIMUTH,ELEVATION in degrees, elevation from -90 to 90, is wanted, not '" + text + "'";
}
std::string checkLight(const std::string& text) {
  double azimuth, elevation;
  return text == "none" || parseAngles(text, azimuth, elevation)
             ? ""
             : "AZIMUTH,ELEVATION in degrees as seen from the camera, or none, is wanted, not '" + text + "'";
}
std::string checkLod(const std::string& text) {
  double fraction;
  return text == "auto" || text == "off" || parseFraction(text, fraction)
             ? ""
             : "auto, off or a part of the strands in (0, 1] is wanted, not '" + text + "'";
}
std::string checkOutput(const std::string& text) {
  const std::string extension = extensionOf(text);
  return extension == ".png" || extension == ".exr" ? ""
                                                    : "pictures are .png or .exr files, not '" + text + "'";
}

}  // namespace

int RenderArguments::width() const {
  int w = 0, h = 0;
  parseSize(size, w, h);
  return w;
}
int RenderArguments::height() const {
  int w = 0, h = 0;
  parseSize(size, w, h);
  return h;
}

double RenderArguments::strandFraction() const {
  double fraction = 0;
  return parseFraction(lod, fraction) ? fraction : 0;
}

PreviewOptions RenderArguments::previewOptions(const Scene& document) const {
  PreviewOptions options;
  options.width = width(), options.height = height();
  options.hairColor = hairColor(document);
  options.fibre = fibre(document);
  // The words were checked as they were read.
  if (!pathTraced()) COIF_CHECK(setShading(options, shading).ok(), "a shading");
  COIF_CHECK(setTransparency(options, transparency).ok(), "a transparency");
  COIF_CHECK(setVisibility(options, visibility).ok(), "a visibility method");
  options.useAbsorption = true;
  options.shadows = !noShadows;
  options.visibility.layers = layers == "auto" ? 0 : std::stoi(layers);
  options.lod = lod != "off";
  options.strandFraction = strandFraction();
  options.transparentBackground = transparent;
  return options;
}

Lights RenderArguments::lights(const Scene& document) const {
  LightSettings settings = document.look.light;
  if (light != "none" && !light.empty()) {
    parseAngles(light, settings.azimuthDeg, settings.elevationDeg);
    settings.followCamera = true;
  }
  Lights lights = lightsOf(settings, document.upAxis);
  if (light == "none") lights.key.color = lights.fill.color = lights.rim.color = Vec3f::Zero();
  return lights;
}

FibreParameters RenderArguments::fibre(const Scene& document) const {
  FibreParameters fibre = fibreOf(document.look);
  for (HairColor preset : kColors) {
    if (hair == nameOf(preset)) {
      fibre.absorption = absorptionOf(preset);
      return fibre;
    }
  }
  fibre.absorption = absorptionFromAlbedo(hairColor(document).cast<double>(), fibre.azimuthalRoughness);
  return fibre;
}

Vec3f RenderArguments::hairColor(const Scene& document) const {
  for (HairColor preset : kColors) {
    if (hair == nameOf(preset)) {
      return albedoFromAbsorption(absorptionOf(preset), FibreParameters().azimuthalRoughness).cast<float>();
    }
  }
  return color.size() == 3 ? Vec3f(color[0], color[1], color[2]) : document.look.hairColor;
}

CameraAngles cameraAngles(const RenderArguments& arguments, const Scene& scene) {
  CameraAngles angles{scene.look.azimuthDeg, scene.look.elevationDeg};
  if (!arguments.camera.empty()) parseAngles(arguments.camera, angles.azimuthDeg, angles.elevationDeg);
  return angles;
}

std::string numberedPath(const std::string& path, int picture) {
  const std::filesystem::path whole(path);
  char number[16];
  std::snprintf(number, sizeof number, "_%04d", picture);
  return (whole.parent_path() / (whole.stem().string() + number + whole.extension().string())).string();
}

CLI::Option* RenderArguments::addTo(CLI::App& command) {
  std::vector<std::string> colors;
  for (HairColor preset : kColors) colors.push_back(nameOf(preset));
  command.add_option("scene", scene, "The scene, a .coif file")->required();
  command.add_option("-o,--output", output, "The picture to write, .png or .exr (linear light)")
      ->required()
      ->check(CLI::Validator(checkOutput, "FILE"));
  command.add_option("--size", size, "Pixels, WIDTHxHEIGHT")->check(CLI::Validator(checkSize, "WxH"));
  command.add_option("--camera", camera, "Azimuth and elevation in degrees; 0,0 looks along -z")
      ->check(CLI::Validator(checkCamera, "AZ,EL"));
  command
      .add_option("--light", light, "Where the key light stands, as seen from the camera; none: only the sky")
      ->check(CLI::Validator(checkLight, "AZ,EL|none"));
  command.add_option("--visibility", visibility, "How hair shadows itself from the key light")
      ->check(oneOf(visibilityNames()));
  command.add_option("--transparency", transparency, "How hairs thinner than a pixel cover it")
      ->check(oneOf(transparencyNames()));
  command
      .add_option("--layers", layers, "Layers of deep opacity maps; auto: the fewest whose error is bounded")
      ->check(CLI::IsMember({"auto", "3", "7", "11", "15"}));
  command
      .add_option(
          "--shading", shading,
          "How hairs scatter light: in a moment by OpenGL, or path-traced: every bounce, slowly, with "
          "a stated error")
      ->check(oneOf(shadingNames(), {"path-traced"}));
  command.add_option("--spp", samplesPerPixel, "Samples a pixel of a path-traced picture")
      ->check(CLI::Range(2, 1 << 20));
  command.add_option("--target-error", targetError, "Path traced: stop at this relative error of a pixel")
      ->check(number(0, 10));
  CLI::Option* turn =
      command.add_option("--turntable", turntable, "So many pictures all around: FILE_0001.png …")
          ->check(CLI::Range(1, 10000));
  command.add_option("--lod", lod, "auto, off, or the part of the strands to draw")
      ->check(CLI::Validator(checkLod, "auto|off|F"));
  auto* hairOption = command.add_option("--hair", hair, "Hair colour by name")->check(CLI::IsMember(colors));
  command.add_option("--color", color, "Hair colour, linear R G B from 0 to 1")
      ->expected(3)
      ->check(number(0, 1))
      ->excludes(hairOption);
  command.add_flag("--hair-mesh", hairMesh, "Draw the hair mesh over the picture");
  command.add_flag("--no-strands", noStrands, "Leave the strands out");
  command.add_flag("--no-shadows", noShadows, "Leave the shadow pass out");
  command.add_flag("--no-ground", noGround, "Nothing under the head");
  command.add_flag_callback(
      "--no-lod", [this] { lod = "off"; }, "Draw every strand and every point");
  command.add_flag("--transparent", transparent, "Transparent background");
  return turn;
}

}  // namespace coif::cli
