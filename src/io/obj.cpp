// Wavefront OBJ, both ways: polygons, UVs and groups; curves, surfaces, points and lines are left out and
// counted.
#include <charconv>
#include <cmath>

#include "io/scan.h"

namespace coif::io {
namespace {

struct ObjCounts {
  std::uint64_t vertices = 0, uvs = 0, faces = 0, corners = 0;
};

ObjCounts countElements(std::string_view text) {
  ObjCounts counts;
  for (TextCursor cursor(text, TextCursor::Style::Continuations); !cursor.atEnd(); cursor.nextLine()) {
    const std::string_view word = cursor.wordOnLine();
    if (word.starts_with('#')) cursor.restOfLine();
    if (word == "v") ++counts.vertices;
    if (word == "vt") ++counts.uvs;
    if (word != "f" && word != "fo") continue;
    ++counts.faces;
    while (!cursor.wordOnLine().empty()) ++counts.corners;
  }
  return counts;
}

class ObjReader {
 public:
  ObjReader(Bytes bytes, const std::filesystem::path& path)
      : text_(asText(bytes)), path_(path), budget_(bytes.size()) {}

  Result<PolygonMesh> read();

 private:
  Status readLine(std::string_view keyword);
  Status readVertex();
  Status readUv();
  Status readFace();
  Status readCorner(std::string_view word);
  /// From the file's 1-based or negative index to an index from 0. `count`: elements so far.
  Status resolve(std::string_view word, std::size_t count, const char* what, std::uint32_t& index);
  Status checkIndices();
  void finishUvs();
  Error fail(ErrorCode code, const std::string& message, std::size_t offset) const {
    return makeError(code, message, linePlace(text_, offset), path_.string());
  }

