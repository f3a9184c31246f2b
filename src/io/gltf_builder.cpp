#include "io/gltf_builder.h"

#include "coif/base/check.h"

namespace coif::io {
namespace {

constexpr int kFloat = 5126, kUnsignedInt = 5125;

using Json = GltfBuilder::Json;

std::uint64_t padded(std::uint64_t bytes) {
  return (bytes + 3) / 4 * 4;
}

/// Names come from files and may be no UTF-8: bad bytes are replaced, not refused.
std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

class Base64 {
 public:
  explicit Base64(SafeFile& file) : file_(file) {}
  void write(Bytes bytes) {
    for (const std::byte b : bytes) {
      bits_ = bits_ << 8 | std::uint32_t(b);
      if (++count_ == 3) flush(4);
    }
    file_.write(text_);
    text_.clear();
  }
  void finish() {
    const int left = count_;
    if (left == 0) return;
    for (; count_ < 3; ++count_) bits_ <<= 8;
    flush(left + 1);
    text_.append(std::size_t(3 - left), '=');
    file_.write(text_);
  }

 private:
  void flush(int digits) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int i = 0; i < digits; ++i) text_ += kDigits[bits_ >> (18 - 6 * i) & 63];
    bits_ = 0;
    count_ = 0;
  }
  SafeFile& file_;
  std::string text_;
  std::uint32_t bits_ = 0;
  int count_ = 0;
};

}  // namespace

int GltfBuilder::addView(const char* name, std::uint64_t bytes, GltfTarget target, Fill fill) {
  Json view{{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes}, {"name", name}};
  if (target != GltfTarget::None) view["target"] = int(target);
  json["bufferViews"].push_back(std::move(view));
  views_.push_back({size_, bytes, std::move(fill)});
  size_ = padded(size_ + bytes);
  return int(views_.size()) - 1;
}

int GltfBuilder::addAccessor(int view, int componentType, std::uint64_t count, int components) {
  constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  json["accessors"].push_back({{"bufferView", view},
                               {"componentType", componentType},
                               {"count", count},
                               {"type", kTypes[components]}});
  return int(json["accessors"].size()) - 1;
}

int GltfBuilder::addFloats(const char* name, std::uint64_t elements, int perElement, Fill fill) {
  const std::uint64_t bytes = elements * std::uint64_t(perElement) * sizeof(float);
  return addAccessor(addView(name, bytes, GltfTarget::Vertices, std::move(fill)), kFloat, elements,
                     perElement);
}

int GltfBuilder::addVectors(const char* name, std::span<const Vec2f> values) {
  return addFloats(name, values.size(), 2, [values](const Sink& sink) { sink(std::as_bytes(values)); });
}

int GltfBuilder::addVectors(const char* name, std::span<const Vec3f> values, bool bounds) {
  const int accessor =
      addFloats(name, values.size(), 3, [values](const Sink& sink) { sink(std::as_bytes(values)); });
  if (bounds) {
    Vec3f lo = values[0], hi = values[0];
    for (const Vec3f& v : values) {
      lo = lo.cwiseMin(v);
      hi = hi.cwiseMax(v);
    }
    json["accessors"].back()["min"] = {lo.x(), lo.y(), lo.z()};
    json["accessors"].back()["max"] = {hi.x(), hi.y(), hi.z()};
  }
  return accessor;
}

int GltfBuilder::addIndices(const char* name, std::uint64_t count, Fill fill) {
  const int view = addView(name, count * sizeof(std::uint32_t), GltfTarget::Indices, std::move(fill));
  return addAccessor(view, kUnsignedInt, count, 1);
}

Status GltfBuilder::writeBinary(const Sink& sink, const Context& context) const {
  constexpr std::byte kZeros[4] = {};
  for (const View& view : views_) {
    if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped before the file was replaced");
    context.report("write glTF", size_ == 0 ? 1.0 : double(view.offset) / double(size_));
    std::uint64_t written = 0;
    view.fill([&](Bytes bytes) {
      written += bytes.size();
      sink(bytes);
    });
    COIF_CHECK(written == view.bytes, "a buffer view has another length than stated");
    sink(std::span(kZeros).first(padded(written) - written));
  }
  return {};
}

Status GltfBuilder::writeGlb(SafeFile& file, const Context& context) {
  json["buffers"] = {{{"byteLength", size_}}};
  std::string text = textOf(json);
  text.resize(padded(text.size()), ' ');
  const std::uint64_t total = 12 + 8 + text.size() + 8 + size_;
  if (total > 0xffffffffu) {
    return makeError(ErrorCode::TooLarge,
                     "the file would have " + std::to_string(total) + " bytes; GLB holds 4 GiB at most");
  }
  const std::uint32_t header[] = {0x46546C67, 2, std::uint32_t(total), std::uint32_t(text.size()),
                                  0x4E4F534A};
  file.writeArray(std::span<const std::uint32_t>(header));
  file.write(text);
  const std::uint32_t chunk[] = {std::uint32_t(size_), 0x004E4942};
  file.writeArray(std::span<const std::uint32_t>(chunk));
  return writeBinary([&](Bytes bytes) { file.write(bytes); }, context);
}

/// The buffer goes inside, not in a second file: two files cannot be replaced at once.
Status GltfBuilder::writeText(SafeFile& file, const Context& context) {
  constexpr std::uint64_t kMaxBase64 = std::uint64_t{384}
                                       << 20;  // V8 holds no longer string than 512 Mi characters
  if (size_ > kMaxBase64) {
    return makeError(ErrorCode::TooLarge,
                     ".gltf would hold " + std::to_string(size_) + " bytes as text; write .glb");
  }
  const std::string placeholder = "data:application/octet-stream;base64,";
  json["buffers"] = {{{"uri", placeholder}, {"byteLength", size_}}};
  const std::string text = textOf(json);
  const std::size_t split = text.rfind(placeholder) + placeholder.size();  // "buffers" is the last member
  file.write(std::string_view(text).substr(0, split));
  Base64 base64(file);
  COIF_TRY(writeBinary([&](Bytes bytes) { base64.write(bytes); }, context));
  base64.finish();
  file.write(std::string_view(text).substr(split));
  return {};
}

Result<std::uint64_t> GltfBuilder::write(const std::filesystem::path& path, const Context& context) {
  const std::string extension = path.extension().string();
  const bool binary = extension == ".glb" || extension == ".GLB";
  COIF_ASSIGN(SafeFile file, SafeFile::create(path));
  const Status written = binary ? writeGlb(file, context) : writeText(file, context);
  if (!written.ok()) return inFile(written.error(), path.string());
  const std::uint64_t bytes = file.position();
  COIF_TRY(file.commit());
  return bytes;
}

}  // namespace coif::io
