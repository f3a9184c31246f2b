// The GLSL files, embedded by the build.
#pragma once

#include <span>
#include <string_view>

namespace coif::preview {

struct ShaderFile {
  std::string_view name;
  std::string_view text;
};
std::span<const ShaderFile> embeddedShaders();

}  // namespace coif::preview
