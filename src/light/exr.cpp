#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>

#include "coif/light/image.h"

namespace coif {
namespace {

constexpr std::array<const char*, 4> kChannels = {"R", "G", "B", "A"};

class MemoryOut : public Imf::OStream {
 public:
  explicit MemoryOut(std::vector<std::byte>& bytes) : OStream("memory"), bytes_(bytes) {}
  void write(const char c[], int n) override {
    bytes_.resize(std::max(bytes_.size(), at_ + std::size_t(n)));
    std::memcpy(bytes_.data() + at_, c, std::size_t(n));
    at_ += std::size_t(n);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = std::size_t(at); }

 private:
  std::vector<std::byte>& bytes_;
  std::size_t at_ = 0;
};

class MemoryIn : public Imf::IStream {
 public:
  explicit MemoryIn(std::span<const std::byte> bytes) : IStream("memory"), bytes_(bytes) {}
  bool read(char c[], int n) override {
    if (n < 0 || at_ > bytes_.size() || std::size_t(n) > bytes_.size() - at_) {
      throw std::runtime_error("the file ends early");
    }
    std::memcpy(c, bytes_.data() + at_, std::size_t(n));
    at_ += std::size_t(n);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = std::size_t(at); }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

// RGBA interleaved, a value of T a channel, the first pixel at `origin` of the data window.
template <class T>
Imf::FrameBuffer frameOf(const T* rgba, Imf::PixelType type, Imath::V2i origin, int width, int height,
                         const std::array<const char*, 4>& names) {
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < 4; ++c) {
    frame.insert(names[c], Imf::Slice::Make(type, rgba + c, origin, width, height, 4 * sizeof(T),
                                            4 * sizeof(T) * std::size_t(width), 1, 1, c == 3 ? 1.0 : 0.0));
  }
  return frame;
}

std::vector<Imath::half> halvesOf(const std::vector<float>& values) {
  static constexpr float kMost = 65504;
  std::vector<Imath::half> halves(values.size());
  std::transform(values.begin(), values.end(), halves.begin(),
                 [](float v) { return Imath::half(std::isnan(v) ? v : std::clamp(v, -kMost, kMost)); });
  return halves;
}

void writeExr(const FloatImage& image, ExrPrecision precision, std::vector<std::byte>& bytes) {
  const Imf::PixelType type = precision == ExrPrecision::Half ? Imf::HALF : Imf::FLOAT;
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const char* name : kChannels) header.channels().insert(name, Imf::Channel(type));
  std::vector<Imath::half> halves;
  if (type == Imf::HALF) halves = halvesOf(image.rgba);
  MemoryOut out(bytes);
  Imf::OutputFile file(out, header, 0);  // no threads of its own
  file.setFrameBuffer(type == Imf::HALF
                          ? frameOf(halves.data(), type, {0, 0}, image.width, image.height, kChannels)
                          : frameOf(image.rgba.data(), type, {0, 0}, image.width, image.height, kChannels));
  file.writePixels(image.height);
}

Result<FloatImage> readExr(std::span<const std::byte> bytes) {
  MemoryIn in(bytes);
  Imf::InputFile file(in, 0);
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                     height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width > kLargestPictureSide || height > kLargestPictureSide) {
    return makeError(ErrorCode::TooLarge, "the EXR picture has " + std::to_string(width) + " × " +
                                              std::to_string(height) + " pixels; " +
                                              std::to_string(kLargestPictureSide) + " a side are read");
  }
  const Imf::ChannelList& channels = file.header().channels();
  const bool grey = channels.findChannel("R") == nullptr && channels.findChannel("Y") != nullptr;
  if (!grey && channels.findChannel("R") == nullptr) {
    return makeError(ErrorCode::Malformed, "the EXR file has neither a channel R nor Y");
  }
  FloatImage image{int(width), int(height)};
  if (grey) {
    Imf::FrameBuffer frame;  // each slice has its own name, so the one grey channel is copied afterwards
    frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, image.rgba.data(), window.min, width, height,
                                       4 * sizeof(float), 4 * sizeof(float) * std::size_t(width)));
    frame.insert("A", Imf::Slice::Make(Imf::FLOAT, image.rgba.data() + 3, window.min, width, height,
                                       4 * sizeof(float), 4 * sizeof(float) * std::size_t(width), 1, 1, 1.0));
    file.setFrameBuffer(frame);
  } else {
    file.setFrameBuffer(
        frameOf(image.rgba.data(), Imf::FLOAT, window.min, image.width, image.height, kChannels));
  }
  file.readPixels(window.min.y, window.max.y);
  if (grey) {
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      image.rgba[i + 1] = image.rgba[i + 2] = image.rgba[i];
  }
  return image;
}

}  // namespace

Result<std::vector<std::byte>> encodeExr(const FloatImage& image, ExrPrecision precision) {
  COIF_TRY(validate(image));
  std::vector<std::byte> bytes;
  try {
    writeExr(image, precision, bytes);
  } catch (const std::exception& e) {
    return makeError(ErrorCode::TooLarge,
                     std::string("the picture could not be encoded as EXR: ") + e.what());
  }
  return bytes;
}

Result<FloatImage> decodeExr(std::span<const std::byte> bytes) {
  try {
    return readExr(bytes);
  } catch (const std::exception& e) {
    return makeError(ErrorCode::Malformed, std::string("not a readable EXR file: ") + e.what());
  }
}

}  // namespace coif
