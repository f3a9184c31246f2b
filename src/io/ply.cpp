// Stanford PLY: text and binary of both byte orders, elements and properties in any order and of any type.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "io/scan.h"

namespace coif::io {
namespace {

enum class Scalar { I8, U8, I16, U16, I32, U32, F32, F64 };

struct ScalarName {
  const char* name;
  Scalar type;
};
constexpr ScalarName kScalarNames[] = {
    {"char", Scalar::I8},   {"int8", Scalar::I8},     {"uchar", Scalar::U8},   {"uint8", Scalar::U8},
    {"short", Scalar::I16}, {"int16", Scalar::I16},   {"ushort", Scalar::U16}, {"uint16", Scalar::U16},
    {"int", Scalar::I32},   {"int32", Scalar::I32},   {"uint", Scalar::U32},   {"uint32", Scalar::U32},
    {"float", Scalar::F32}, {"float32", Scalar::F32}, {"double", Scalar::F64}, {"float64", Scalar::F64},
};

std::size_t sizeOf(Scalar type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[std::size_t(type)];
}

struct Property {
  std::string name;
  Scalar type = Scalar::F32;
  std::optional<Scalar> countType;  // of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
enum class Encoding { Text, Little, Big };
struct PlyHeader {
  Encoding encoding = Encoding::Text;
  std::vector<Element> elements;
  std::size_t bodyOffset = 0;
};

/// Numbers one after the other, from text or from bytes.
class Numbers {
 public:
  Numbers(std::string_view text, const PlyHeader& header)
      : text_(text),
        encoding_(header.encoding),
        at_(header.bodyOffset),
        cursor_(text, TextCursor::Style::Plain, at_) {}

  bool next(Scalar type, double& value) {
    if (encoding_ == Encoding::Text) return parseNumber(cursor_.word(), value);
    const std::size_t size = sizeOf(type);
    if (text_.size() - at_ < size) return false;
    unsigned char raw[8];
    std::memcpy(raw, text_.data() + at_, size);
    if ((encoding_ == Encoding::Big) != (std::endian::native == std::endian::big))
      std::reverse(raw, raw + size);
    at_ += size;
    value = decode(type, raw);
    return true;
  }
  std::uint64_t remaining() const { return text_.size() - offset(); }
  std::string place() const {
    return encoding_ == Encoding::Text ? linePlace(text_, cursor_.wordOffset())
                                       : "byte " + std::to_string(at_);
  }

 private:
  std::size_t offset() const { return encoding_ == Encoding::Text ? cursor_.offset() : at_; }
  template <class T>
  static double as(const unsigned char* raw) {
    T value;
    std::memcpy(&value, raw, sizeof value);
    return double(value);
  }
  static double decode(Scalar type, const unsigned char* raw) {
    switch (type) {
      case Scalar::I8:
        return as<std::int8_t>(raw);
      case Scalar::U8:
        return as<std::uint8_t>(raw);
      case Scalar::I16:
        return as<std::int16_t>(raw);
      case Scalar::U16:
        return as<std::uint16_t>(raw);
      case Scalar::I32:
        return as<std::int32_t>(raw);
      case Scalar::U32:
        return as<std::uint32_t>(raw);
      case Scalar::F32:
        return as<float>(raw);
      default:
        return as<double>(raw);
    }
  }
  std::string_view text_;
  Encoding encoding_;
  std::size_t at_;
  TextCursor cursor_;
};

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::filesystem::path& path) : text_(text), path_(path) {}
  Result<PlyHeader> read();