  std::string_view text_;
  const std::filesystem::path& path_;
  MemoryBudget budget_;
  TextCursor cursor_{text_, TextCursor::Style::Continuations};
  ObjCounts counts_;
  PolygonMesh mesh_;
  FaceNames names_;
  bool namesUvs_ = false;
  std::vector<Vec2> uvs_;
  std::vector<std::uint32_t> cornerUvs_;  // into uvs_, kNone without
  // The greatest index met, to be checked at the end: a face may come before its vertices.
  struct Greatest {
    std::uint64_t index = 0;
    std::size_t offset = 0;
  } greatestVertex_, greatestUv_;
  std::uint64_t smallFaces_ = 0, otherElements_ = 0, colors_ = 0, normals_ = 0;
};

Status ObjReader::readVertex() {
  Vec3 p;
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = cursor_.wordOnLine();
    if (!parseNumber(word, p[i])) {
      return fail(ErrorCode::Malformed,
                  "a vertex needs three numbers, not '" + std::string(word.substr(0, 40)) + "'",
                  cursor_.offset());
    }
  }
  if (!p.allFinite())
    return fail(ErrorCode::Degenerate, "a vertex position is not finite", cursor_.wordOffset());
  mesh_.positions.push_back(p);
  int more = 0;  // 1: a rational weight, which polygons do not use; 3 or more: a colour
  for (auto word = cursor_.wordOnLine(); !word.empty() && word[0] != '#'; word = cursor_.wordOnLine()) ++more;
  if (more >= 3) ++colors_;
  return {};
}

Status ObjReader::readUv() {
  Vec2 uv(0, 0);
  if (!parseNumber(cursor_.wordOnLine(), uv[0])) {
    return fail(ErrorCode::Malformed, "a texture coordinate is not a number", cursor_.offset());
  }
  const std::string_view second = cursor_.wordOnLine();
  if (!second.empty() && !parseNumber(second, uv[1])) {
    return fail(ErrorCode::Malformed, "a texture coordinate is not a number", cursor_.wordOffset());
  }
  if (!uv.allFinite())
    return fail(ErrorCode::Degenerate, "a texture coordinate is not finite", cursor_.wordOffset());
  uvs_.push_back(uv);
  return {};
}

Status ObjReader::resolve(std::string_view word, std::size_t count, const char* what, std::uint32_t& index) {
  std::int64_t value = 0;
  if (!parseInteger(word, value) || value == 0) {
    return fail(ErrorCode::Malformed,
                std::string("a face has '") + std::string(word.substr(0, 40)) + "' where the index of a " +
                    what + " belongs",
                cursor_.wordOffset());
  }
  if (value < 0) value += std::int64_t(count) + 1;
  if (value < 1 || value > std::int64_t(kNone)) {
    return fail(ErrorCode::Malformed, std::string("a face names a ") + what + " that does not exist",
                cursor_.wordOffset());
  }
  index = std::uint32_t(value - 1);
  return {};
}

Status ObjReader::readCorner(std::string_view word) {
  const std::size_t slash = word.find('/');
  std::uint32_t vertex = 0, uv = kNone;
  COIF_TRY(resolve(word.substr(0, slash), mesh_.positions.size(), "vertex", vertex));
  if (slash != std::string_view::npos) {
    const std::string_view rest = word.substr(slash + 1);
    const std::string_view uvWord = rest.substr(0, rest.find('/'));
    namesUvs_ = namesUvs_ || !uvWord.empty();
    if (!uvWord.empty() && counts_.uvs > 0) COIF_TRY(resolve(uvWord, uvs_.size(), "texture coordinate", uv));
  }
  if (vertex >= greatestVertex_.index) greatestVertex_ = {vertex, cursor_.wordOffset()};
  if (uv != kNone && uv >= greatestUv_.index) greatestUv_ = {uv, cursor_.wordOffset()};
  mesh_.corners.push_back(vertex);
  cornerUvs_.push_back(uv);
  return {};
}

Status ObjReader::readFace() {
  const std::size_t first = mesh_.corners.size();
  while (true) {
    const std::string_view word = cursor_.wordOnLine();
    if (word.empty() || word.starts_with('#')) break;
    COIF_TRY(readCorner(word));
  }
  cursor_.restOfLine();
  if (mesh_.corners.size() - first < 3) {
    mesh_.corners.resize(first);
    cornerUvs_.resize(first);
    ++smallFaces_;
  } else {
    closeFace(mesh_);
  }
  return {};
}

Status ObjReader::readLine(std::string_view keyword) {
  if (keyword == "v") return readVertex();
  if (keyword == "vt") return readUv();
  if (keyword == "f" || keyword == "fo") return readFace();  // "fo": the format's first version
  const auto name = [&](FaceNames::Kind kind) {
    return names_.set(kind, cursor_.restOfLine(), mesh_.faceCount(), budget_);
  };
  if (keyword == "usemtl") return name(FaceNames::Material);
  if (keyword == "g") return name(FaceNames::Group);
  if (keyword == "o") return name(FaceNames::Object);
  if (keyword == "vn") ++normals_;
  if (keyword == "p" || keyword == "l" || keyword == "curv" || keyword == "curv2" || keyword == "surf")
    ++otherElements_;
  if (keyword.starts_with('#')) cursor_.restOfLine();  // a comment is not continued
  return {};
}

Status ObjReader::checkIndices() {
  if (mesh_.faceCount() == 0) {
    return makeError(ErrorCode::Degenerate, "the file holds no polygon", {}, path_.string());
  }
  if (greatestVertex_.index >= mesh_.positions.size()) {
    return fail(ErrorCode::Malformed,
                "a face names vertex " + std::to_string(greatestVertex_.index + 1) + ", but the file has " +
                    std::to_string(mesh_.positions.size()),
                greatestVertex_.offset);
  }
  const bool anyUv = greatestUv_.offset > 0;  // a corner is never the first byte
  if (anyUv && greatestUv_.index >= uvs_.size()) {
    return fail(ErrorCode::Malformed,
                "a face names texture coordinate " + std::to_string(greatestUv_.index + 1) +
                    ", but the file has " + std::to_string(uvs_.size()),
                greatestUv_.offset);
  }
  return {};
}

void ObjReader::finishUvs() {
  std::uint64_t without = 0;
  for (const std::uint32_t uv : cornerUvs_) without += uv == kNone ? 1 : 0;
  if (without == cornerUvs_.size()) return;
  mesh_.cornerUvs.reserve(cornerUvs_.size());
  for (const std::uint32_t uv : cornerUvs_) mesh_.cornerUvs.push_back(uv == kNone ? Vec2(0, 0) : uvs_[uv]);
  noteCount(mesh_, without, "corners have no UV; they get (0, 0).");
}

Result<PolygonMesh> ObjReader::read() {
  counts_ = countElements(text_);
  COIF_TRY(budget_.reserve(mesh_.positions, counts_.vertices));
  COIF_TRY(budget_.reserve(uvs_, counts_.uvs));
  COIF_TRY(budget_.reserve(mesh_.faceOffsets, counts_.faces + 1));
  COIF_TRY(budget_.reserve(mesh_.corners, counts_.corners));
  COIF_TRY(budget_.reserve(cornerUvs_, counts_.corners));
  if (counts_.uvs > 0) COIF_TRY(budget_.take(counts_.corners, sizeof(Vec2)));
  COIF_TRY(budget_.take(counts_.faces, sizeof(std::uint32_t)));  // faceGroups
  for (; !cursor_.atEnd(); cursor_.nextLine()) COIF_TRY(readLine(cursor_.wordOnLine()));
  COIF_TRY(checkIndices());
  finishUvs();
  names_.finish(mesh_, {"materials", "groups", "objects"});
  if (namesUvs_ && counts_.uvs == 0) {
    mesh_.notes.push_back("The faces name texture coordinates, but the file has none; there are no UVs.");
  }
  noteCount(mesh_, smallFaces_, "faces of fewer than three corners are left out.");
  noteCount(mesh_, otherElements_, "points, lines, curves and surfaces are left out.");
  noteCount(mesh_, colors_, "vertex colours are left out.");
  noteCount(mesh_, normals_, "normals are left out.");
  return std::move(mesh_);
}

}  // namespace

