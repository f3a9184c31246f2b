#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "preview/passes.h"

namespace coif::preview {
namespace {

constexpr double kBias = 0.012;  // of the diagonal: roots lie on the head's surface
constexpr double kSpread = 2.5;  // of a map's hair's width: hairs on a head stand some 3.5 apart
constexpr int kLayerMap = 128;   // texels a side of the map that layer sizes are chosen on

Texture uploadVolume(const LightVolume& volume) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_3D, 1, &name);
  glTextureStorage3D(name, 1, GL_RGBA32F, volume.nx, volume.ny, volume.nz);
  glTextureSubImage3D(name, 0, 0, 0, 0, volume.nx, volume.ny, volume.nz, GL_RGBA, GL_FLOAT,
                      volume.values.data());
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTextureParameteri(name, wrap, GL_CLAMP_TO_EDGE);
  }
  return Texture(name);
}

// The first surface of the head from the light, as a part of the map's range of depth.
Texture drawHead(const Programs& programs, const HeadBuffers* head, int size) {
  Texture map = makeTexture2d(GL_DEPTH_COMPONENT32F, size, size);
  clearDepth(map, 1);
  if (head == nullptr) return map;
  const Framebuffer target = makeFramebuffer();
  glNamedFramebufferTexture(target.name(), GL_DEPTH_ATTACHMENT, map.name(), 0);
  glNamedFramebufferDrawBuffer(target.name(), GL_NONE);
  glBindFramebuffer(GL_FRAMEBUFFER, target.name());
  glViewport(0, 0, size, size);
  glEnable(GL_DEPTH_TEST);
  glUseProgram(programs[ProgramId::ShadowHead]);
  head->draw();
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return map;
}

// Before the coarse strands were widened.
double meanWidth(const CoarseStrands& coarse) {
  double sum = 0;
  for (const CoarseStrands::Point& p : coarse.points) sum += double(p.width);
  return coarse.points.empty() ? 0 : sum / double(coarse.points.size()) / coarse.scale;
}

StrandSet asStrands(const CoarseStrands& coarse) {
  StrandSet strands;
  for (const CoarseStrands::Point& p : coarse.points) {
    strands.points.push_back(p.position);
    strands.widths.push_back(p.width);
  }
  strands.offsets.assign(coarse.starts.begin(), coarse.starts.end());
  return strands;
}

}  // namespace

LightView placeShadowMap(const Box& scene, const Box& hair, int mapSize, FrameData& frame) {
  const LightView view = distantLightView(frame.lightDirection[0].head<3>().cast<double>(), scene, mapSize);
  const double size = std::max(hair.diagonal(), 1e-3 * view.depthRange);
  frame.shadowInfo = Vec4f(0, float(view.depthRange), float(view.texel), float(kBias * size));
  return view;
}

double chooseLayerSize(const CoarseStrands& hair, const LightView& view, const VisibilityOptions& options,
                       const Context& context) {
  const StrandSet strands = asStrands(hair);
  const LightView small = distantLightView(-view.forward, hair.box, kLayerMap);
  const auto stream = FragmentStream::make(strands, small, {}, context);
  if (!stream.ok()) return 0.02 * std::max(hair.box.diagonal(), 1e-12);
  return chooseLayerSize(*stream, options.sizes, options.layers, options.past, context).size;
}

Result<ShadowPass> ShadowPass::make(const Programs& programs, const LightView& view,
                                    const VisibilityOptions& options, bool lists,
                                    const CoarseStrands* strands, const Fog* fog, const Openness* open,
                                    const StrandBuffers* lines, const HeadBuffers* headBuffers, bool surfaces,
                                    FrameData& frame, const Context& context) {
  ShadowPass pass;
  LightVolumes volumes;
  if (fog != nullptr) {
    const Vec3 lights[3] = {frame.lightDirection[0].head<3>().cast<double>(),
                            frame.lightDirection[1].head<3>().cast<double>(),
                            frame.lightDirection[2].head<3>().cast<double>()};
    volumes = makeLightVolumes(*fog, *open, lights, context);
  }
  const LightVolume& volume = volumes.hairOnly;
  frame.volumeLo << volume.lo.cast<float>(), float(volume.cell);
  frame.volumeScale << volume.extent().cwiseInverse().cast<float>(), 0.0f;
  frame.shadowInfo.x() = options.filter ? 1.0f : 0.0f;
  pass.hairOnly_ = uploadVolume(volumes.hairOnly);
  pass.withHead_ = uploadVolume(volumes.withHead);
  VisibilityOptions chosen = options;
  if (strands == nullptr) chosen.method = VisibilityMethod::None;
  const auto sizeOf = [&](int layers) {
    VisibilityOptions of = chosen;
    of.layers = layers;
    return chooseLayerSize(*strands, view, of, context);
  };
  const bool deep =
      chosen.method == VisibilityMethod::DeepOpacity && lines != nullptr && lines->plan().points > 0;
  if (deep && chosen.layers == 0) {
    COIF_ASSIGN(pass.map_, HairMap::makeFewest(programs, *lines, view, 1, chosen, lists, sizeOf));
  } else {
    if (deep && !(chosen.layerSize > 0)) chosen.layerSize = sizeOf(chosen.layers);
    COIF_ASSIGN(pass.map_, HairMap::make(programs, lines, view, 1, chosen));
  }
  pass.map_.bind();
  pass.headDepth_ = drawHead(programs, headBuffers, view.size);
  if (surfaces && lines != nullptr && SurfaceShadow::usedBy(pass.map_.options()))
    pass.surface_ = SurfaceShadow(programs, pass.map_, pass.headDepth_,
                                  kSpread * meanWidth(*strands) * lines->plan().widthScale);
  return pass;
}

void ShadowPass::bindForHead() const {
  bind(hairOnly_);
  surface_.bind();
}

void ShadowPass::bindForHair() const {
  bind(withHead_);
  glBindTextureUnit(7, hairOnly_.name());
}

void ShadowPass::bind(const Texture& volume) const {
  map_.bind();
  glBindTextureUnit(0, volume.name());
  glBindTextureUnit(1, headDepth_.name());
}

}  // namespace coif::preview
