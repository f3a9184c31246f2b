#include "io/gltf_document.h"

#include <algorithm>
#include <cstring>

namespace coif::io {
namespace {

using Json = nlohmann::json;

struct Container {
  std::string_view json;
  Bytes binary;
  bool hasBinary = false;
};

std::uint32_t u32At(Bytes bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

/// A .glb is a header of 12 bytes and chunks; a .gltf is all JSON.
Result<Container> splitContainer(Bytes bytes) {
  if (!asText(bytes).starts_with("glTF")) return Container{asText(bytes), {}, false};
  if (bytes.size() < 20) return makeError(ErrorCode::Malformed, "the GLB header ends early");
  if (u32At(bytes, 4) != 2) return makeError(ErrorCode::Unsupported, "only glTF 2.0 is read", "byte 4");
  if (u32At(bytes, 8) > bytes.size()) {
    return makeError(ErrorCode::Malformed, "the GLB header states more bytes than the file has", "byte 8");
  }
  bytes = bytes.first(std::max<std::size_t>(12, u32At(bytes, 8)));
  Container container;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  for (std::size_t at = 12, chunk = 0; at + 8 <= bytes.size(); ++chunk) {
    const std::uint64_t length = u32At(bytes, at);
    const std::uint32_t type = u32At(bytes, at + 4);
    if (length > bytes.size() - at - 8) {
      return makeError(ErrorCode::Malformed, "a GLB chunk is longer than the file",
                       "byte " + std::to_string(at));
    }
    const Bytes content = bytes.subspan(at + 8, length);
    if (chunk == 0 && type != kJson)
      return makeError(ErrorCode::Malformed, "the first GLB chunk is not JSON", "byte 12");
    if (chunk == 0) container.json = asText(content);
    if (chunk == 1 && type == kBinary) {
      container.binary = content;
      container.hasBinary = true;
    }
    at += 8 + length;
  }
  if (container.json.empty())
    return makeError(ErrorCode::Malformed, "the GLB file has no JSON chunk", "byte 12");
  return container;
}

/// JSON takes many times its length once parsed, and readers of nested values recurse: both are limited
/// beforehand.
Status checkJsonSize(std::string_view text, MemoryBudget& budget) {
  constexpr int kMaxDepth = 128;
  // A parsed value with its place in an object or array, twice: in the document and in tinygltf's model.
  constexpr std::uint64_t kBytesPerValue = 320;
  int depth = 0;
  std::uint64_t values = 1;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inString) {
      if (c == '\\') ++i;
      inString = c != '"';
      continue;
    }
    inString = c == '"';
    if (c == ',' || c == ':' || c == '[' || c == '{') ++values;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxDepth) {
      return makeError(ErrorCode::Malformed, "the JSON is nested deeper than any glTF",
                       "byte " + std::to_string(i));
    }
  }
  COIF_TRY(budget.take(values, kBytesPerValue));
  return budget.take(text.size(), 2);  // the strings
}

const Json* member(const Json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found == object.end() || !object.is_object() ? nullptr : &*found;
}

std::string stringMember(const Json& object, const char* name) {
  const Json* found = member(object, name);
  return found != nullptr && found->is_string() ? found->get<std::string>() : std::string();
}

Status checkVersion(const Json& json) {
  const Json* asset = member(json, "asset");
  if (asset == nullptr) return makeError(ErrorCode::Malformed, "the JSON is no glTF: it has no asset");
  const std::string version = stringMember(*asset, "version"), least = stringMember(*asset, "minVersion");
  if (!version.starts_with("2.") || (!least.empty() && least != "2.0")) {
    return makeError(ErrorCode::Unsupported,
                     "only glTF 2.0 is read, not '" + (least.empty() ? version : least) + "'");
  }
  return {};
}

/// Extensions of looks, light and animation may be passed over; any other that the file requires may not.
Status checkExtensions(const Json& json) {
  const Json* required = member(json, "extensionsRequired");
  if (required == nullptr || !required->is_array()) return {};
  for (const Json& entry : *required) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : std::string("?");
    constexpr std::array<std::string_view, 8> kPassedOver{
        "KHR_mesh_quantization", "KHR_materials_", "KHR_texture_",  "EXT_texture_",
        "KHR_lights_",           "KHR_animation_", "KHR_node_visi", "KHR_xmp"};
    const bool known = std::any_of(kPassedOver.begin(), kPassedOver.end(),
                                   [&](std::string_view prefix) { return name.starts_with(prefix); });
    if (!known) {
      return makeError(ErrorCode::Unsupported,
                       "the file needs the extension " + name + ", which is not read");
    }
  }
  return {};
}

int base64Value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

