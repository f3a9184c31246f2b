#include <cmath>

#include "preview/passes.h"

namespace coif::preview {
namespace {

constexpr float kEdgePixels = 1.6f;

struct OverlayVertex {
  Vec4f position, color;
};

// Hues a golden angle apart, so that neighbouring layers differ most.
Vec4f layerColor(std::uint32_t layer, float alpha) {
  const float hue = 6.2831853f * (0.08f + 0.381966f * float(layer));
  const auto channel = [&](float phase) { return 0.45f + 0.4f * std::cos(hue - phase); };
  return {channel(0), channel(2.0943951f), channel(4.1887902f), alpha};
}

Vec4f at(const HairMesh& mesh, std::uint32_t vertex) {
  Vec4f result;
  result << mesh.position(vertex).cast<float>(), 1.0f;
  return result;
}

}  // namespace

OverlayPass::OverlayPass(const HairMesh& mesh) : array_(makeVertexArray()) {
  std::vector<OverlayVertex> faces, edges;
  const auto edge = [&](std::uint32_t a, std::uint32_t b, float alpha) {
    edges.push_back({at(mesh, a), layerColor(mesh.vertices()[a].layer, alpha)});
    edges.push_back({at(mesh, b), layerColor(mesh.vertices()[b].layer, alpha)});
  };
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      const auto face = bundle.face(layer);
      const Vec4f color = layerColor(layer, 0.10f);
      for (std::size_t t = 1; t + 1 < face.size(); ++t) {
        for (const std::uint32_t v : {face[0], face[t], face[t + 1]}) faces.push_back({at(mesh, v), color});
      }
      for (std::size_t c = 0; c < face.size(); ++c) {
        edge(face[c], face[(c + 1) % face.size()], 0.9f);
        if (layer > 0) edge(bundle.face(layer - 1)[c], face[c], 0.6f);
      }
    }
  }
  faceVertices_ = GLsizei(faces.size());
  edgeVertices_ = GLsizei(3 * edges.size());
  bytes_ = (faces.size() + edges.size()) * sizeof(OverlayVertex);
  faces_ = makeBuffer(std::span<const OverlayVertex>(faces));
  edges_ = makeBuffer(std::span<const OverlayVertex>(edges));
}

void OverlayPass::draw(const Programs& programs) const {
  glUseProgram(programs[ProgramId::Overlay]);
  glBindVertexArray(array_.name());
  glDepthFunc(GL_LEQUAL);
  glUniform1i(0, 0);
  glUniform1f(1, kEdgePixels);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, edges_.name());
  glDrawArrays(GL_TRIANGLES, 0, edgeVertices_);
  glUniform1i(0, 1);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, faces_.name());
  glDrawArrays(GL_TRIANGLES, 0, faceVertices_);
  glDepthFunc(GL_LESS);
}

}  // namespace coif::preview
