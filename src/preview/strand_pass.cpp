#include "preview/passes.h"

namespace coif::preview {

Result<Programs> Programs::build() {
  Programs result;
  for (const ProgramSource& source : allPrograms()) {
    COIF_ASSIGN(Program program, buildProgram(source));
    result.programs_.push_back(std::move(program));
  }
  return result;
}

StrandBuffers::StrandBuffers(const StrandGeometry& geometry)
    : points_(makeBuffer(std::span(geometry.points))), array_(makeVertexArray()) {
  const auto indices = geometry.stripIndices();
  count_ = GLsizei(indices.size());
  indices_ = makeBuffer(std::span(indices));
  glVertexArrayElementBuffer(array_.name(), indices_.name());
}

void StrandBuffers::draw() const {
  if (count_ == 0) return;
  glEnable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, points_.name());
  glBindVertexArray(array_.name());
  glDrawElements(GL_TRIANGLE_STRIP, count_, GL_UNSIGNED_INT, nullptr);
  glDisable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
}

}  // namespace coif::preview
