# Script: cmake -DDIR=<shaders> -DOUT=<file.cpp> -P EmbedShaders.cmake
# Writes a C++ source with every GLSL file of DIR as a string, by name, in name order.
file(GLOB names RELATIVE ${DIR} ${DIR}/*.glsl ${DIR}/*.vert ${DIR}/*.frag ${DIR}/*.comp)
list(SORT names)
set(text "// Generated from shaders/ by cmake/EmbedShaders.cmake.\n#include \"preview/shader_files.h\"\n\n")
string(APPEND text "namespace coif::preview {\n\nstd::span<const ShaderFile> embeddedShaders() {\n")
string(APPEND text "  static const ShaderFile files[] = {\n")
foreach(name IN LISTS names)
  file(READ ${DIR}/${name} body)
  string(APPEND text "    {\"${name}\", R\"__glsl(${body})__glsl\"},\n")
endforeach()
string(APPEND text "  };\n  return files;\n}\n\n}  // namespace coif::preview\n")
file(WRITE ${OUT} "${text}")
