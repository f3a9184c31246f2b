#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "preview/passes.h"

namespace coif::preview {
namespace {

// Ends of the layers behind the first hair, as parts of the hair's diagonal: Fibonacci-like, thin in front.
constexpr double kLayerEnds[] = {0.012, 0.035, 0.08, 0.18};
constexpr double kBias = 0.012;        // of the diagonal: roots lie on the head's surface
constexpr float kHairOpacity = 0.75f;  // how much of the light that meets a black hair is lost

Texture uploadVolume(const LightVolume& volume) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_3D, 1, &name);
  glTextureStorage3D(name, 1, GL_RGBA16F, volume.nx, volume.ny, volume.nz);
  glTextureSubImage3D(name, 0, 0, 0, 0, volume.nx, volume.ny, volume.nz, GL_RGBA, GL_FLOAT,
                      volume.values.data());
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTextureParameteri(name, wrap, GL_CLAMP_TO_EDGE);
  }
  return Texture(name);
}

Texture clearedDepthMap(int size) {
  Texture map = makeTexture2d(GL_DEPTH_COMPONENT32F, size, size);
  const float farthest = 1;
  glClearTexImage(map.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, &farthest);
  return map;
}

Framebuffer depthTarget(const Texture& depth) {
  Framebuffer target = makeFramebuffer();
  glNamedFramebufferTexture(target.name(), GL_DEPTH_ATTACHMENT, depth.name(), 0);
  glNamedFramebufferDrawBuffer(target.name(), GL_NONE);
  return target;
}

}  // namespace

// The map covers the scene's bounding sphere.
void placeShadowMap(const Box& scene, const Box& hair, int mapSize, FrameData& frame) {
  const Vec3 toLight = frame.lightDirection[0].head<3>().cast<double>().normalized();
  const Vec3 right = toLight.unitOrthogonal(), up = toLight.cross(right);
  const Vec3 centre = 0.5 * (scene.lo + scene.hi);
  const double radius = std::max({0.51 * scene.diagonal(), 1e-6 * centre.norm(), 1e-9});
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.row(0).head<3>() = right / (2 * radius);
  m.row(1).head<3>() = up / (2 * radius);
  m.row(2).head<3>() = -toLight / (2 * radius);
  m.block<3, 1>(0, 3) = Vec3::Constant(0.5) - m.topLeftCorner<3, 3>() * centre;
  frame.shadowFromWorld = m.cast<float>();
  const double size = std::max(hair.diagonal(), 1e-3 * radius);
  frame.shadowInfo =
      Vec4f(float(mapSize), float(2 * radius), float(2 * radius / mapSize), float(kBias * size));
  for (int k = 0; k < 4; ++k) frame.shadowLayers[k] = float(kLayerEnds[k] * size);
  frame.shadowRight = Vec4f(float(right.x()), float(right.y()), float(right.z()), kHairOpacity);
  frame.shadowUp = Vec4f(float(up.x()), float(up.y()), float(up.z()), 0);
}

ShadowPass::ShadowPass(const Programs& programs, const Box& scene, const CoarseStrands* strands,
                       const StrandBuffers* buffers, const PolygonMesh* head, const HeadBuffers* headBuffers,
                       FrameData& frame, Buffer& frameBuffer, int mapSize, const Context& context) {
  placeShadowMap(scene, strands != nullptr ? strands->box : scene, mapSize, frame);
  LightVolumes volumes;
  if (strands != nullptr) {
    const Vec3 lights[3] = {frame.lightDirection[0].head<3>().cast<double>(),
                            frame.lightDirection[1].head<3>().cast<double>(),
                            frame.lightDirection[2].head<3>().cast<double>()};
    volumes = makeLightVolumes(*strands, head, lights, frame.viewUp.head<3>().cast<double>(), context);
  }
  const LightVolume& volume = volumes.hairOnly;
  frame.volumeLo << volume.lo.cast<float>(), float(volume.cell);
  frame.volumeScale << volume.extent().cwiseInverse().cast<float>(), 0.0f;
  hairOnly_ = uploadVolume(volumes.hairOnly);
  withHead_ = uploadVolume(volumes.withHead);
  glNamedBufferSubData(frameBuffer.name(), 0, sizeof frame, &frame);

  headDepth_ = clearedDepthMap(mapSize);
  hairFront_ = clearedDepthMap(mapSize);
  hairLayers_ = makeTexture2d(GL_RGBA32F, mapSize, mapSize);
  glClearTexImage(hairLayers_.name(), 0, GL_RGBA, GL_FLOAT, nullptr);
  glViewport(0, 0, mapSize, mapSize);
  glEnable(GL_DEPTH_TEST);
  if (headBuffers != nullptr) {
    const Framebuffer target = depthTarget(headDepth_);
    glBindFramebuffer(GL_FRAMEBUFFER, target.name());
    glUseProgram(programs[ProgramId::ShadowHead]);
    headBuffers->draw();
  }
  if (buffers != nullptr) {
    const Framebuffer front = depthTarget(hairFront_);
    glBindFramebuffer(GL_FRAMEBUFFER, front.name());
    glUseProgram(programs[buffers->topology() == Topology::Lines ? ProgramId::ShadowFrontLines
                                                                 : ProgramId::ShadowFront]);
    buffers->draw();
    glDisable(GL_DEPTH_TEST);
    const Framebuffer layers = makeFramebuffer();
    glNamedFramebufferTexture(layers.name(), GL_COLOR_ATTACHMENT0, hairLayers_.name(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, layers.name());
    glBindTextureUnit(2, hairFront_.name());
    glUseProgram(programs[buffers->topology() == Topology::Lines ? ProgramId::ShadowLayersLines
                                                                 : ProgramId::ShadowLayers]);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    buffers->draw();
    glDisable(GL_BLEND);
  }
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void ShadowPass::bind(const Texture& volume) const {
  glBindTextureUnit(0, volume.name());
  glBindTextureUnit(1, headDepth_.name());
  glBindTextureUnit(2, hairFront_.name());
  glBindTextureUnit(3, hairLayers_.name());
}

}  // namespace coif::preview
