#include <algorithm>

#include "preview/passes.h"

namespace coif::preview {

double groundRadius(const Ground& ground, double sceneDiagonal) {
  constexpr double kHorizon = 30;  // diagonals
  return std::min(ground.radius, kHorizon * std::max(sceneDiagonal, 1e-9));
}

void drawGround(const Programs& programs, const VertexArray& empty, const Ground& ground, double radius,
                const VisibilityOptions& visibility) {
  const Vec3f middle = ground.point.cast<float>(), normal = ground.normal.cast<float>();
  glUseProgram(programs(groundProgram(visibility)));
  glUniform4f(0, middle.x(), middle.y(), middle.z(), float(radius));
  glUniform3fv(1, 1, normal.data());
  glUniform3fv(2, 1, ground.color.data());
  glBindVertexArray(empty.name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace coif::preview
