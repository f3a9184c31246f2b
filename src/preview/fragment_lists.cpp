#include "preview/fragment_lists.h"

#include <algorithm>

#include "preview/synthesis.h"

namespace coif::preview {

FragmentLists::FragmentLists(int width, int height)
    : width_(width), height_(height), counts_(makeTexture2d(GL_R32UI, width, height)) {
  clearIntegers(counts_);
}

void FragmentLists::bindCounts() const {
  glBindImageTexture(1, counts_.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
}

Status FragmentLists::makeRoom(std::size_t entryBytes, std::size_t mostBytes) {
  const std::size_t texels = std::size_t(width_) * std::size_t(height_);
  std::vector<std::uint32_t> starts(texels + 1, 0);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  glGetTextureImage(counts_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, GLsizei(texels * 4), starts.data());
  std::size_t sum = 0;
  for (std::uint32_t& start : starts) {
    const std::uint32_t own = start;
    start = std::uint32_t(sum);
    sum += own;
  }
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (sum * entryBytes > std::min(mostBytes, std::size_t(std::max<GLint64>(most, 1 << 24))) ||
      sum > 0xffffffffu) {
    return makeError(ErrorCode::TooLarge, "a list of " + std::to_string(sum) +
                                              " fragments exceeds what the driver can hold; use fewer "
                                              "strands or a smaller picture");
  }
  entries_ = sum;
  starts_ = makeBuffer(std::span<const std::uint32_t>(starts));
  GLuint name = 0;
  glCreateBuffers(1, &name);
  list_ = Buffer(name);
  glNamedBufferStorage(name, GLsizeiptr(std::max<std::size_t>(sum * entryBytes, 16)), nullptr, 0);
  clearIntegers(counts_);
  bytes_ = sum * entryBytes + starts.size() * 4 + texels * 4;
  return {};
}

void FragmentLists::bind() const {
  bindCounts();
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, list_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, starts_.name());
}

void FragmentLists::sort(GLuint program) const {
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  bind();
  const GLuint count = GLuint(width_) * GLuint(height_);
  glUseProgram(program);
  glUniform1ui(0, count);
  dispatchInvocations(count);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

}  // namespace coif::preview