bool decodeBase64(std::string_view text, std::vector<std::byte>& out) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = base64Value(c);
    if (value < 0) return false;
    bits = bits << 6 | std::uint32_t(value);
    if ((count += 6) >= 8) out.push_back(std::byte(bits >> (count -= 8) & 255));
  }
  return true;
}

std::string decodePercents(std::string_view uri) {
  const auto hex = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool coded = uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0;
    out += coded ? char(16 * hex(uri[i + 1]) + hex(uri[i + 2])) : uri[i];
    if (coded) i += 2;
  }
  return out;
}

class DocumentReader {
 public:
  DocumentReader(const std::filesystem::path& path, MemoryBudget& budget) : path_(path), budget_(budget) {}
  Result<GltfDocument> read(Bytes bytes);

 private:
  Status readBuffer(Json& buffer, std::size_t index, const Container& container);
  Result<Bytes> bufferBytes(const std::string& uri, const std::string& place);
  Status readModel();
  const std::filesystem::path& path_;
  MemoryBudget& budget_;
  GltfDocument document_;
};

Result<Bytes> DocumentReader::bufferBytes(const std::string& uri, const std::string& place) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == std::string::npos)
      return makeError(ErrorCode::Unsupported, "a data URI is not base64", place);
    COIF_TRY(budget_.reserve(document_.own.emplace_back(), uri.size() / 4 * 3 + 3));
    if (!decodeBase64(std::string_view(uri).substr(comma + 8), document_.own.back())) {
      return makeError(ErrorCode::Malformed, "a data URI is not valid base64", place);
    }
    return Bytes(document_.own.back());
  }
  const std::string name = decodePercents(uri);
  if (name.find("://") != std::string::npos || name.starts_with('/') ||
      name.find('\0') != std::string::npos) {
    return makeError(ErrorCode::Unsupported,
                     "only buffers in files beside this one are read, not '" + name + "'", place);
  }
  Result<std::vector<std::byte>> file = readFile(path_.parent_path() / name, kMaxReaderBytes);
  if (!file.ok()) {
    return makeError(file.error().code, "the buffer '" + name + "' cannot be read: " + file.error().message,
                     place);
  }
  COIF_TRY(budget_.take(file->size(), 1));
  document_.own.push_back(std::move(*file));
  return Bytes(document_.own.back());
}

Status DocumentReader::readBuffer(Json& buffer, std::size_t index, const Container& container) {
  const std::string place = "buffer " + std::to_string(index);
  const Json* length = member(buffer, "byteLength");
  if (length == nullptr || !length->is_number_unsigned()) {
    return makeError(ErrorCode::Malformed, "the buffer has no valid byteLength", place);
  }
  const std::string uri = stringMember(buffer, "uri");
  if (uri.empty() && index == 0 && container.hasBinary) {
    document_.buffers.push_back(container.binary);
  } else if (uri.empty()) {
    return makeError(ErrorCode::Unsupported, "the buffer has no data", place);
  } else {
    COIF_ASSIGN(const Bytes bytes, bufferBytes(uri, place));
    document_.buffers.push_back(bytes);
    buffer.erase("uri");
  }
  const std::uint64_t stated = length->get<std::uint64_t>(), there = document_.buffers.back().size();
  if (stated > there) {
    return makeError(
        ErrorCode::Malformed,
        "the buffer states " + std::to_string(stated) + " bytes, but has " + std::to_string(there), place);
  }
  document_.buffers.back() = document_.buffers.back().first(stated);
  return {};
}

/// What tinygltf is shown of an element: no extras, and of extensions only their names.
Json withoutExtras(const Json& element) {
  if (!element.is_object()) return element;
  Json out = Json::object();
  for (const auto& [key, value] : element.items()) {
    if (key == "extensions" && value.is_object()) {
      for (const auto& extension : value.items()) out["extensions"][extension.key()] = Json::object();
    } else if (key == "primitives" && value.is_array()) {
      out[key] = Json::array();
      for (const Json& primitive : value) out[key].push_back(withoutExtras(primitive));
    } else if (key != "extras") {
      out[key] = value;
    }
  }
  return out;
}

Status DocumentReader::readModel() {
  Json structure{{"asset", {{"version", "2.0"}}}};
  for (const char* name : {"scene", "scenes", "nodes", "meshes", "accessors", "bufferViews"}) {
    const Json* part = member(document_.json, name);
    if (part == nullptr) continue;
    if (!part->is_array()) {
      structure[name] = *part;
      continue;
    }
    structure[name] = Json::array();
    for (const Json& element : *part) structure[name].push_back(withoutExtras(element));
  }
  const std::string text = structure.dump();
  tinygltf::TinyGLTF loader;
  std::string errors, warnings;
  if (!loader.LoadASCIIFromString(&document_.model, &errors, &warnings, text.data(), unsigned(text.size()),
                                  "", tinygltf::NO_REQUIRE)) {
    std::replace(errors.begin(), errors.end(), '\n', ' ');
    return makeError(ErrorCode::Malformed, "the glTF breaks its schema: " + errors.substr(0, 200));
  }
  return {};
}

