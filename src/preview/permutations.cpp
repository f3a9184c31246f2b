#include "preview/eye_pass.h"

namespace coif::preview {

ProgramSource headProgram(const VisibilityOptions& visibility, bool studio) {
  ProgramSource source{"head.vert", "head.frag", mapDefines(visibility)};
  if (studio) source.defines.push_back("SHADING_STUDIO");
  return source;
}

ProgramSource groundProgram(const VisibilityOptions& visibility) {
  return {"ground.vert", "ground.frag", mapDefines(visibility)};
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
  std::vector<std::vector<std::string>> lights = mapQueryPermutations();
  for (std::vector<std::string>& defines : lights) {
    all.push_back({"head.vert", "head.frag", defines});
    all.push_back(all.back());
    all.back().defines.push_back("SHADING_STUDIO");
    all.push_back({"ground.vert", "ground.frag", defines});
    defines.push_back("SHADOWS");
  }
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
