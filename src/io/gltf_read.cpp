// Stands in for the glTF reader and writer until they land.
#include "io/formats.h"

namespace coif::io {

static Error pending(const std::filesystem::path& path) {
  return makeError(ErrorCode::Unsupported, "glTF is not read or written by this build", {}, path.string());
}
Result<PolygonMesh> readGltfMesh(Bytes, const std::filesystem::path& path) { return pending(path); }
Result<StrandSet> readGltfStrands(Bytes, const std::filesystem::path& path) { return pending(path); }
Result<WriteReport> writeGltf(const StrandExport&, const std::filesystem::path& path, const Context&) {
  return pending(path);
}

}  // namespace coif::io