Result<GltfDocument> DocumentReader::read(Bytes bytes) {
  COIF_ASSIGN(const Container container, splitContainer(bytes));
  COIF_TRY(checkJsonSize(container.json, budget_));
  try {
    document_.json = Json::parse(container.json);
    if (!document_.json.is_object()) return makeError(ErrorCode::Malformed, "the JSON is not an object");
    COIF_TRY(checkVersion(document_.json));
    COIF_TRY(checkExtensions(document_.json));
    if (member(document_.json, "buffers") != nullptr && document_.json["buffers"].is_array()) {
      Json& buffers = document_.json["buffers"];
      for (std::size_t i = 0; i < buffers.size(); ++i) COIF_TRY(readBuffer(buffers[i], i, container));
    }
    COIF_TRY(readModel());
  } catch (const Json::parse_error& error) {
    return makeError(ErrorCode::Malformed, "the JSON breaks off or is not valid",
                     "byte " + std::to_string(error.byte));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {  // tinygltf and the JSON library report wrong types so
    return makeError(ErrorCode::Malformed, std::string("the glTF breaks its schema: ") + error.what());
  }
  return std::move(document_);
}

/// The bytes of `count` elements in a buffer view, every bound checked.
struct Elements {
  const std::byte* data = nullptr;  // null: zeros
  std::size_t stride = 0;
};

Result<Elements> elementsOf(const GltfDocument& document, int view, std::uint64_t offset, std::uint64_t count,
                            std::uint64_t size, bool mayStride, const std::string& place) {
  const auto bad = [&](const char* what) { return makeError(ErrorCode::Malformed, what, place); };
  if (view < 0 || std::size_t(view) >= document.model.bufferViews.size())
    return bad("the buffer view does not exist");
  const tinygltf::BufferView& bufferView = document.model.bufferViews[std::size_t(view)];
  if (bufferView.extensions.count("EXT_meshopt_compression") > 0) {
    return makeError(ErrorCode::Unsupported, "meshopt compression is not read", place);
  }
  if (bufferView.buffer < 0 || std::size_t(bufferView.buffer) >= document.buffers.size()) {
    return bad("the buffer does not exist");
  }
  const Bytes buffer = document.buffers[std::size_t(bufferView.buffer)];
  if (bufferView.byteOffset > buffer.size() ||
      bufferView.byteLength > buffer.size() - bufferView.byteOffset) {
    return bad("the buffer view exceeds its buffer");
  }
  const std::uint64_t stride = mayStride && bufferView.byteStride > 0 ? bufferView.byteStride : size;
  if (stride < size) return bad("the stride is smaller than an element");
  if (offset > bufferView.byteLength) return bad("the accessor exceeds its buffer view");
  const std::uint64_t room = bufferView.byteLength - offset;
  if (count > 0 && (room < size || count - 1 > (room - size) / stride))
    return bad("the accessor exceeds its buffer view");
  return Elements{buffer.data() + bufferView.byteOffset + offset, std::size_t(stride)};
}

std::uint32_t indexAt(const std::byte* at, int componentType) {
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return std::uint32_t(*at);
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    std::uint16_t value = 0;
    std::memcpy(&value, at, 2);
    return value;
  }
  std::uint32_t value = 0;
  std::memcpy(&value, at, 4);
  return value;
}

template <class T>
float numberFrom(const std::byte* at, bool normalized) {
  T value;
  std::memcpy(&value, at, sizeof value);
  if (!normalized) return float(value);
  // glTF 2.0, 3.6.2.2: the most negative integer counts as -1 too.
  return float(std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0));
}

float numberAt(const std::byte* at, int componentType, bool normalized) {
  switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return numberFrom<std::int8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return numberFrom<std::uint8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return numberFrom<std::int16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return numberFrom<std::uint16_t>(at, normalized);
    default:
      return numberFrom<float>(at, false);
  }
}

bool isIndexType(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

bool isNumberType(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_FLOAT || type == TINYGLTF_COMPONENT_TYPE_BYTE ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
}

std::uint64_t elementBytes(const tinygltf::Accessor& accessor, int components) {
  return std::uint64_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType))) *
         std::uint64_t(components);
}

