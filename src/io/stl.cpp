// STL, text and binary. Every facet has vertices of its own: the format shares none.
#include <bit>
#include <cstring>

#include "io/scan.h"

namespace coif::io {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;

static_assert(std::endian::native == std::endian::little, "binary STL is read as it lies");

std::uint64_t binarySize(Bytes bytes) {
  std::uint32_t facets = 0;
  std::memcpy(&facets, bytes.data() + 80, 4);
  return kHeaderBytes + std::uint64_t(facets) * kFacetBytes;
}

bool equalIgnoringCase(std::string_view word, std::string_view lower) {
  if (word.size() != lower.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const char c = word[i] >= 'A' && word[i] <= 'Z' ? char(word[i] - 'A' + 'a') : word[i];
    if (c != lower[i]) return false;
  }
  return true;
}

void noteUnwelded(PolygonMesh& mesh) {
  mesh.notes.push_back("STL shares no vertices between facets; none are welded.");
}

Result<PolygonMesh> readBinary(Bytes bytes, const std::filesystem::path& path) {
  const std::uint64_t needed = binarySize(bytes);
  if (needed > bytes.size()) {
    return makeError(ErrorCode::Malformed,
                     "the header promises " + std::to_string(needed) + " bytes, the file has " +
                         std::to_string(bytes.size()),
                     "byte 80", path.string());
  }
  const std::uint64_t facets = (needed - kHeaderBytes) / kFacetBytes;
  PolygonMesh mesh;
  MemoryBudget budget(bytes.size());
  COIF_TRY(budget.reserve(mesh.positions, 3 * facets));
  COIF_TRY(budget.reserve(mesh.corners, 3 * facets));
  COIF_TRY(budget.reserve(mesh.faceOffsets, facets + 1));
  for (std::uint64_t f = 0; f < facets; ++f) {
    float corners[9];
    std::memcpy(corners, bytes.data() + kHeaderBytes + f * kFacetBytes + 12, sizeof corners);
    for (int i = 0; i < 3; ++i) {
      const Vec3 p(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
      if (!p.allFinite()) {
        return makeError(ErrorCode::Degenerate, "a vertex is not finite", "face " + std::to_string(f),
                         path.string());
      }
      mesh.corners.push_back(std::uint32_t(mesh.positions.size()));
      mesh.positions.push_back(p);
    }
    closeFace(mesh);
  }
  if (needed < bytes.size()) {
    mesh.notes.push_back(std::to_string(bytes.size() - needed) + " bytes after the last facet are left out.");
  }
  return mesh;
}

class StlTextReader {
 public:
  StlTextReader(Bytes bytes, const std::filesystem::path& path)
      : text_(asText(bytes)), path_(path), budget_(bytes.size()) {}

  Result<PolygonMesh> read();

 private:
  Status readVertex();
  Status closeFacet();
  Error fail(ErrorCode code, const std::string& message) const {
    return makeError(code, message, linePlace(text_, cursor_.wordOffset()), path_.string());
  }

  std::string_view text_;
  const std::filesystem::path& path_;
  MemoryBudget budget_;
  TextCursor cursor_{text_};
  PolygonMesh mesh_;
};

Status StlTextReader::readVertex() {
  Vec3 p;
  for (int i = 0; i < 3; ++i) {
    if (!parseNumber(cursor_.wordOnLine(), p[i]))
      return fail(ErrorCode::Malformed, "a vertex needs three numbers");
  }
  if (!p.allFinite()) return fail(ErrorCode::Degenerate, "a vertex is not finite");
  mesh_.corners.push_back(std::uint32_t(mesh_.positions.size()));
  mesh_.positions.push_back(p);
  return {};
}

Status StlTextReader::closeFacet() {
  if (mesh_.corners.size() - mesh_.faceOffsets.back() < 3) {
    return fail(ErrorCode::Malformed, "a facet needs three vertices");
  }
  closeFace(mesh_);
  return {};
}

Result<PolygonMesh> StlTextReader::read() {
  // A vertex takes at least "vertex 0 0 0" and a line end.
  const std::uint64_t mostVertices = text_.size() / 13 + 1;
  COIF_TRY(budget_.reserve(mesh_.positions, mostVertices));
  COIF_TRY(budget_.reserve(mesh_.corners, mostVertices));
  COIF_TRY(budget_.reserve(mesh_.faceOffsets, mostVertices / 3 + 2));
  bool inFacet = false;
  for (; !cursor_.atEnd(); cursor_.nextLine()) {
    const std::string_view word = cursor_.wordOnLine();
    if (equalIgnoringCase(word, "vertex")) {
      if (!inFacet) return fail(ErrorCode::Malformed, "a vertex lies outside any facet");
      COIF_TRY(readVertex());
    } else if (equalIgnoringCase(word, "facet")) {
      if (inFacet) return fail(ErrorCode::Malformed, "a facet begins inside another");
      inFacet = true;
    } else if (equalIgnoringCase(word, "endfacet")) {
      if (!inFacet) return fail(ErrorCode::Malformed, "a facet ends that did not begin");
      COIF_TRY(closeFacet());
      inFacet = false;
    }
  }
  if (inFacet) return fail(ErrorCode::Malformed, "the file ends inside a facet");
  return std::move(mesh_);
}

}  // namespace

Result<PolygonMesh> readStl(Bytes bytes, const std::filesystem::path& path) {
  // By size first: many binary files begin with "solid" too.
  const bool sizeFits = bytes.size() >= kHeaderBytes && binarySize(bytes) == bytes.size();
  const bool text =
      !sizeFits &&
      asText(bytes.first(std::min<std::size_t>(bytes.size(), 1024))).find("facet") != std::string_view::npos;
  if (!text && bytes.size() < kHeaderBytes) {
    return makeError(ErrorCode::Malformed, "neither a text nor a binary STL file", {}, path.string());
  }
  COIF_ASSIGN(PolygonMesh mesh, text ? StlTextReader(bytes, path).read() : readBinary(bytes, path));
  if (mesh.faceCount() == 0) {
    return makeError(ErrorCode::Degenerate, "the file holds no polygon", {}, path.string());
  }
  noteUnwelded(mesh);
  return mesh;
}

}  // namespace coif::io