 private:
  /// One line without its end; false at the end of the text. All lines end as the first one does, so that a
  /// body that begins with a line feed loses nothing.
  bool nextLine(std::string_view& line);
  Status readLine(std::string_view line);
  Status readProperty(TextCursor& words);
  bool scalar(std::string_view word, Scalar& type) const;
  Error fail(const std::string& message, ErrorCode code = ErrorCode::Malformed) const {
    return makeError(code, message, linePlace(text_, lineBegin_), path_.string());
  }
  std::string_view text_;
  const std::filesystem::path& path_;
  std::size_t at_ = 0, lineBegin_ = 0;
  std::string_view lineEnd_;
  PlyHeader header_;
  bool formatSeen_ = false;
};

bool HeaderReader::nextLine(std::string_view& line) {
  constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
  const std::string_view head = text_.substr(0, kMaxHeader);
  if (lineEnd_.empty()) {
    const std::size_t end = head.find_first_of("\r\n");
    if (end == std::string_view::npos) return false;
    lineEnd_ = head.substr(end, head.substr(end, 2) == "\r\n" ? 2 : 1);
  }
  const std::size_t end = head.find(lineEnd_, at_);
  if (end == std::string_view::npos) return false;
  line = head.substr(at_, end - at_);
  lineBegin_ = at_;
  at_ = end + lineEnd_.size();
  return true;
}

bool HeaderReader::scalar(std::string_view word, Scalar& type) const {
  for (const ScalarName& known : kScalarNames) {
    if (word == known.name) return type = known.type, true;
  }
  return false;
}

Status HeaderReader::readProperty(TextCursor& words) {
  if (header_.elements.empty()) return fail("a property comes before any element");
  Property property;
  std::string_view type = words.wordOnLine();
  if (type == "list") {
    Scalar count{};
    if (!scalar(words.wordOnLine(), count)) return fail("a list has a count of unknown type");
    property.countType = count;
    type = words.wordOnLine();
  }
  if (!scalar(type, property.type)) return fail("a property is of unknown type '" + std::string(type) + "'");
  property.name = words.wordOnLine();
  header_.elements.back().properties.push_back(std::move(property));
  return {};
}

Status HeaderReader::readLine(std::string_view line) {
  TextCursor words(line);
  const std::string_view key = words.wordOnLine();
  if (key == "format") {
    const std::string_view kind = words.wordOnLine();
    formatSeen_ = true;
    if (kind == "binary_little_endian") {
      header_.encoding = Encoding::Little;
    } else if (kind == "binary_big_endian") {
      header_.encoding = Encoding::Big;
    } else if (kind != "ascii") {
      return fail("the format '" + std::string(kind) + "' is unknown", ErrorCode::Unsupported);
    }
  } else if (key == "element") {
    Element element;
    element.name = words.wordOnLine();
    std::int64_t count = 0;
    if (!parseInteger(words.wordOnLine(), count) || count < 0) return fail("an element has no valid count");
    element.count = std::uint64_t(count);
    header_.elements.push_back(std::move(element));
  } else if (key == "property") {
    return readProperty(words);
  } else if (!key.empty() && key != "comment" && key != "obj_info" && key != "ply") {
    return fail("the header has an unknown line '" + std::string(key.substr(0, 40)) + "'");
  }
  return {};
}

Result<PlyHeader> HeaderReader::read() {
  std::string_view line;
  while (nextLine(line)) {
    if (TextCursor(line).wordOnLine() == "end_header") {
      if (!formatSeen_) return fail("the header states no format");
      header_.bodyOffset = at_;
      return std::move(header_);
    }
    COIF_TRY(readLine(line));
  }
  return makeError(ErrorCode::Malformed, "the header has no end", {}, path_.string());
}

class PlyReader {
 public:
  PlyReader(Bytes bytes, const std::filesystem::path& path, const PlyHeader& header)
      : path_(path), header_(header), budget_(bytes.size()), numbers_(asText(bytes), header) {}

  Result<PolygonMesh> read();

 private:
  Status checkCount(const Element& element) const;
  Status readVertices(const Element& element);
  Status readFaces(const Element& element);
  Status readStrips(const Element& element);
  Status skip(const Element& element);
  Status readList(const Property& property, std::vector<double>& values);
  Status addFace(const std::vector<double>& indices, const std::vector<double>& uvs);
  Status addStrip(const std::vector<double>& indices);
  bool index(double value, std::uint32_t& out) const {
    out = value >= 0 && value < double(kNone) ? std::uint32_t(value) : kNone;
    return out != kNone && double(out) == value;
  }
  Status finish();
  Error fail(ErrorCode code, const std::string& message) const {
    return makeError(code, message, numbers_.place(), path_.string());
  }
  Error endsEarly(const Element& element, std::uint64_t item) const {
    return fail(ErrorCode::Malformed,
                "the data of " + element.name + " " + std::to_string(item) + " is not there or not a number");
  }

