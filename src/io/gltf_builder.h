// The glTF writer's lower half: views, accessors, and the file as GLB or as JSON with its buffer inside.
//
// tinygltf would need every buffer whole in memory, and copies it twice more on the way out: for a gigabyte
// of strands that is too much. Here each view knows its length beforehand and is streamed when the file is
// written.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "io/formats.h"

namespace coif::io {

/// The array type of glTF for each of ours.
enum class GltfTarget { None = 0, Vertices = 34962, Indices = 34963 };

class GltfBuilder {
 public:
  using Json = nlohmann::ordered_json;
  using Sink = std::function<void(Bytes)>;
  using Fill = std::function<void(const Sink&)>;  ///< must write as many bytes as its view states

  Json json;  ///< the writer adds scenes, nodes, meshes and materials here

  int addView(const char* name, std::uint64_t bytes, GltfTarget target, Fill fill);
  /// Floats: `values` must outlive write().
  int addVectors(const char* name, std::span<const Vec3f> values, bool bounds = false);
  int addVectors(const char* name, std::span<const Vec2f> values);
  /// `perElement` floats an element, made when the file is written.
  int addFloats(const char* name, std::uint64_t elements, int perElement, Fill fill);
  int addIndices(const char* name, std::uint64_t count, Fill fill);
  std::uint64_t bytes() const { return size_; }

  /// GLB for ".glb", else JSON with the buffer as base64. Errors: TooLarge, Cancelled, those of SafeFile.
  Result<std::uint64_t> write(const std::filesystem::path& path, const Context& context);

 private:
  struct View {
    std::uint64_t offset, bytes;
    Fill fill;
  };
  int addAccessor(int view, int componentType, std::uint64_t count, int components);
  Status writeBinary(const Sink& sink, const Context& context) const;
  Status writeGlb(SafeFile& file, const Context& context);
  Status writeText(SafeFile& file, const Context& context);
  std::vector<View> views_;
  std::uint64_t size_ = 0;
};

/// Calls at(i) for i in [0, count) and hands the values on in pieces: no array of them all is made.
template <class T, class At>
void streamValues(const GltfBuilder::Sink& sink, std::uint64_t count, At at) {
  constexpr std::uint64_t kPiece = 16384;
  std::vector<T> piece;
  piece.reserve(std::min(count, kPiece));
  for (std::uint64_t i = 0; i < count; ++i) {
    piece.push_back(at(i));
    if (piece.size() == kPiece || i + 1 == count) {
      sink(std::as_bytes(std::span<const T>(piece)));
      piece.clear();
    }
  }
}

}  // namespace coif::io