Result<PolygonMesh> readObj(Bytes bytes, const std::filesystem::path& path) {
  return ObjReader(bytes, path).read();
}

}  // namespace coif::io

namespace coif {
namespace {

void append(std::string& out, double value) {
  char digits[32];
  const auto [end, code] =
      std::to_chars(digits, digits + sizeof digits, value);  // shortest that reads back the same
  out.append(digits, code == std::errc() ? end : digits);
}

/// A name on a line of its own: no line end may break it.
std::string oneLine(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < ' ') c = '_';
  }
  return name.empty() ? "default" : name;
}

std::string faceLine(const PolygonMesh& mesh, std::size_t face) {
  std::string line = "f";
  for (std::size_t c = mesh.faceOffsets[face]; c < mesh.faceOffsets[face + 1]; ++c) {
    line.append(1, ' ').append(std::to_string(mesh.corners[c] + std::uint64_t{1}));
    if (!mesh.cornerUvs.empty()) line.append(1, '/').append(std::to_string(c + 1));
  }
  return line + '\n';
}

}  // namespace

Status savePolygonMesh(const PolygonMesh& mesh, const std::filesystem::path& path) {
  if (path.extension() != ".obj" && path.extension() != ".OBJ") {
    return makeError(ErrorCode::Unsupported, "meshes are written as .obj", {}, path.string());
  }
  const Status valid = validate(mesh);
  if (!valid.ok()) return inFile(valid.error(), path.string());
  COIF_ASSIGN(SafeFile file, SafeFile::create(path));
  file.write(std::string_view("# Coif\n"));
  std::string line;
  const auto writeNumbers = [&](const char* keyword, const auto& vector) {
    line = keyword;
    for (Eigen::Index i = 0; i < vector.size(); ++i) append(line += ' ', vector[i]);
    file.write(line += '\n');
  };
  for (const Vec3& p : mesh.positions) writeNumbers("v", p);
  for (const Vec2& uv : mesh.cornerUvs) writeNumbers("vt", uv);
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    const bool named = !mesh.faceGroups.empty() && (f == 0 || mesh.faceGroups[f] != mesh.faceGroups[f - 1]);
    if (named) file.write("g " + oneLine(mesh.groupNames[mesh.faceGroups[f]]) + '\n');
    file.write(faceLine(mesh, f));
  }
  return file.commit();
}

}  // namespace coif