  const std::filesystem::path& path_;
  const PlyHeader& header_;
  MemoryBudget budget_;
  Numbers numbers_;
  PolygonMesh mesh_;
  std::vector<Vec2> vertexUvs_;
  std::uint32_t greatest_ = 0;
  std::uint64_t smallFaces_ = 0;
  bool wedgeUvs_ = false;
};

/// A count that the rest of the file cannot hold is found before anything is allocated for it.
Status PlyReader::checkCount(const Element& element) const {
  std::uint64_t least = 0;
  for (const Property& property : element.properties) {
    least += header_.encoding == Encoding::Text ? 2 : sizeOf(property.countType.value_or(property.type));
  }
  if (least > 0 && element.count > (numbers_.remaining() + 1) / least) {
    return fail(ErrorCode::Malformed, "the header states " + std::to_string(element.count) + " of element '" +
                                          element.name + "', more than the file can hold");
  }
  return {};
}

Status PlyReader::readVertices(const Element& element) {
  // Where each property goes: 0..2 position, 3..4 UV, 5 nowhere.
  std::vector<std::size_t> slots;
  const char* const kSlots[][5] = {
      {"x", "y", "z", "u", "v"}, {"x", "y", "z", "s", "t"}, {"x", "y", "z", "texture_u", "texture_v"}};
  bool found[5] = {};
  for (const Property& property : element.properties) {
    std::size_t slot = 5;
    for (const auto& names : kSlots) {
      for (std::size_t i = 0; i < 5 && !property.countType; ++i) {
        if (property.name == names[i]) slot = i;
      }
    }
    if (slot < 5 && found[slot]) slot = 5;
    if (slot < 5) found[slot] = true;
    slots.push_back(slot);
  }
  if (!found[0] || !found[1] || !found[2]) {
    return makeError(ErrorCode::Malformed, "the vertices have no x, y and z", {}, path_.string());
  }
  const bool uvs = found[3] && found[4];
  COIF_TRY(budget_.reserve(mesh_.positions, element.count));
  if (uvs) COIF_TRY(budget_.reserve(vertexUvs_, element.count));
  std::vector<double> list;
  for (std::uint64_t v = 0; v < element.count; ++v) {
    double values[6] = {};
    for (std::size_t p = 0; p < slots.size(); ++p) {
      if (element.properties[p].countType) {
        COIF_TRY(readList(element.properties[p], list));
      } else if (!numbers_.next(element.properties[p].type, values[slots[p]])) {
        return endsEarly(element, v);
      }
    }
    mesh_.positions.emplace_back(values[0], values[1], values[2]);
    if (uvs) vertexUvs_.emplace_back(values[3], values[4]);
    if (!mesh_.positions.back().allFinite() || !std::isfinite(values[3]) || !std::isfinite(values[4])) {
      return fail(ErrorCode::Degenerate, "vertex " + std::to_string(v) + " is not finite");
    }
  }
  return {};
}

Status PlyReader::readList(const Property& property, std::vector<double>& values) {
  double count = 0;
  if (!numbers_.next(*property.countType, count) || !(count >= 0) || count != std::floor(count)) {
    return fail(ErrorCode::Malformed, "a list has no valid length");
  }
  if (count > double(numbers_.remaining()))
    return fail(ErrorCode::Malformed, "a list is longer than the file");
  values.clear();
  for (std::uint64_t i = 0; i < std::uint64_t(count); ++i) {
    double value = 0;
    if (!numbers_.next(property.type, value)) return fail(ErrorCode::Malformed, "a list ends early");
    values.push_back(value);
  }
  return {};
}

Status PlyReader::addFace(const std::vector<double>& indices, const std::vector<double>& uvs) {
  if (indices.size() < 3) return ++smallFaces_, Status();
  for (const double value : indices) {
    std::uint32_t vertex = 0;
    if (!index(value, vertex)) {
      return fail(ErrorCode::Malformed,
                  "face " + std::to_string(mesh_.faceCount()) + " has an index that is none");
    }
    greatest_ = std::max(greatest_, vertex);
    mesh_.corners.push_back(vertex);
  }
  closeFace(mesh_);
  if (!wedgeUvs_) return {};
  const bool whole = uvs.size() == 2 * indices.size();
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const Vec2 uv = whole ? Vec2(uvs[2 * i], uvs[2 * i + 1]) : Vec2(0, 0);
    if (!uv.allFinite()) return fail(ErrorCode::Degenerate, "a texture coordinate is not finite");
    mesh_.cornerUvs.push_back(uv);
  }
  return {};
}

