#include "preview/eye_pass.h"

namespace coif::preview {
namespace {

// How a surface learns what the hair leaves of the key light.
std::vector<std::string> surfaceDefines(const VisibilityOptions& visibility) {
  if (SurfaceShadow::usedBy(visibility)) return {"SURFACE_SHADOW"};
  if (visibility.method == VisibilityMethod::LightMap) return {"LIGHT_MAP"};
  return {};
}

}  // namespace

ProgramSource headProgram(const VisibilityOptions& visibility, bool studio) {
  ProgramSource source{"head.vert", "head.frag", surfaceDefines(visibility)};
  if (studio) source.defines.push_back("SHADING_STUDIO");
  return source;
}

ProgramSource groundProgram(const VisibilityOptions& visibility) {
  return {"ground.vert", "ground.frag", surfaceDefines(visibility)};
}

ProgramSource shadeProgram(const VisibilityOptions& visibility, const ShadeParts& parts) {
  ProgramSource source{"strand_shade.comp", "", {}};
  if (parts.shadows) {
    source.defines = parts.sliced ? std::vector<std::string>{"VISIBILITY_RUNNING"} : mapDefines(visibility);
    source.defines.push_back("SHADOWS");
  }
  if (parts.sliced) source.defines.push_back("SLICED");
  source.defines.push_back(!parts.tables    ? "SHADING_STUDIO"
                           : parts.multiple ? "SHADING_DUAL"
                                            : "SHADING_SINGLE");
  if (parts.grey) source.defines.push_back("GREY");
  return source;
}

std::vector<ProgramSource> allPermutations() {
  std::vector<ProgramSource> all(allPrograms().begin(), allPrograms().end());
  const auto append = [&](const std::vector<ProgramSource>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  append(mapPrograms());
  append(eyePrograms());
  append(SurfaceShadow::programs());
  for (const VisibilityMethod method :
       {VisibilityMethod::None, VisibilityMethod::LightMap, VisibilityMethod::DeepOpacity}) {
    VisibilityOptions visibility;
    visibility.method = method;
    for (const bool studio : {false, true}) all.push_back(headProgram(visibility, studio));
    all.push_back(groundProgram(visibility));
  }
  std::vector<std::vector<std::string>> lights = mapQueryPermutations();
  for (std::vector<std::string>& defines : lights) defines.push_back("SHADOWS");
  lights.push_back({});
  lights.push_back({"SLICED"});
  lights.push_back({"VISIBILITY_RUNNING", "SHADOWS", "SLICED"});
  for (const std::vector<std::string>& defines : lights) {
    for (const char* shading : {"SHADING_STUDIO", "SHADING_SINGLE", "SHADING_DUAL"}) {
      ProgramSource source{"strand_shade.comp", "", defines};
      source.defines.push_back(shading);
      all.push_back(source);
      source.defines.push_back("GREY");
      if (shading != std::string_view("SHADING_STUDIO")) all.push_back(source);
    }
  }
  return all;
}

}  // namespace coif::preview
