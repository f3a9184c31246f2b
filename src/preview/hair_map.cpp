#include "preview/hair_map.h"

#include <algorithm>
#include <cmath>

namespace coif::preview {
namespace {

constexpr int kTargets = 2, kMostLayers = 16, kMostSlices = 256;

/// The uniform block of shaders/hair_map.glsl; std140.
struct HairMapBlock {
  Mat4f mapFromWorld = Mat4f::Identity();
  Vec4f info = Vec4f::Zero();
  std::int32_t counts[4] = {0, 0, 0, 0};
  Vec4f ends[4];
};
static_assert(sizeof(HairMapBlock) == 64 + 16 * 6);

ProgramSource linePass(const char* pass) {
  return {"shadow_line.vert", "shadow_line.frag", {pass}};
}

/// Draws into both layers of `target`, adding up.
void drawAdding(const StrandBuffers& lines, GLuint program, const Texture& target, int size) {
  const Framebuffer framebuffer = makeFramebuffer();
  GLenum buffers[kTargets];
  for (int t = 0; t < kTargets; ++t) {
    buffers[t] = GLenum(GL_COLOR_ATTACHMENT0 + t);
    glNamedFramebufferTextureLayer(framebuffer.name(), buffers[t], target.name(), 0, t);
  }
  glNamedFramebufferDrawBuffers(framebuffer.name(), kTargets, buffers);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  glViewport(0, 0, size, size);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE);
  glUseProgram(program);
  lines.draw();
  glDisable(GL_BLEND);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace

Status checkMapOptions(const VisibilityOptions& options) {
  const char* wrong = nullptr;
  if (options.slices < 1 || options.slices > kMostSlices) wrong = "an opacity map has 1 … 256 slices here";
  if (options.layers < 0 || options.layers > kMostLayers)
    wrong = "a deep opacity map has 1 … 16 layers here, or 0 to choose them";
  if (!(options.bound > 0)) wrong = "the bound for choosing layers has to be positive";
  if (options.clusters != 4) wrong = "density clustering has 4 clusters here";
  if (options.occupancySlices != 128 || options.slabs != 4)
    wrong = "occupancy maps have 128 slices in 4 slabs here";
  if (!(options.layerSize >= 0 && std::isfinite(options.layerSize)))
    wrong = "a layer's size has to be positive";
  return wrong != nullptr ? Status(makeError(ErrorCode::InvalidArgument, wrong)) : Status();
}

std::vector<std::string> mapDefines(const VisibilityOptions& options) {
  std::vector<std::string> defines;
  switch (options.method) {
    case VisibilityMethod::Opacity:
      defines = {"VISIBILITY_OPACITY"};
      break;
    case VisibilityMethod::DensityClustering:
      defines = {"VISIBILITY_DENSITY_CLUSTERING"};
      break;
    case VisibilityMethod::DeepOpacity:
      defines = {"VISIBILITY_DEEP_OPACITY"};
      break;
    case VisibilityMethod::Occupancy:
      defines = {"VISIBILITY_OCCUPANCY"};
      break;
    case VisibilityMethod::Exact:
      defines = {"VISIBILITY_EXACT"};
      break;
    case VisibilityMethod::LightMap:  // the light volume takes its place
      defines = {"VISIBILITY_NONE", "LIGHT_MAP"};
      break;
    case VisibilityMethod::None:
      defines = {"VISIBILITY_NONE"};
      break;
  }
  if (needsWholeRange(options)) defines.push_back("WHOLE_RANGE readonly");
  return defines;
}

std::vector<std::vector<std::string>> mapQueryPermutations() {
  std::vector<std::vector<std::string>> all;
  for (const VisibilityMethod method :
       {VisibilityMethod::None, VisibilityMethod::Opacity, VisibilityMethod::DensityClustering,
        VisibilityMethod::LightMap, VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy,
        VisibilityMethod::Exact}) {
    VisibilityOptions options;
    options.method = method;
    all.push_back(mapDefines(options));
  }
  VisibilityOptions enlarged;
  enlarged.method = VisibilityMethod::DeepOpacity;
  enlarged.past = PastLastLayer::EnlargeLast;
  all.push_back(mapDefines(enlarged));
  return all;
}

std::vector<ProgramSource> mapPrograms() {
  std::vector<ProgramSource> all = walkPrograms();
  for (const char* pass : {"PASS_MEANS", "PASS_CLUSTERS"}) all.push_back(linePass(pass));
  for (const auto& defines : mapQueryPermutations()) all.push_back({"map_query.comp", "", defines});
  return all;
}

Result<HairMap> HairMap::make(const Programs& programs, const StrandBuffers* lines, const LightView& view,
                              double opacity, const VisibilityOptions& options) {
  HairMap map;
  map.view_ = view;
  map.options_ = options;
  const bool drawn = options.method != VisibilityMethod::LightMap;  // that one looks into the light volume
  if (drawn && (lines == nullptr || lines->plan().points == 0)) map.options_.method = VisibilityMethod::None;
  map.placeUniforms(opacity);
  if (lines != nullptr) COIF_TRY(map.draw(programs, *lines));
  return map;
}

void HairMap::placeUniforms(double opacity) {
  HairMapBlock block;
  const Vec3& eye = view_.eye;
  const auto row = [&](const Vec3& axis) {
    Eigen::RowVector4d r;
    r << axis.transpose(), -axis.dot(eye);
    return r;
  };
  Eigen::Matrix4d m;
  const Eigen::RowVector4d depth = row(view_.forward),
                           one = view_.perspective ? depth : Eigen::RowVector4d(0, 0, 0, 1);
  m.row(0) = row(view_.right) / view_.texel + 0.5 * view_.size * one;
  m.row(1) = row(view_.up) / view_.texel + 0.5 * view_.size * one;
  m.row(2) = depth;
  m.row(3) = one;
  block.mapFromWorld = m.cast<float>();
  block.info =
      Vec4f(float(view_.size), float(kNearFraction * view_.depthRange), float(view_.texel), float(opacity));
  const bool opacityMap = options_.method == VisibilityMethod::Opacity;
  block.counts[0] = opacityMap ? options_.slices : options_.layers;
  block.counts[2] = int(options_.past);
  block.counts[3] = view_.perspective ? 1 : 0;
  const auto ends = deepLayerEnds(options_.sizes, kMostLayers, std::max(options_.layerSize, 1e-30));
  for (int k = 0; k < kMostLayers; ++k) block.ends[k / 4][k % 4] = float(ends[std::size_t(k)]);
  uniforms_ = makeBuffer(std::span<const HairMapBlock>(&block, 1), GL_DYNAMIC_STORAGE_BIT);
}

Texture HairMap::makeLayers(int count, GLenum format) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
  glTextureStorage3D(name, 1, format, view_.size, view_.size, count);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  const bool integers = format == GL_R32UI;
  bytes_ += std::size_t(view_.size) * std::size_t(view_.size) * std::size_t(count) * (integers ? 4 : 16);
  return Texture(name);
}

Texture HairMap::makeFlat(GLenum format) {
  bytes_ += std::size_t(view_.size) * std::size_t(view_.size) * 8;
  return makeTexture2d(format, view_.size, view_.size);
}

Status HairMap::draw(const Programs& programs, const StrandBuffers& lines) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (view_.size > most)
    return makeError(ErrorCode::TooLarge, "the driver cannot hold a shadow map of this size");
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_MULTISAMPLE);
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, uniforms_.name());
  glViewport(0, 0, view_.size, view_.size);
  Status status;
  switch (options_.method) {
    case VisibilityMethod::Opacity:
      status = drawOpacity(programs, lines);
      break;
    case VisibilityMethod::DensityClustering:
      drawClusters(programs, lines);
      break;
    case VisibilityMethod::DeepOpacity:
      status = drawDeep(programs, lines);
      break;
    case VisibilityMethod::Occupancy:
      status = drawOccupancy(programs, lines);
      break;
    case VisibilityMethod::Exact:
      status = drawLists(programs, lines);
      break;
    case VisibilityMethod::None:
    case VisibilityMethod::LightMap:
      break;
  }
  glEnable(GL_MULTISAMPLE);
  return status;
}