Status PlyReader::readFaces(const Element& element) {
  const Property *indices = nullptr, *uvs = nullptr;
  for (const Property& property : element.properties) {
    if (!property.countType) continue;
    if (property.name == "vertex_indices" || property.name == "vertex_index") indices = &property;
    if (property.name == "texcoord") uvs = &property;
  }
  if (indices == nullptr)
    return makeError(ErrorCode::Malformed, "the faces have no vertex indices", {}, path_.string());
  wedgeUvs_ = uvs != nullptr;
  const bool isText = header_.encoding == Encoding::Text;
  const std::uint64_t mostCorners = numbers_.remaining() / (isText ? 2 : sizeOf(indices->type)) + 1;
  COIF_TRY(budget_.reserve(mesh_.faceOffsets, element.count + 1));
  COIF_TRY(budget_.reserve(mesh_.corners, mostCorners));
  if (wedgeUvs_) COIF_TRY(budget_.take(mostCorners, sizeof(Vec2)));
  std::vector<double> indexList, uvList, other;
  for (std::uint64_t f = 0; f < element.count; ++f) {
    for (const Property& property : element.properties) {
      double value = 0;
      if (property.countType) {
        COIF_TRY(readList(property, &property == indices ? indexList : &property == uvs ? uvList : other));
      } else if (!numbers_.next(property.type, value)) {
        return endsEarly(element, f);
      }
    }
    COIF_TRY(addFace(indexList, uvList));
  }
  return {};
}

/// Triangle strips, as the Stanford scans have them: -1 begins the next strip, every other triangle is
/// turned.
Status PlyReader::addStrip(const std::vector<double>& indices) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] == -1) {
      begin = i + 1;
    } else if (i >= begin + 2) {
      const bool odd = (i - begin) % 2 == 1;
      const double a = indices[i - 2], b = indices[i - 1], c = indices[i];
      if (a == b || b == c || a == c) continue;  // strips join by triangles without area
      COIF_TRY(addFace({odd ? b : a, odd ? a : b, c}, {}));
    }
  }
  return {};
}

Status PlyReader::readStrips(const Element& element) {
  const std::uint64_t mostCorners = 3 * (numbers_.remaining() / 2 + 1);
  COIF_TRY(budget_.reserve(mesh_.corners, mesh_.corners.size() + mostCorners));
  COIF_TRY(budget_.reserve(mesh_.faceOffsets, mesh_.faceOffsets.size() + mostCorners / 3));
  std::vector<double> list;
  for (std::uint64_t s = 0; s < element.count; ++s) {
    for (const Property& property : element.properties) {
      double value = 0;
      if (property.countType) {
        COIF_TRY(readList(property, list));
        if (property.name == "vertex_indices" || property.name == "vertex_index") COIF_TRY(addStrip(list));
      } else if (!numbers_.next(property.type, value)) {
        return endsEarly(element, s);
      }
    }
  }
  return {};
}

Status PlyReader::skip(const Element& element) {
  if (element.properties.empty()) return {};
  std::vector<double> list;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) {
      double value = 0;
      if (property.countType) {
        COIF_TRY(readList(property, list));
      } else if (!numbers_.next(property.type, value)) {
        return endsEarly(element, i);
      }
    }
  }
  return {};
}

Status PlyReader::finish() {
  if (mesh_.faceCount() == 0) {
    return makeError(ErrorCode::Degenerate, "the file holds no polygon", {}, path_.string());
  }
  if (greatest_ >= mesh_.positions.size()) {
    return makeError(ErrorCode::Malformed,
                     "a face names vertex " + std::to_string(greatest_) + ", but the file has " +
                         std::to_string(mesh_.positions.size()),
                     {}, path_.string());
  }
  if (!vertexUvs_.empty() && !wedgeUvs_) {
    COIF_TRY(budget_.reserve(mesh_.cornerUvs, mesh_.corners.size()));
    for (const std::uint32_t vertex : mesh_.corners) mesh_.cornerUvs.push_back(vertexUvs_[vertex]);
  }
  if (mesh_.cornerUvs.size() != mesh_.corners.size())
    mesh_.cornerUvs.clear();  // strips beside faces with UVs
  noteCount(mesh_, smallFaces_, "faces of fewer than three corners are left out.");
  return {};
}

Result<PolygonMesh> PlyReader::read() {
  bool vertices = false, faces = false;
  for (const Element& element : header_.elements) {
    COIF_TRY(checkCount(element));
    if (element.name == "vertex" && !vertices) {
      vertices = true;
      COIF_TRY(readVertices(element));
    } else if (element.name == "face" && !faces) {
      faces = true;
      COIF_TRY(readFaces(element));
    } else if (element.name == "tristrips") {
      COIF_TRY(readStrips(element));
    } else {
      COIF_TRY(skip(element));
    }
  }
  COIF_TRY(finish());
  return std::move(mesh_);
}

}  // namespace

Result<PolygonMesh> readPly(Bytes bytes, const std::filesystem::path& path) {
  COIF_ASSIGN(const PlyHeader header, HeaderReader(asText(bytes), path).read());
  return PlyReader(bytes, path, header).read();
}

}  // namespace coif::io
