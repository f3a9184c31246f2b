#include "preview/synthesis.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace coif::preview {
namespace {

constexpr std::size_t kPackedPoint = 32, kColumnSample = 32, kShade = 8;  // bytes, as shaders/ have them
constexpr std::size_t kAlign =
    32;  // points: a batch starts at a multiple of 256 bytes, enough for every driver

void bind(GLuint binding, const Buffer& buffer) {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.name());
}

std::size_t blockSize() {
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  return std::size_t(std::max<GLint64>(bytes, 1 << 24));
}

float halfToFloat(std::uint32_t bits) {
  const std::uint32_t exponent = (bits >> 10) & 31, mantissa = bits & 1023;
  const float size = exponent == 0 ? std::ldexp(float(mantissa), -24)
                                   : std::ldexp(float(mantissa + 1024), int(exponent) - 25);
  return bits & 0x8000 ? -size : size;
}

Vec3f tangentFrom(std::uint32_t bits) {
  if (bits == 0x80008000u) return Vec3f::Zero();
  const auto part = [](std::uint32_t word) {
    return std::max(float(std::int16_t(word & 0xffff)) / 32767.0f, -1.0f);
  };
  const float x = part(bits), y = part(bits >> 16), z = 1 - std::abs(x) - std::abs(y);
  Vec3f t(x, y, z);
  if (z < 0)
    t.head<2>() = Eigen::Vector2f(std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y));
  return t.normalized();
}

}  // namespace

std::size_t mostBatchPoints() {
  return std::min<std::size_t>(blockSize() / kPackedPoint, std::size_t{1} << 30) / kAlign * kAlign;
}

std::size_t mostRawPoints() {
  return std::min<std::size_t>(blockSize() / 16, std::size_t{1} << 31);
}

HairBuffers::HairBuffers(const HairModel& model, const HairUpload& upload)
    : bytes_(upload.bytes() + model.locks.size() * sizeof(Lock) + model.bundleVertices.size() * 4),
      locks_(makeBuffer(std::span<const Lock>(model.locks))),
      bundleVertices_(makeBuffer(std::span<const std::uint32_t>(model.bundleVertices))),
      vertices_(emptyBuffer(model.mesh.vertices().size() * 16, GL_DYNAMIC_STORAGE_BIT)),
      roots_(makeBuffer(std::span<const Root>(upload.roots))),
      weights_(makeBuffer(std::span<const float>(upload.weights))),
      points_(makeBuffer(std::span<const Eigen::Vector4f>(upload.points))),
      colors_(makeBuffer(std::span<const Eigen::Vector4f>(upload.colors))) {}

std::size_t HairBuffers::move(const HairModel& model) {
  std::vector<Eigen::Vector4f> positions;
  for (const HairVertex& v : model.mesh.vertices()) {
    positions.emplace_back(float(v.position.x()), float(v.position.y()), float(v.position.z()), 0.0f);
  }
  if (!positions.empty()) write(vertices_, positions.data(), positions.size() * 16);
  return positions.size() * 16;
}

void HairBuffers::bindForColumns() const {
  bind(1, locks_), bind(3, vertices_), bind(4, bundleVertices_);
}

void HairBuffers::bindForPoints(const HairModel& model) const {
  bind(1, locks_), bind(3, roots_), bind(4, model.synthesised ? weights_ : points_), bind(5, colors_);
  if (model.styled) bind(8, style_);
}

std::size_t HairBuffers::setStyle(std::span<const Eigen::Vector4f> style) {
  style_ = makeBuffer(style);
  return style.size_bytes();
}

StrandBuffers::StrandBuffers(const HairModel& model, const HairBuffers& hair, const Programs& programs,
                             DetailPlan plan, Topology topology)
    : plan_(std::move(plan)), topology_(topology), array_(makeVertexArray()) {
  std::size_t points = 0, indices = 0;
  for (const Batch& batch : plan_.batches) {
    pointOffsets_.push_back(points);
    indexOffsets_.push_back(indices);
    points += (batch.points + kAlign - 1) / kAlign * kAlign;
    indices += std::size_t(indexCount(batch));
  }
  shares_ = makeBuffer(std::span<const Share>(plan_.shares));
  parameters_ = makeBuffer(std::span<const float>(plan_.parameters));
  columns_ = emptyBuffer(plan_.columns * kColumnSample);
  points_ = emptyBuffer(points * kPackedPoint);
  if (topology_ != Topology::Segments) shades_ = emptyBuffer(points * kShade);
  indices_ = emptyBuffer(indices * 4);
  bytes_ = points * kPackedPoint + indices * 4;
  glVertexArrayElementBuffer(array_.name(), indices_.name());
  make(model, hair, programs);
}

