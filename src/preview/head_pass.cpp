#include "preview/passes.h"

namespace coif::preview {

HeadBuffers::HeadBuffers(const PolygonMesh& head) : array_(makeVertexArray()) {
  struct Vertex {
    Vec3f position, normal;
  };
  const std::vector<Vec3> normals = vertexNormals(head);
  std::vector<std::uint32_t> indices;
  for (std::size_t f = 0; f < head.faceCount(); ++f) {
    const auto face = head.face(f);
    for (std::size_t t = 1; t + 1 < face.size(); ++t)
      indices.insert(indices.end(), {face[0], face[t], face[t + 1]});
  }
  std::vector<Vertex> vertices(head.vertexCount());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    vertices[v] = {head.positions[v].cast<float>(), normals[v].cast<float>()};
  }
  count_ = GLsizei(indices.size());
  bytes_ = vertices.size() * sizeof(Vertex) + indices.size() * 4;
  vertices_ = makeBuffer(std::span<const Vertex>(vertices));
  indices_ = makeBuffer(std::span<const std::uint32_t>(indices));
  glVertexArrayVertexBuffer(array_.name(), 0, vertices_.name(), 0, sizeof(Vertex));
  glVertexArrayElementBuffer(array_.name(), indices_.name());
  for (GLuint attribute : {0u, 1u}) {
    glEnableVertexArrayAttrib(array_.name(), attribute);
    glVertexArrayAttribFormat(array_.name(), attribute, 3, GL_FLOAT, GL_FALSE, attribute * sizeof(Vec3f));
    glVertexArrayAttribBinding(array_.name(), attribute, 0);
  }
}

void HeadBuffers::draw() const {
  if (count_ == 0) return;
  glBindVertexArray(array_.name());
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace coif::preview
