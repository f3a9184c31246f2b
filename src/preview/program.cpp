#include "preview/program.h"

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "preview/shader_files.h"

namespace coif::preview {
namespace {

Result<std::string> rawText(const std::string& name) {
  if (const char* folder = std::getenv("COIF_SHADER_DIR"); folder != nullptr && *folder != '\0') {
    std::ifstream file(std::string(folder) + "/" + name, std::ios::binary);
    std::ostringstream text;
    if (!file || !(text << file.rdbuf())) {
      return makeError(ErrorCode::NotFound, "the shader folder COIF_SHADER_DIR has no such file", {}, name);
    }
    return text.str();
  }
  for (const ShaderFile& file : embeddedShaders()) {
    if (file.name == name) return std::string(file.text);
  }
  return makeError(ErrorCode::NotFound, "there is no such shader in the library", {}, name);
}

Status expand(const std::string& name, std::set<std::string>& seen, std::string& out) {
  if (!seen.insert(name).second) return {};
  COIF_ASSIGN(const std::string text, rawText(name));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view kInclude = "#include \"";
    if (line.starts_with(kInclude)) {
      COIF_TRY(expand(line.substr(kInclude.size(), line.rfind('"') - kInclude.size()), seen, out));
    } else {
      out += line + '\n';
    }
  }
  return {};
}

std::string keyOf(const ProgramSource& source) {
  std::string key = source.vertex + '|' + source.fragment;
  for (const std::string& define : source.defines) key += '|' + define;
  return key;
}

Result<GLuint> compile(GLenum stage, const std::string& name, std::span<const std::string> defines) {
  COIF_ASSIGN(const std::string text, shaderText(name, defines));
  const GLuint shader = glCreateShader(stage);
  const char* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  char log[2000] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glDeleteShader(shader);
  return makeError(ErrorCode::Malformed, std::string("the shader does not compile: ") + log, {}, name);
}

}  // namespace

std::span<const ProgramSource> allPrograms() {
  static const std::vector<ProgramSource> programs = {
      {"fullscreen.vert", "backdrop.frag", {}},
      {"shadow_head.vert", "shadow_depth.frag", {}},
      {"map_range.comp", "", {}},
      {"map_bound.comp", "", {}},
      {"map_clusters.comp", "", {}},
      {"lists_sort.comp", "", {}},
      {"overlay.vert", "overlay.frag", {}},
      {"fullscreen.vert", "resolve.frag", {}},
      {"fullscreen.vert", "finish.frag", {}},
      {"strand_columns.comp", "", {}},
      {"strand_columns.comp", "", {"STYLED"}},
      {"strand_points.comp", "", {}},
      {"strand_points.comp", "", {"IMPORTED"}},
      {"strand_styled.comp", "", {}},
      {"strand_raster.comp", "", {}},
      {"strand_raster.comp", "", {"NEAREST"}},
  };
  return programs;
}

Result<std::string> shaderText(const std::string& name, std::span<const std::string> defines) {
  std::string text = "#version 450 core\n";
  for (const std::string& define : defines) text += "#define " + define + '\n';
  std::set<std::string> seen;
  COIF_TRY(expand(name, seen, text));
  return text;
}

Result<Program> buildProgram(const ProgramSource& source) {
  const bool compute = source.fragment.empty();
  Program program(glCreateProgram());
  for (const bool first : {true, false}) {
    if (compute && !first) continue;
    const GLenum stage = compute ? GL_COMPUTE_SHADER : first ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER;
    COIF_ASSIGN(const GLuint shader, compile(stage, first ? source.vertex : source.fragment, source.defines));
    glAttachShader(program.name(), shader);
    glDeleteShader(shader);  // it lives as long as the program
  }
  glLinkProgram(program.name());
  GLint ok = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
  if (ok) return program;
  char log[2000] = "";
  glGetProgramInfoLog(program.name(), sizeof log, nullptr, log);
  return makeError(ErrorCode::Malformed, std::string("the program does not link: ") + log, {},
                   source.vertex + (compute ? "" : " + " + source.fragment));
}

Programs::Programs(std::span<const ProgramSource> known) : programs_(allPrograms().size()) {
  for (const ProgramSource& source : known) known_.insert(keyOf(source));
}

GLuint Programs::operator[](ProgramId id) const {
  return built(programs_[std::size_t(id)], allPrograms()[std::size_t(id)]);
}

GLuint Programs::operator()(const ProgramSource& source) const {
  const std::string key = keyOf(source);
  if (!known_.contains(key) && error_.ok())
    error_ = makeError(ErrorCode::NotFound, "this permutation is not in the list of all: " + key);
  return built(permutations_[key], source);
}

GLuint Programs::built(Program& program, const ProgramSource& source) const {
  if (program.name() == 0 && error_.ok()) {
    Result<Program> result = buildProgram(source);
    if (result.ok()) {
      program = *std::move(result);
    } else {
      error_ = result.error();
    }
  }
  return program.name();
}

}  // namespace coif::preview
