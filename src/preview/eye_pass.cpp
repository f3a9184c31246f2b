#include "preview/eye_pass.h"

#include <algorithm>

namespace coif::preview {
namespace {

bool inPlace(PreviewTransparency method) {
  return method == PreviewTransparency::Opaque || method == PreviewTransparency::Stochastic ||
         method == PreviewTransparency::AlphaToCoverage;
}

constexpr std::size_t kEntryBytes = 12;  // as shaders/lists.glsl has it

}  // namespace

LightView viewOfCamera(const View& view) {
  LightView camera;
  camera.right = view.right, camera.up = view.up, camera.forward = view.forward;
  camera.eye = view.eye;
  camera.perspective = true;
  camera.texel = view.pixelAtOne;
  camera.depthRange = view.farthest;
  camera.size = std::max(view.width, view.height);
  return camera;
}

std::vector<ProgramSource> eyePrograms() {
  std::vector<ProgramSource> all;
  for (const char* pass :
       {"EYE_OPAQUE", "EYE_STOCHASTIC", "EYE_COVERAGE", "EYE_WEIGHTED", "EYE_COUNT", "EYE_LIST"}) {
    all.push_back({"strand.vert", "strand.frag", {pass}});
    all.push_back({"strand.vert", "strand.frag", {pass, "LINES"}});
  }
  all.push_back({"strand.vert", "strand.frag", {"EYE_OCCUPANCY", "VISIBILITY_OCCUPANCY"}});
  all.push_back({"strand.vert", "strand.frag", {"EYE_OCCUPANCY", "VISIBILITY_OCCUPANCY", "LINES"}});
  all.push_back({"strand.vert", "strand.frag", {"EYE_SLICE", "SLICED"}});
  all.push_back({"strand.vert", "strand.frag", {"EYE_SLICE", "LINES", "SLICED"}});
  all.push_back({"fullscreen.vert", "eye_compose.frag", {"COMPOSE_SLICES"}});
  all.push_back({"fullscreen.vert", "eye_compose.frag", {"COMPOSE_WEIGHTED"}});
  all.push_back({"fullscreen.vert", "eye_compose.frag", {"COMPOSE_LISTS", "LIST_OF_EYE"}});
  all.push_back({"lists_sort.comp", "", {"LIST_OF_EYE"}});
  all.push_back({"head.vert", "shadow_depth.frag", {}});
  const std::vector<ProgramSource> layers = EyeLayers::programs();
  all.insert(all.end(), layers.begin(), layers.end());
  const std::vector<ProgramSource> sorting = SlicedHair::sortPrograms();
  all.insert(all.end(), sorting.begin(), sorting.end());
  all.push_back(SlicedHair::lightProgram());
  return all;
}

Result<EyePass> EyePass::create(PreviewTransparency method, int width, int height) {
  EyePass pass;
  pass.method_ = method;
  pass.width_ = width, pass.height_ = height;
  if (inPlace(method)) return pass;
  if (method == PreviewTransparency::DepthLayers) {
    pass.layers_.emplace(width, height);
    return pass;
  }
  GLuint depth = 0;
  glCreateRenderbuffers(1, &depth);
  pass.depth_ = Renderbuffer(depth);
  glNamedRenderbufferStorage(depth, GL_DEPTH_COMPONENT32F, width, height);
  pass.own_ = makeFramebuffer();
  const GLuint own = pass.own_.name();
  glNamedFramebufferRenderbuffer(own, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  if (method == PreviewTransparency::ExactLists) {
    glNamedFramebufferDrawBuffer(own, GL_NONE);
  } else {
    pass.sum_ = makeTexture2d(GL_RGBA32F, width, height);
    pass.transmittance_ = makeTexture2d(GL_R32F, width, height);
    glNamedFramebufferTexture(own, GL_COLOR_ATTACHMENT0, pass.sum_.name(), 0);
    glNamedFramebufferTexture(own, GL_COLOR_ATTACHMENT1, pass.transmittance_.name(), 0);
    const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(own, 2, buffers);
  }
  if (glCheckNamedFramebufferStatus(own, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return makeError(ErrorCode::TooLarge, "the driver cannot hold a picture of this size");
  }
  return pass;
}

ProgramSource EyePass::strandProgram(const EyeScene& scene, const char* name) const {
  ProgramSource source{"strand.vert", "strand.frag", {name}};
  if (method_ == PreviewTransparency::OccupancyOrdered) source.defines.push_back("VISIBILITY_OCCUPANCY");
  if (scene.strands.topology() == Topology::Lines) source.defines.push_back("LINES");
  return source;
}

Status EyePass::draw(const EyeScene& scene) const {
  switch (method_) {
    case PreviewTransparency::Auto:  // resolved by the session
    case PreviewTransparency::Opaque:
      drawInPlace(scene, "EYE_OPAQUE");
      break;
    case PreviewTransparency::Stochastic:
      drawInPlace(scene, "EYE_STOCHASTIC");
      break;
    case PreviewTransparency::AlphaToCoverage:
      glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
      glEnable(GL_SAMPLE_ALPHA_TO_ONE);
      drawInPlace(scene, "EYE_COVERAGE");
      glDisable(GL_SAMPLE_ALPHA_TO_ONE);
      glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
      break;
    case PreviewTransparency::WeightedAverage:
      drawWeighted(scene, "EYE_WEIGHTED");
      break;
    case PreviewTransparency::OccupancyOrdered:
      if (scene.cameraMap != nullptr) scene.cameraMap->bind();
      drawWeighted(scene, "EYE_OCCUPANCY");
      break;
    case PreviewTransparency::DepthLayers:
      layers_->draw(scene);
      break;
    case PreviewTransparency::ExactLists:
      return drawLists(scene);
    case PreviewTransparency::HalfAngleSlices:  // drawn slice by slice
      break;
  }
  return {};
}

void EyePass::drawInPlace(const EyeScene& scene, const char* pass) const {
  glUseProgram(scene.programs(strandProgram(scene, pass)));
  scene.strands.draw();
}

// The method's own buffers have one sample a pixel; what the head hides must not get into them.
void EyePass::drawHeadDepth(const EyeScene& scene) const {
  const float farthest = 1;
  glBindFramebuffer(GL_FRAMEBUFFER, own_.name());
  glDepthMask(GL_TRUE);
  glClearNamedFramebufferfv(own_.name(), GL_DEPTH, 0, &farthest);
  if (scene.head != nullptr) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glUseProgram(scene.programs(ProgramSource{"head.vert", "shadow_depth.frag", {}}));
    scene.head->draw();
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  glDepthMask(GL_FALSE);
}

void EyePass::drawWeighted(const EyeScene& scene, const char* pass) const {
  drawHeadDepth(scene);
  const float nothing[4] = {0, 0, 0, 0}, all[4] = {1, 1, 1, 1};
  glClearNamedFramebufferfv(own_.name(), GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(own_.name(), GL_COLOR, 1, all);
  glEnable(GL_BLEND);
  glBlendFunci(0, GL_ONE, GL_ONE);
  glBlendFunci(1, GL_ZERO, GL_ONE_MINUS_SRC_COLOR);
  glUseProgram(scene.programs(strandProgram(scene, pass)));
  scene.strands.draw();
  glDisable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ZERO);
  compose(scene, "COMPOSE_WEIGHTED");
}

Status EyePass::drawLists(const EyeScene& scene) const {
  drawHeadDepth(scene);
  FragmentLists lists(width_, height_);
  lists.bindCounts();
  glUseProgram(scene.programs(strandProgram(scene, "EYE_COUNT")));
  scene.strands.draw();
  if (const Status room = lists.makeRoom(kEntryBytes); !room.ok()) {
    scene.targets.bind();
    glDepthMask(GL_TRUE);
    return room;
  }
  lists.bind();
  glUseProgram(scene.programs(strandProgram(scene, "EYE_LIST")));
  scene.strands.draw();
  lists.sort(scene.programs(ProgramSource{"lists_sort.comp", "", {"LIST_OF_EYE"}}));
  lists.bind();
  compose(scene, "COMPOSE_LISTS");
  return {};
}

void EyePass::beginSlices(const EyeScene& scene) const {
  drawHeadDepth(scene);
  const float nothing[4] = {0, 0, 0, 0};
  glClearNamedFramebufferfv(own_.name(), GL_COLOR, 0, nothing);
}

void EyePass::drawSlice(const EyeScene& scene, const SlicedHair& hair, int slice) const {
  glBindFramebuffer(GL_FRAMEBUFFER, own_.name());
  glViewport(0, 0, width_, height_);
  glEnable(GL_BLEND);
  glBlendFunc(hair.frontToBack() ? GL_ONE_MINUS_DST_ALPHA : GL_ONE,
              hair.frontToBack() ? GL_ONE : GL_ONE_MINUS_SRC_ALPHA);
  ProgramSource source = strandProgram(scene, "EYE_SLICE");
  source.defines.push_back("SLICED");
  glUseProgram(scene.programs(source));
  hair.draw(slice);
  glDisable(GL_BLEND);
}

void EyePass::compose(const EyeScene& scene, const char* pass) const {
  scene.targets.bind();
  ProgramSource source{"fullscreen.vert", "eye_compose.frag", {pass}};
  if (method_ == PreviewTransparency::ExactLists) source.defines.push_back("LIST_OF_EYE");
  glUseProgram(scene.programs(source));
  glUniform1i(0, width_);
  glBindTextureUnit(0, sum_.name());
  glBindTextureUnit(1, transmittance_.name());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(scene.empty.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
}

}  // namespace coif::preview
