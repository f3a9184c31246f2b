#include "preview/passes.h"

namespace coif::preview {

ProgramSource headProgram(const VisibilityOptions& visibility) {
  return {"head.vert", "head.frag", mapDefines(visibility)};
}

ProgramSource strandProgram(const VisibilityOptions& visibility, bool shadows, Topology topology) {
  ProgramSource source{"strand.vert", "strand.frag", {}};
  if (shadows) {
    source.defines = mapDefines(visibility);
    source.defines.push_back("SHADOWS");
  }
  if (topology == Topology::Lines) source.defines.push_back("LINES");
  return source;
}

std::vector<ProgramSource> allPermutations() {
  std::vector<ProgramSource> all(allPrograms().begin(), allPrograms().end());
  const std::vector<ProgramSource> maps = mapPrograms();
  all.insert(all.end(), maps.begin(), maps.end());
  for (const std::vector<std::string>& defines : mapQueryPermutations()) {
    all.push_back({"head.vert", "head.frag", defines});
    all.push_back({"strand.vert", "strand.frag", defines});
    all.back().defines.push_back("SHADOWS");
    all.push_back(all.back());
    all.back().defines.push_back("LINES");
  }
  all.push_back({"strand.vert", "strand.frag", {}});
  all.push_back({"strand.vert", "strand.frag", {"LINES"}});
  return all;
}

}  // namespace coif::preview
