// A glTF file opened: its structure through tinygltf, its buffers as spans, every access checked against
// them.
//
// tinygltf is given the structure alone (scenes, nodes, meshes, accessors, buffer views), without buffers,
// images, extras and extension data: it would copy every buffer, read textures from disk before asking
// anyone, and it checks no index and no length.
#pragma once

#include <tiny_gltf.h>

#include <deque>
#include <nlohmann/json.hpp>

#include "io/scan.h"

namespace coif::io {

struct GltfDocument {
  tinygltf::Model model;
  nlohmann::json json;         ///< whole, for names, extras and extensions; buffers' data URIs cut out
  std::vector<Bytes> buffers;  ///< as long as each one states
  std::deque<std::vector<std::byte>> own;  ///< what `buffers` shows of external files and data URIs
};

/// Opens .gltf or .glb. Errors: Malformed (container, JSON, schema), Unsupported (version, a required
/// extension that changes geometry), NotFound or Unreadable (a side file), TooLarge.
Result<GltfDocument> openGltf(Bytes bytes, const std::filesystem::path& path, MemoryBudget& budget);

/// Element count of an accessor of `components` numbers an element; checks every index, offset and length
/// that reading it will use. `integers`: an index accessor.
Result<std::size_t> checkAccessor(const GltfDocument& document, int accessor, int components, bool integers);

/// Reads a checked accessor: floats as they are, normalised integers as fractions, other integers as numbers.
void readFloats(const GltfDocument& document, int accessor, int components, float* out);
void readIndices(const GltfDocument& document, int accessor, std::uint32_t* out);

/// checkAccessor, then the elements, taken from the budget.
template <class T>
Status readAccessor(const GltfDocument& document, int accessor, MemoryBudget& budget, std::vector<T>& out) {
  constexpr bool kIntegers = std::is_same_v<T, std::uint32_t>;
  constexpr int kComponents = int(sizeof(T) / 4);
  COIF_ASSIGN(const std::size_t count, checkAccessor(document, accessor, kComponents, kIntegers));
  COIF_TRY(budget.take(count, sizeof(T)));
  out.resize(count);
  if constexpr (kIntegers) {
    readIndices(document, accessor, out.data());
  } else {
    readFloats(document, accessor, kComponents, reinterpret_cast<float*>(out.data()));
  }
  return {};
}

}  // namespace coif::io
