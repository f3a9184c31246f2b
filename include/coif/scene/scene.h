// The document: which head, which hair mesh, how strands grow on it and are styled, how it is looked at. A
// .coif file.
#pragma once

#include <filesystem>
#include <string>

#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/light/fibre.h"
#include "coif/light/lights.h"
#include "coif/simulate/dynamics_settings.h"
#include "coif/strands/grow.h"
#include "coif/style/style_operator.h"

namespace coif {

/// The head is named, not stored: a .coif stays a few tens of kilobytes.
struct HeadReference {
  std::filesystem::path path;     ///< as given; relative paths are relative to the .coif file
  std::uint64_t contentHash = 0;  ///< of the file when the hair mesh was laid on it; 0: not recorded
};

/// What grow() is asked for, as the document keeps it.
struct StrandSettings {
  std::size_t count = 20000;
  std::uint32_t points = 32;
  double tolerance = 0;  ///< > 0: adaptive sampling, chord error in scene units
  std::uint64_t seed = 1;
  Knots knots = Knots::Uniform;
  double width = 0;        ///< root diameter in scene units; 0: 0.08 mm
  double tipWidth = 0.25;  ///< tip diameter / root diameter
  bool operator==(const StrandSettings&) const = default;
};

/// Where the key light stands, and how strong the lights are beside Lights' own.
struct LightSettings {
  double azimuthDeg = -42, elevationDeg = 38;  ///< of the key light; 0, 0: from the eye, or from the front
  double key = 1, fill = 1, rim = 1, sky = 1;  ///< factors, >= 0
  bool followCamera = true;                    ///< else they stay where they are about the head
  bool operator==(const LightSettings&) const = default;
};

/// How `coif render` looks at it when not told otherwise.
struct LookSettings {
  double azimuthDeg = 30, elevationDeg = 8;                      ///< of the camera; 0, 0 looks at the face
  Vec3f hairColor = Vec3f(0.16f, 0.08f, 0.04f);                  ///< linear RGB reflectance
  double longitudinalRoughness = 0.3, azimuthalRoughness = 0.3;  ///< FibreParameters' β_m and β_n
  LightSettings light;
  bool operator==(const LookSettings&) const = default;
};

Lights lightsOf(const LightSettings& settings, UpAxis upAxis);
/// Of the hair's surface; its colour is hairColor.
FibreParameters fibreOf(const LookSettings& look);

struct Scene {
  static constexpr int kVersion = 3;  ///< of the file format; 1 had no dynamics, 2 no styles

  std::string name;  ///< of the hairstyle
  HeadReference head;
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;
  HairMesh hairMesh;
  std::uint64_t placedHash =
      0;  ///< meshHash() right after the last placement; equal now: nothing moved since
  StrandSettings strands;
  StyleStack styles;  ///< what is done to the strands, in this order
  LookSettings look;
  DynamicsSettings dynamics;
  std::filesystem::path file;  ///< where it was loaded from or saved to; not stored

  std::filesystem::path headPath() const;  ///< absolute, or relative to the working directory
};

/// 64-bit fingerprint of the mesh's topology and positions.
std::uint64_t meshHash(const HairMesh& mesh);

/// 64-bit fingerprint of a file's bytes. Errors: those of readFile.
Result<std::uint64_t> fileHash(const std::filesystem::path& path);

/// Reads a .coif of this or an older version. Every array is checked before use; the hair mesh must keep all
/// its invariants. Errors: NotFound, Unreadable, Malformed (with the JSON path as the place), Unsupported
/// (newer version).
Result<Scene> loadScene(const std::filesystem::path& path);
Result<Scene> parseScene(std::string_view text, const std::filesystem::path& path);

/// Writes atomically; a relative head path is rewritten relative to the new place. Sets scene.file.
Status saveScene(Scene& scene, const std::filesystem::path& path);
std::string sceneText(const Scene& scene);

}  // namespace coif
