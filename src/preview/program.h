// GLSL programs from the files in shaders/.
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"
#include "preview/gl_objects.h"

namespace coif::preview {

/// One program: its files and the macros that choose the permutation.
struct ProgramSource {
  std::string vertex, fragment;      ///< file names in shaders/; a compute shader has no fragment file
  std::vector<std::string> defines;  ///< "NAME" or "NAME value"
};

/// Every program and permutation that the room uses; passes name theirs by index in this list.
enum class ProgramId {
  Backdrop,
  ShadowHead,
  MapRange,
  MapBound,
  MapClusters,
  SortMapLists,
  Overlay,
  Resolve,
  Finish,
  StrandColumns,
  StrandColumnsStyled,
  StrandPoints,
  StrandPointsImported,
  StrandStyled,
  StrandRaster,
  StrandRasterNearest,
};
std::span<const ProgramSource> allPrograms();

/// A shader's whole text: from COIF_SHADER_DIR where set, else embedded; `#include "name"` lines expanded
/// once a file, the macros put after #version. Errors: NotFound.
Result<std::string> shaderText(const std::string& name, std::span<const std::string> defines);

/// The linked programs, each compiled when it is first asked for: what a scene does not use is not compiled.
class Programs {
 public:
  /// `known`: every program that may be asked for, so that none escapes the test that compiles them all.
  explicit Programs(std::span<const ProgramSource> known);
  /// 0 where it does not compile, or is not known; error() then says why.
  GLuint operator[](ProgramId id) const;
  /// A permutation that has no id of its own.
  GLuint operator()(const ProgramSource& source) const;
  const Status& error() const { return error_; }

 private:
  GLuint built(Program& program, const ProgramSource& source) const;

  std::set<std::string> known_;
  mutable std::vector<Program> programs_;
  mutable std::map<std::string, Program> permutations_;  ///< by files and macros
  mutable Status error_;
};

/// Compiles and links. Errors: NotFound, Malformed with the driver's log and the file's name.
Result<Program> buildProgram(const ProgramSource& source);

}  // namespace coif::preview