void StrandBuffers::makeColumns(const HairModel& model, const HairBuffers& hair,
                                const Programs& programs) const {
  glUseProgram(programs[model.styled ? ProgramId::StrandColumnsStyled : ProgramId::StrandColumns]);
  hair.bindForColumns();
  bind(2, shares_), bind(5, parameters_), bind(6, columns_);
  glUniform1ui(0, GLuint(plan_.shares.size()));
  glUniform1i(1, int(model.knots));
  if (model.styled) glUniform1ui(14, model.fullPoints());
  dispatchGroups(plan_.shares.size());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void StrandBuffers::describe(const HairModel& model) const {
  glUniform1i(2, int(topology_));
  glUniform1f(12, float(plan_.widthScale));
  glUniform1i(13, model.colored ? 1 : 0);
  if (!model.styled) return;
  glUniform1ui(3, GLuint(model.locks.size()));
  glUniform1ui(14, model.fullPoints());
}

void StrandBuffers::make(const HairModel& model, const HairBuffers& hair, const Programs& programs) const {
  if (plan_.points == 0) return;
  if (model.synthesised) makeColumns(model, hair, programs);
  glUseProgram(programs[model.styled        ? ProgramId::StrandStyled
                        : model.synthesised ? ProgramId::StrandPoints
                                            : ProgramId::StrandPointsImported]);
  hair.bindForPoints(model);
  bind(2, shares_), bind(6, columns_), bind(7, indices_);
  describe(model);
  for (std::size_t b = 0; b < plan_.batches.size(); ++b) {
    const Batch& batch = plan_.batches[b];
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, points_.name(), GLintptr(pointOffsets_[b] * kPackedPoint),
                      GLsizeiptr(batch.points * kPackedPoint));
    const std::uint32_t invocations = model.styled ? batch.strands : batch.points;
    glUniform1ui(0, invocations);
    glUniform1ui(1, GLuint(indexOffsets_[b]));
    glUniform1ui(10, batch.firstShare);
    glUniform1ui(11, batch.shares);
    dispatchInvocations(invocations);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);
}

GLsizei StrandBuffers::indexCount(const Batch& batch) const {
  const std::size_t width = topology_ == Topology::Lines ? 1 : 2;
  return GLsizei(width * batch.points + (topology_ == Topology::Segments ? 0 : batch.strands));
}

void StrandBuffers::bindBatch(std::size_t b) const {
  const auto range = [&](GLuint binding, const Buffer& buffer, std::size_t size) {
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer.name(), GLintptr(pointOffsets_[b] * size),
                      GLsizeiptr(plan_.batches[b].points * size));
  };
  range(0, points_, kPackedPoint);
  if (shades_.name() != 0) range(4, shades_, kShade);
}

void StrandBuffers::draw() const {
  if (plan_.points == 0) return;
  constexpr GLenum kModes[] = {GL_TRIANGLE_STRIP, GL_LINE_STRIP, GL_LINES};
  walked_ += plan_.segments();
  glEnable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
  glBindVertexArray(array_.name());
  for (std::size_t b = 0; b < plan_.batches.size(); ++b) {
    const Batch& batch = plan_.batches[b];
    bindBatch(b);
    glDrawElements(kModes[int(topology_)], indexCount(batch), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(indexOffsets_[b] * 4));
  }
  glDisable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
}

void StrandBuffers::dispatchPoints() const {
  walked_ += plan_.segments();
  for (std::size_t b = 0; b < plan_.batches.size(); ++b) {
    const Batch& batch = plan_.batches[b];
    bindBatch(b);
    glUniform1ui(0, batch.points);
    dispatchInvocations(batch.points);
  }
}

std::vector<StrandBuffers::Point> StrandBuffers::readBack() const {
  struct Packed {
    Vec3f position;
    float width;
    std::uint32_t tangent, seed, redGreen, blueAlong;
  };
  static_assert(sizeof(Packed) == kPackedPoint);
  std::vector<Point> out;
  for (std::size_t b = 0; b < plan_.batches.size(); ++b) {
    std::vector<Packed> packed(plan_.batches[b].points);
    read(points_, pointOffsets_[b] * kPackedPoint, packed.data(), packed.size() * kPackedPoint);
    for (const Packed& p : packed) {
      out.push_back({p.position, p.width, tangentFrom(p.tangent),
                     Vec3f(halfToFloat(p.redGreen & 0xffff), halfToFloat(p.redGreen >> 16),
                           halfToFloat(p.blueAlong & 0xffff)),
                     halfToFloat(p.blueAlong >> 16), p.seed});
    }
  }
  return out;
}

}  // namespace coif::preview
