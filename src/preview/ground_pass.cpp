#include <algorithm>

#include "preview/passes.h"

namespace coif::preview {

double groundRadius(const Ground& ground, const Box& scene, const Vec3& eye) {
  constexpr double kHorizon = 30;
  return std::min(ground.radius, kHorizon * (scene.diagonal() + (eye - ground.point).norm()));
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
