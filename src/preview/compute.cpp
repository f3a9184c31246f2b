#include "preview/compute.h"

#include <algorithm>

namespace coif::preview {
namespace {

constexpr std::size_t kGroup = 64, kMostGroups = 32768;

void dispatch(std::size_t x, std::size_t y) {
  if (x == 0) return;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                  GL_TEXTURE_FETCH_BARRIER_BIT);
  glDispatchCompute(GLuint(x), GLuint(y), 1);
}

}  // namespace

Buffer emptyBuffer(std::size_t bytes, GLbitfield flags) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  glNamedBufferStorage(name, GLsizeiptr(std::max<std::size_t>(bytes, 16)), nullptr, flags);
  return Buffer(name);
}

void fill(const Buffer& buffer, std::uint32_t value) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glClearNamedBufferData(buffer.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void write(const Buffer& buffer, const void* data, std::size_t bytes) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glNamedBufferSubData(buffer.name(), 0, GLsizeiptr(bytes), data);
}

void read(const Buffer& buffer, std::size_t from, void* data, std::size_t bytes) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(buffer.name(), GLintptr(from), GLsizeiptr(bytes), data);
}

void dispatchGroups(std::size_t count) {
  const std::size_t x = std::min(count, kMostGroups);
  if (x > 0) dispatch(x, (count + x - 1) / x);
}

std::size_t groupsDispatched(std::size_t count) {
  const std::size_t x = std::min(count, kMostGroups);
  return x > 0 ? x * ((count + x - 1) / x) : 0;
}

void dispatchInvocations(std::size_t count) {
  dispatchGroups((count + kGroup - 1) / kGroup);
}

void dispatchSquare(int size) {
  const auto groups = std::size_t(size + 7) / 8;
  dispatch(groups, groups);
}

}  // namespace coif::preview
