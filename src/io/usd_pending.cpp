// Stands in for the USD readers until they land; delete it with the first of them.
#include "io/formats.h"

namespace coif::io {

static Error pending(const std::filesystem::path& path) {
  return makeError(ErrorCode::Unsupported, "USD is not read or written by this build", {}, path.string());
}
Result<PolygonMesh> readUsdMesh(Bytes, const std::filesystem::path& path) {
  return pending(path);
}
Result<StrandSet> readUsdStrands(Bytes, const std::filesystem::path& path) {
  return pending(path);
}

}  // namespace coif::io
