// What `coif render` can be told about a picture, and how its words are read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coif/light/camera.h"
#include "coif/light/fibre.h"
#include "coif/light/image.h"
#include "coif/light/lights.h"
#include "coif/preview/preview.h"
#include "coif/scene/scene.h"
#include "command.h"

namespace coif::cli {

struct RenderArguments {
  std::string scene, output, size = "1024x1024", camera, light, lod = "auto", shading = "studio", hair,
                             visibility = "deep-opacity", layers = "7", transparency = "auto";
  std::vector<float> color;
  int samplesPerPixel = 64, turntable = 0;
  double targetError = 0;
  bool hairMesh = false, noStrands = false, noShadows = false, noGround = false, transparent = false;

  /// Gives back --turntable.
  CLI::Option* addTo(CLI::App& command);
  int width() const, height() const;
  /// With lod: the fraction of strands to draw; 0: as many as the picture can tell.
  double strandFraction() const;
  bool pathTraced() const { return shading == "path-traced"; }
  /// Of a preview: what the words ask for.
  PreviewOptions previewOptions(const Scene& document) const;
  /// The document's lights, with the key turned to --light or without any for "none".
  Lights lights(const Scene& document) const;
  Vec3f hairColor(const Scene& document) const;
  /// The fibre of that colour: by preset or by albedo.
  FibreParameters fibre(const Scene& document) const;
};

/// A camera's direction as --camera has it; the scene's own where it is empty.
struct CameraAngles {
  double azimuthDeg = 0, elevationDeg = 0;
};
CameraAngles cameraAngles(const RenderArguments& arguments, const Scene& scene);

/// "out.png" → "out_0001.png" for picture 1.
std::string numberedPath(const std::string& path, int picture);

}  // namespace coif::cli
