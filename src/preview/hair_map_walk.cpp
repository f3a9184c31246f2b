// Maps by compute: walks over the map that leave whole numbers, and what makes textures of those.
#include <algorithm>

#include "preview/hair_map.h"

namespace coif::preview {
namespace {

ProgramSource walkPass(const char* pass, const VisibilityOptions& options) {
  ProgramSource source{"map_walk.comp", "", {pass}};
  if (needsWholeRange(options)) source.defines.push_back("WHOLE_RANGE readonly");
  return source;
}
const ProgramSource kResolveRange{"map_resolve.comp", "", {"RESOLVE_RANGE"}};
const ProgramSource kResolveLayers{"map_resolve.comp", "", {"RESOLVE_LAYERS"}};
const ProgramSource kResolveOccupancy{"map_resolve.comp", "", {"RESOLVE_OCCUPANCY"}};

void walk(const StrandBuffers& lines) {
  lines.dispatchPoints();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

/// Numbers of 32 bits a texel that one storage block holds.
std::size_t mostSums(std::size_t texels) {
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  return std::size_t(std::max<GLint64>(most, 1 << 24)) / (4 * texels);
}

Result<Buffer> makeSums(std::size_t texels, std::size_t each) {
  if (each > mostSums(texels))
    return makeError(ErrorCode::TooLarge, "the driver cannot hold a shadow map of this size");
  Buffer sums = emptyBuffer(texels * each * 4);
  fill(sums, 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, sums.name());
  return sums;
}

int inFours(int count) {
  return (count + 3) / 4;
}

}  // namespace

bool needsWholeRange(const VisibilityOptions& options) {
  return options.method == VisibilityMethod::Opacity ||
         (options.method == VisibilityMethod::DeepOpacity && options.past == PastLastLayer::EnlargeLast);
}

std::vector<ProgramSource> walkPrograms() {
  VisibilityOptions deep, enlarged, opacity;
  enlarged.past = PastLastLayer::EnlargeLast;
  opacity.method = VisibilityMethod::Opacity;
  std::vector<ProgramSource> all{kResolveRange, kResolveLayers, kResolveOccupancy,
                                 walkPass("WALK_OPACITY", opacity), walkPass("WALK_DEEP", enlarged)};
  for (const char* pass : {"WALK_RANGE", "WALK_DEEP", "WALK_OCCUPANCY", "WALK_COUNT", "WALK_LIST"})
    all.push_back(walkPass(pass, deep));
  return all;
}

void HairMap::resolve(const Programs& programs, const ProgramSource& source) const {
  glUseProgram(programs(source));
  dispatchSquare(view_.size);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void HairMap::drawRange(const Programs& programs, const StrandBuffers& lines) {
  const std::size_t texels = std::size_t(view_.size) * std::size_t(view_.size);
  const Buffer nearest = emptyBuffer(texels * 4), farthest = emptyBuffer(texels * 4);
  fill(nearest, ~0u), fill(farthest, 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, nearest.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, farthest.name());
  glUseProgram(programs(walkPass("WALK_RANGE", {})));
  walk(lines);
  range_ = makeFlat(GL_RG32F);
  glBindImageTexture(0, range_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
  resolve(programs, kResolveRange);
  glBindTextureUnit(2, range_.name());
  if (needsWholeRange(options_)) drawWholeRange(programs);
}

Status HairMap::drawOpacity(const Programs& programs, const StrandBuffers& lines) {
  drawRange(programs, lines);
  const std::size_t texels = std::size_t(view_.size) * std::size_t(view_.size);
  const int most = int(std::min<std::size_t>(mostSums(texels), 1024) / 4) * 4;
  layers_ = makeLayers(inFours(options_.slices));
  for (int first = 0; first < options_.slices; first += most) {
    const int end = std::min(first + most, options_.slices);
    COIF_ASSIGN(const Buffer sums, makeSums(texels, std::size_t(std::max(end - first, 1))));
    glUseProgram(programs(walkPass("WALK_OPACITY", options_)));
    glUniform2i(1, first, end);
    walk(lines);
    glBindImageTexture(0, layers_.name(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_RGBA32F);
    glUseProgram(programs(kResolveLayers));
    glUniform2i(1, first, end);
    resolve(programs, kResolveLayers);
  }
  return {};
}

Status HairMap::drawDeep(const Programs& programs, const StrandBuffers& lines) {
  drawRange(programs, lines);
  const std::size_t texels = std::size_t(view_.size) * std::size_t(view_.size);
  COIF_ASSIGN(const Buffer sums, makeSums(texels, std::size_t(options_.layers)));
  glUseProgram(programs(walkPass("WALK_DEEP", options_)));
  walk(lines);
  layers_ = makeLayers(inFours(options_.layers));
  glBindImageTexture(0, layers_.name(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_RGBA32F);
  glUseProgram(programs(kResolveLayers));
  glUniform2i(1, 0, options_.layers);
  resolve(programs, kResolveLayers);
  return {};
}

Status HairMap::drawOccupancy(const Programs& programs, const StrandBuffers& lines) {
  drawRange(programs, lines);
  const std::size_t texels = std::size_t(view_.size) * std::size_t(view_.size);
  COIF_ASSIGN(const Buffer sums, makeSums(texels, 8));
  glUseProgram(programs(walkPass("WALK_OCCUPANCY", options_)));
  walk(lines);
  layers_ = makeLayers(1);
  bits_ = makeLayers(4, GL_R32UI);
  glBindImageTexture(0, layers_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA32F);
  glBindImageTexture(2, bits_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R32UI);
  resolve(programs, kResolveOccupancy);
  return {};
}

Result<std::uint64_t> HairMap::texelsTouched(const Programs& programs, const StrandBuffers& lines) const {
  FragmentLists lists(view_.size, view_.size);
  lists.bindCounts();
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, uniforms_.name());
  glUseProgram(programs(walkPass("WALK_COUNT", {})));
  walk(lines);
  COIF_TRY(lists.makeRoom(0, SIZE_MAX));
  return std::uint64_t(lists.entries());
}

Status HairMap::drawLists(const Programs& programs, const StrandBuffers& lines) {
  lists_.emplace(view_.size, view_.size);
  lists_->bindCounts();
  glUseProgram(programs(walkPass("WALK_COUNT", options_)));
  walk(lines);
  COIF_TRY(lists_->makeRoom(8, listLimit_));
  lists_->bind();
  glUseProgram(programs(walkPass("WALK_LIST", options_)));
  walk(lines);
  lists_->sort(programs[ProgramId::SortMapLists]);
  bytes_ += lists_->bytes();
  return {};
}

}  // namespace coif::preview