void HairMap::drawWholeRange(const Programs& programs) {
  const std::uint32_t nothing[4] = {0xffffffffu, 0, 0, 0};
  wholeRange_ = makeBuffer(std::span<const std::uint32_t>(nothing));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, wholeRange_.name());
  glUseProgram(programs[ProgramId::MapRange]);
  dispatchSquare(view_.size);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void HairMap::drawClusters(const Programs& programs, const StrandBuffers& lines) {
  drawRange(programs, lines);
  const Texture means = makeLayers(2), amounts = makeLayers(2);
  for (const Texture* sums : {&means, &amounts}) clearColor(*sums, {0, 0, 0, 0});
  bytes_ -= 64 * std::size_t(view_.size) * std::size_t(view_.size);  // not kept
  layers_ = makeLayers(3);
  drawAdding(lines, programs(linePass("PASS_MEANS")), means, view_.size);
  glBindTextureUnit(5, means.name());
  drawAdding(lines, programs(linePass("PASS_CLUSTERS")), amounts, view_.size);
  glBindTextureUnit(6, amounts.name());
  glBindImageTexture(0, layers_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA32F);
  glUseProgram(programs[ProgramId::MapClusters]);
  dispatchSquare(view_.size);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  glBindTextureUnit(5, 0);
  glBindTextureUnit(6, 0);
}

void HairMap::bind() const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, uniforms_.name());
  glBindTextureUnit(2, range_.name());
  glBindTextureUnit(3, layers_.name());
  glBindTextureUnit(4, bits_.name());
  if (lists_) lists_->bind();
  if (wholeRange_.name() != 0) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, wholeRange_.name());
}

std::vector<HairMap::Answer> HairMap::query(const Programs& programs, std::span<const Vec3> points) const {
  std::vector<Vec4f> places;
  for (const Vec3& p : points) places.emplace_back(float(p.x()), float(p.y()), float(p.z()), 0.0f);
  const std::vector<Answer> empty(points.size());
  const Buffer in = makeBuffer(std::span<const Vec4f>(places)), out = makeBuffer(std::span(empty));
  bind();
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, in.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, out.name());
  glUseProgram(programs(ProgramSource{"map_query.comp", "", mapDefines(options_)}));
  glUniform1i(0, int(points.size()));
  glUniform1i(1, options_.filter ? 1 : 0);
  dispatchInvocations(points.size());
  std::vector<Answer> answers(points.size());
  read(out, 0, answers.data(), answers.size() * sizeof(Answer));
  return answers;
}

}  // namespace coif::preview
