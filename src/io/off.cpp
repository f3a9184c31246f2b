// Geomview OFF as text: [ST][C][N]OFF, one vertex and one face a line, comments anywhere, optional colours.
#include "io/scan.h"

namespace coif::io {
namespace {

struct OffHeader {
  bool uvs = false, colors = false, normals = false;
};

class OffReader {
 public:
  OffReader(Bytes bytes, const std::filesystem::path& path)
      : text_(asText(bytes)), path_(path), budget_(bytes.size()) {}

  Result<PolygonMesh> read();

 private:
  Status readHeader();
  Status readCounts();
  Status readVertices();
  Status readFace();
  Error fail(ErrorCode code, const std::string& message) const {
    return makeError(code, message, linePlace(text_, cursor_.wordOffset()), path_.string());
  }

  std::string_view text_;
  const std::filesystem::path& path_;
  MemoryBudget budget_;
  TextCursor cursor_{text_, TextCursor::Style::HashComments};
  OffHeader header_;
  std::uint64_t vertexCount_ = 0, faceCount_ = 0;
  std::vector<Vec2> uvs_;
  PolygonMesh mesh_;
  std::uint64_t smallFaces_ = 0;
};

Status OffReader::readHeader() {
  std::string_view word = cursor_.word();
  const std::size_t begin = cursor_.wordOffset();
  const std::size_t key = word.find("OFF");
  if (key == std::string_view::npos) {  // the keyword may be left out
    cursor_ = TextCursor(text_, TextCursor::Style::HashComments, begin);
    return {};
  }
  for (std::string_view prefix = word.substr(0, key); !prefix.empty();) {
    const std::size_t used = prefix.starts_with("ST") ? 2 : 1;
    if (used == 2) {
      header_.uvs = true;
    } else if (prefix[0] == 'C') {
      header_.colors = true;
    } else if (prefix[0] == 'N') {
      header_.normals = true;
    } else {
      return fail(ErrorCode::Unsupported, "OFF of four or n dimensions is not a polygon mesh in space");
    }
    prefix.remove_prefix(used);
  }
  // Some files leave out the line end after the keyword ("OFF8 6 0").
  cursor_ = TextCursor(text_, TextCursor::Style::HashComments, begin + key + 3);
  const std::size_t afterKey = cursor_.offset();
  if (cursor_.wordOnLine() == "BINARY") return fail(ErrorCode::Unsupported, "binary OFF is not read");
  cursor_ = TextCursor(text_, TextCursor::Style::HashComments, afterKey);
  return {};
}

Status OffReader::readCounts() {
  std::int64_t counts[2] = {0, 0};
  for (std::int64_t& count : counts) {
    if (!parseInteger(cursor_.word(), count) || count < 0) {
      return fail(ErrorCode::Malformed, "the numbers of vertices and faces belong here");
    }
  }
  cursor_.nextLine();  // the number of edges, if any, is not used
  vertexCount_ = std::uint64_t(counts[0]);
  faceCount_ = std::uint64_t(counts[1]);
  // A vertex takes at least "0 0 0", a face "3 0 1 2", each with a line end.
  const std::uint64_t rest = text_.size() - cursor_.offset() + 1;
  if (vertexCount_ > rest / 6 || faceCount_ > rest / 2) {
    return fail(ErrorCode::Malformed, "the header states more vertices or faces than the file can hold");
  }
  return {};
}

Status OffReader::readVertices() {
  COIF_TRY(budget_.reserve(mesh_.positions, vertexCount_));
  if (header_.uvs) COIF_TRY(budget_.reserve(uvs_, vertexCount_));
  for (std::uint64_t v = 0; v < vertexCount_; ++v) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) {
      if (!parseNumber(i == 0 ? cursor_.word() : cursor_.wordOnLine(), p[i])) {
        return fail(ErrorCode::Malformed, "vertex " + std::to_string(v) + " needs three numbers");
      }
    }
    if (!p.allFinite()) return fail(ErrorCode::Degenerate, "vertex " + std::to_string(v) + " is not finite");
    mesh_.positions.push_back(p);
    if (header_.uvs) {  // the last two numbers of the line
      Vec2 uv(0, 0);
      for (std::string_view word = cursor_.wordOnLine(); !word.empty(); word = cursor_.wordOnLine()) {
        uv[0] = uv[1];
        if (!parseNumber(word, uv[1]))
          return fail(ErrorCode::Malformed, "a texture coordinate is not a number");
      }
      if (!uv.allFinite()) return fail(ErrorCode::Degenerate, "a texture coordinate is not finite");
      uvs_.push_back(uv);
    }
    cursor_.nextLine();
  }
  return {};
}

Status OffReader::readFace() {
  std::int64_t count = 0;
  if (!parseInteger(cursor_.word(), count) || count < 0) {
    return fail(ErrorCode::Malformed,
                "face " + std::to_string(mesh_.faceCount() + smallFaces_) + " needs a number of corners");
  }
  const std::size_t first = mesh_.corners.size();
  for (std::int64_t i = 0; i < count; ++i) {
    std::int64_t vertex = 0;
    if (!parseInteger(cursor_.wordOnLine(), vertex) || vertex < 0 || std::uint64_t(vertex) >= vertexCount_) {
      return fail(ErrorCode::Malformed, "face " + std::to_string(mesh_.faceCount() + smallFaces_) +
                                            " names a vertex that does not exist");
    }
    mesh_.corners.push_back(std::uint32_t(vertex));
    if (header_.uvs) mesh_.cornerUvs.push_back(uvs_[std::size_t(vertex)]);
  }
  cursor_.nextLine();  // leaves out a colour
  if (count < 3) {
    mesh_.corners.resize(first);
    if (header_.uvs) mesh_.cornerUvs.resize(first);
    ++smallFaces_;
  } else {
    closeFace(mesh_);
  }
  return {};
}

Result<PolygonMesh> OffReader::read() {
  COIF_TRY(readHeader());
  COIF_TRY(readCounts());
  COIF_TRY(readVertices());
  // Each corner takes two characters at least.
  const std::uint64_t mostCorners = (text_.size() - std::min(text_.size(), cursor_.offset())) / 2 + 1;
  COIF_TRY(budget_.reserve(mesh_.faceOffsets, faceCount_ + 1));
  COIF_TRY(budget_.reserve(mesh_.corners, mostCorners));
  if (header_.uvs) COIF_TRY(budget_.reserve(mesh_.cornerUvs, mostCorners));
  for (std::uint64_t f = 0; f < faceCount_; ++f) COIF_TRY(readFace());
  if (mesh_.faceCount() == 0) {
    return makeError(ErrorCode::Degenerate, "the file holds no polygon", {}, path_.string());
  }
  noteCount(mesh_, smallFaces_, "faces of fewer than three corners are left out.");
  if (header_.normals) mesh_.notes.push_back("Normals are left out.");
  if (header_.colors) mesh_.notes.push_back("Vertex colours are left out.");
  return std::move(mesh_);
}

}  // namespace

Result<PolygonMesh> readOff(Bytes bytes, const std::filesystem::path& path) {
  return OffReader(bytes, path).read();
}

}  // namespace coif::io