/// Calls put(element, bytes) for the elements in the view, then for the sparse ones over them. Checked
/// before.
template <class Put>
void visitElements(const GltfDocument& document, const tinygltf::Accessor& accessor, int components,
                   Put put) {
  const std::uint64_t size = elementBytes(accessor, components);
  if (accessor.bufferView >= 0) {
    const Elements base =
        *elementsOf(document, accessor.bufferView, accessor.byteOffset, accessor.count, size, true, {});
    for (std::size_t i = 0; i < accessor.count; ++i) put(i, base.data + i * base.stride);
  }
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  const int type = sparse.indices.componentType;
  const auto indexSize = std::uint64_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type)));
  const auto count = std::uint64_t(sparse.count);
  const Elements indices = *elementsOf(document, sparse.indices.bufferView,
                                       std::uint64_t(sparse.indices.byteOffset), count, indexSize, false, {});
  const Elements values = *elementsOf(document, sparse.values.bufferView,
                                      std::uint64_t(sparse.values.byteOffset), count, size, false, {});
  for (std::size_t i = 0; i < count; ++i) {
    put(indexAt(indices.data + i * indices.stride, type), values.data + i * values.stride);
  }
}

Status checkSparse(const GltfDocument& document, const tinygltf::Accessor& accessor, int components,
                   const std::string& place) {
  const auto& sparse = accessor.sparse;
  const auto bad = [&](const char* what) { return makeError(ErrorCode::Malformed, what, place); };
  if (sparse.count < 0 || std::uint64_t(sparse.count) > accessor.count)
    return bad("the sparse count is out of range");
  if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    return bad("a sparse offset is negative");
  const int type = sparse.indices.componentType;
  if (!isIndexType(type)) return bad("the sparse indices are of no index type");
  const auto indexSize = std::uint64_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type)));
  COIF_ASSIGN(const Elements indices,
              elementsOf(document, sparse.indices.bufferView, std::uint64_t(sparse.indices.byteOffset),
                         std::uint64_t(sparse.count), indexSize, false, place));
  COIF_TRY(elementsOf(document, sparse.values.bufferView, std::uint64_t(sparse.values.byteOffset),
                      std::uint64_t(sparse.count), elementBytes(accessor, components), false, place));
  for (int i = 0; i < sparse.count; ++i) {
    if (indexAt(indices.data + std::size_t(i) * indices.stride, type) >= accessor.count) {
      return bad("a sparse index is out of range");
    }
  }
  return {};
}

}  // namespace

Result<GltfDocument> openGltf(Bytes bytes, const std::filesystem::path& path, MemoryBudget& budget) {
  return DocumentReader(path, budget).read(bytes);
}

Result<std::size_t> checkAccessor(const GltfDocument& document, int accessor, int components, bool integers) {
  const std::string place = "accessor " + std::to_string(accessor);
  if (accessor < 0 || std::size_t(accessor) >= document.model.accessors.size()) {
    return makeError(ErrorCode::Malformed, "the accessor does not exist", place);
  }
  const tinygltf::Accessor& a = document.model.accessors[std::size_t(accessor)];
  if (tinygltf::GetNumComponentsInType(std::uint32_t(a.type)) != components || a.type == TINYGLTF_TYPE_MAT2) {
    return makeError(ErrorCode::Malformed,
                     "the accessor has not " + std::to_string(components) + " numbers an element", place);
  }
  if (integers ? !isIndexType(a.componentType) : !isNumberType(a.componentType)) {
    return makeError(ErrorCode::Malformed, "the accessor has a component type that does not belong here",
                     place);
  }
  // No reader fits more under its limit, and products below cannot overflow.
  if (a.count == 0 || a.count > kMaxReaderBytes) {
    return makeError(ErrorCode::Malformed, "the accessor states " + std::to_string(a.count) + " elements",
                     place);
  }
  if (a.bufferView >= 0) {
    COIF_TRY(
        elementsOf(document, a.bufferView, a.byteOffset, a.count, elementBytes(a, components), true, place));
  }
  if (a.sparse.isSparse) COIF_TRY(checkSparse(document, a, components, place));
  return a.count;
}

void readFloats(const GltfDocument& document, int accessor, int components, float* out) {
  const tinygltf::Accessor& a = document.model.accessors[std::size_t(accessor)];
  const auto width = std::size_t(components);
  const auto componentBytes = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(a.componentType)));
  visitElements(document, a, components, [&](std::size_t element, const std::byte* bytes) {
    for (std::size_t c = 0; c < width; ++c) {
      out[element * width + c] = numberAt(bytes + c * componentBytes, a.componentType, a.normalized);
    }
  });
}

void readIndices(const GltfDocument& document, int accessor, std::uint32_t* out) {
  const tinygltf::Accessor& a = document.model.accessors[std::size_t(accessor)];
  visitElements(document, a, 1, [&](std::size_t element, const std::byte* bytes) {
    out[element] = indexAt(bytes, a.componentType);
  });
}

}  // namespace coif::io
