#include <cmath>

#include "preview/session_impl.h"

namespace coif {
namespace {

constexpr double kUnit = 1.0 / 16384;  // as shaders/strand_raster.comp has it
constexpr int kRepeats = 3;

Buffer filled(std::size_t count, std::uint32_t value) {
  Buffer buffer = emptyBuffer(count * 4);
  fill(buffer, value);
  return buffer;
}

}  // namespace

Result<ComputeCoverage> PreviewSession::coverageByCompute(int width, int height, bool nearest) {
  Impl& my = *impl_;
  if (my.eyeStrands == nullptr) return makeError(ErrorCode::NotFound, "no picture with hair was made yet");
  if (width < 1 || height < 1 || width > 8192 || height > 8192) {
    return makeError(ErrorCode::InvalidArgument, "a picture's width and height must lie between 1 and 8192");
  }
  COIF_ASSIGN(const View view, makeView(my.camera, my.box(), width, height));
  COIF_TRY(my.device->gl->makeCurrent());
  const CurrentContext current(*my.device->gl);
  my.device->gl->log().clear();
  PreviewOptions options;
  options.width = width, options.height = height;
  const FrameData frame = makeFrame(view, my.lights, options);
  const Buffer frameBuffer = makeBuffer(std::span<const FrameData>(&frame, 1));
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  ComputeCoverage result{width, height, std::vector<float>(pixels), 0};
  std::vector<std::uint32_t> depths(pixels);
  for (int k = 0; k < kRepeats; ++k) {  // the first compiles
    const Buffer optical = filled(pixels, 0), depth = filled(pixels, ~0u);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frameBuffer.name());
    glFinish();
    const Stopwatch watch;
    glUseProgram((*my.device->programs)[nearest ? ProgramId::StrandRasterNearest : ProgramId::StrandRaster]);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, optical.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, depth.name());
    my.eyeStrands->dispatchPoints();
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glFinish();
    const double seconds = watch.seconds();
    result.seconds = k == 0 ? seconds : std::min(result.seconds, seconds);
    if (k + 1 == kRepeats) read(optical, 0, depths.data(), pixels * 4);
  }
  COIF_TRY(my.device->programs->error());
  if (const auto& errors = my.device->gl->log().errors; !errors.empty()) {
    return makeError(ErrorCode::Unsupported, "the OpenGL driver reports an error: " + errors.front());
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double depth = kUnit * depths[std::size_t(height - 1 - y) * std::size_t(width) + std::size_t(x)];
      result.coverage[std::size_t(y) * std::size_t(width) + std::size_t(x)] = float(1 - std::exp(-depth));
    }
  }
  return result;
}

}  // namespace coif
