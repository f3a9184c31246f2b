// Picks the reader by content first and extension second, and the writer by extension.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <new>

#include "coif/io/can_write.h"
#include "io/formats.h"
#include "io/scan.h"

namespace coif {
namespace {

using io::Bytes;
namespace fs = std::filesystem;

enum class Format { Unknown, Obj, Ply, Off, Stl, Gltf, Hair, Usd, Alembic };

std::string extensionOf(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

Format formatOfExtension(const std::string& extension) {
  constexpr std::array<std::pair<std::string_view, Format>, 11> kFormats{{{".obj", Format::Obj},
                                                                          {".ply", Format::Ply},
                                                                          {".off", Format::Off},
                                                                          {".stl", Format::Stl},
                                                                          {".gltf", Format::Gltf},
                                                                          {".glb", Format::Gltf},
                                                                          {".hair", Format::Hair},
                                                                          {".usd", Format::Usd},
                                                                          {".usda", Format::Usd},
                                                                          {".usdc", Format::Usd},
                                                                          {".abc", Format::Alembic}}};
  for (const auto& [name, format] : kFormats) {
    if (extension == name) return format;
  }
  return Format::Unknown;
}

/// Formats that are met in practice and not read: a better answer than "malformed".
const char* foreignFormat(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, const char*>, 8> kForeign{
      {{"Kaydara FBX Binary", "an FBX file"},
       {"; FBX", "an FBX file"},
       {"BLENDER", "a Blender file"},
       {"Ogawa", "an Alembic file"},
       {"\x89HDF", "an Alembic (HDF5) file"},
       {"PK\x03\x04", "a zip archive (.usdz, .3mf): unpack it first"},
       {"\x1f\x8b", "compressed with gzip: unpack it first"},
       {"<?xml", "an XML file (Collada?)"}}};
  for (const auto& [magic, name] : kForeign) {
    if (text.starts_with(magic)) return name;
  }
  return nullptr;
}

bool looksLikeOff(std::string_view text) {
  io::TextCursor cursor(text, io::TextCursor::Style::HashComments);
  const std::string_view word = cursor.word();
  const std::size_t key = word.find("OFF");
  return key <= 4 && word.substr(0, key).find_first_not_of("STCN4n") == std::string_view::npos;
}

bool looksLikeObj(std::string_view text) {
  for (io::TextCursor cursor(text); !cursor.atEnd(); cursor.nextLine()) {
    const std::string_view word = cursor.wordOnLine();
    if (word.empty() || word.starts_with('#')) continue;
    constexpr std::array<std::string_view, 7> kKeywords{"v", "vt", "vn", "g", "o", "mtllib", "usemtl"};
    return std::find(kKeywords.begin(), kKeywords.end(), word) != kKeywords.end();
  }
  return false;
}

Format detect(Bytes bytes, const fs::path& path) {
  const std::string_view text = io::asText(bytes);
  if (text.starts_with("glTF")) return Format::Gltf;
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return Format::Ply;
  if (text.starts_with("HAIR")) return Format::Hair;
  if (text.starts_with("PXR-USDC") || text.starts_with("#usda")) return Format::Usd;
  const std::string_view head = text.substr(0, 4096);
  if (looksLikeOff(head)) return Format::Off;
  const Format byName = formatOfExtension(extensionOf(path));
  if (byName != Format::Unknown) return byName;
  const std::size_t first = head.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && head[first] == '{') return Format::Gltf;
  if (head.starts_with("solid") && head.find("facet") != std::string_view::npos) return Format::Stl;
  return looksLikeObj(head) ? Format::Obj : Format::Unknown;
}

Bytes withoutByteOrderMark(Bytes bytes) {
  return io::asText(bytes).starts_with("\xEF\xBB\xBF") ? bytes.subspan(3) : bytes;
}

Result<PolygonMesh> readMesh(Bytes bytes, const fs::path& path) {
  switch (detect(bytes, path)) {
    case Format::Obj:
      return io::readObj(bytes, path);
    case Format::Ply:
      return io::readPly(bytes, path);
    case Format::Off:
      return io::readOff(bytes, path);
    case Format::Stl:
      return io::readStl(bytes, path);
    case Format::Gltf:
      return io::readGltfMesh(bytes, path);
    case Format::Usd:
      return io::readUsdMesh(bytes, path);
    case Format::Hair:
      return makeError(ErrorCode::Unsupported, "the file holds strands, not a mesh");
    default:
      return makeError(ErrorCode::Unsupported, "no mesh format is known by this content or extension");
  }
}

Result<StrandSet> readStrands(Bytes bytes, const fs::path& path) {
  switch (detect(bytes, path)) {
    case Format::Hair:
      return io::readHair(bytes, path);
    case Format::Gltf:
      return io::readGltfStrands(bytes, path);
    case Format::Usd:
      return io::readUsdStrands(bytes, path);
    case Format::Unknown:
    case Format::Alembic:
      return makeError(ErrorCode::Unsupported, "no strand format is known by this content or extension");
    default:
      return makeError(ErrorCode::Unsupported, "the file holds a mesh, not strands");
  }
}

Error noStrandWriter(const fs::path& path) {
  return makeError(ErrorCode::Unsupported,
                   "strands are written as .usda, .usdc, .usd, .abc, .gltf, .glb or .hair", {},
                   path.string());
}

/// Reads, checks what was read, and names the file in every error.
template <class T, class Read>
Result<T> load(const fs::path& path, Read read) {
  COIF_ASSIGN(const std::vector<std::byte> stored, readFile(path, io::kMaxReaderBytes));
  const Bytes bytes = withoutByteOrderMark(stored);
  if (bytes.empty()) return makeError(ErrorCode::Malformed, "the file is empty", {}, path.string());
  if (const char* foreign = foreignFormat(io::asText(bytes))) {
    return makeError(ErrorCode::Unsupported, std::string("this is ") + foreign, {}, path.string());
  }
  try {
    Result<T> result = read(bytes, path);
    if (!result.ok()) return inFile(result.error(), path.string());
    const Status valid = validate(*result);
    if (valid.ok()) return result;
    // The readers answer for the structure: what is left to find are values that are not finite.
    return makeError(ErrorCode::Degenerate, valid.error().message, valid.error().place, path.string());
  } catch (const std::bad_alloc&) {
    return makeError(ErrorCode::TooLarge, "there is not enough memory to read this file", {}, path.string());
  }
}

}  // namespace

Result<PolygonMesh> loadPolygonMesh(const fs::path& path) {
  return load<PolygonMesh>(path, readMesh);
}

Result<std::optional<SkinBinding>> loadSkinBinding(const fs::path& path) {
  COIF_ASSIGN(const std::vector<std::byte> stored, readFile(path, io::kMaxReaderBytes));
  const Bytes bytes = withoutByteOrderMark(stored);
  if (bytes.empty() || foreignFormat(io::asText(bytes)) != nullptr || detect(bytes, path) != Format::Usd) {
    return std::optional<SkinBinding>();
  }
  try {
    return io::readUsdSkin(bytes, path);
  } catch (const std::bad_alloc&) {
    return makeError(ErrorCode::TooLarge, "there is not enough memory to read this file", {}, path.string());
  }
}

Result<StrandSet> loadStrands(const fs::path& path) {
  return load<StrandSet>(path, readStrands);
}

Result<WriteReport> saveStrands(const StrandExport& what, const fs::path& path, const Context& context) {
  const auto refuse = [&](const std::string& message) {
    return makeError(ErrorCode::InvalidArgument, message, {}, path.string());
  };
  if (what.strands == nullptr || what.strands->strandCount() == 0)
    return refuse("there are no strands to write");
  if (!(what.strands->metersPerUnit > 0) || !std::isfinite(what.strands->metersPerUnit)) {
    return refuse("metersPerUnit must be positive");
  }
  const Status valid = validate(*what.strands);
  if (!valid.ok()) return inFile(valid.error(), path.string());
  if (what.head != nullptr) {
    const Status headValid = validate(*what.head);
    if (!headValid.ok()) return inFile(headValid.error(), path.string());
  }
  for (const StrandFrame& frame : what.frames) {
    if (frame.points.size() != what.strands->pointCount())
      return refuse("a frame has another number of points");
  }
  switch (formatOfExtension(extensionOf(path))) {
    case Format::Hair:
      return io::writeHair(what, path, context);
    case Format::Gltf:
      return io::writeGltf(what, path, context);
    case Format::Usd:
      return io::writeUsd(what, path, context);
    case Format::Alembic:
      return io::writeAlembic(what, path, context);
    default:
      return noStrandWriter(path);
  }
}

Status canSaveStrands(const fs::path& path) {
  switch (formatOfExtension(extensionOf(path))) {
    case Format::Alembic:
      if (!writesAlembic())
        return makeError(ErrorCode::Unsupported,
                         "this Coif was built without Alembic; Blender reads the .usdc and writes .abc", {},
                         path.string());
      [[fallthrough]];
    case Format::Hair:
    case Format::Gltf:
    case Format::Usd:
      return canWrite(path);
    default:
      return noStrandWriter(path);
  }
}

}  // namespace coif
