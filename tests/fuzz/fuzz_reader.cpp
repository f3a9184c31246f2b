// One reader under libFuzzer: any bytes give a valid result or an error.
#include <cstdlib>

#include "io/formats.h"

namespace {

/// Whatever a reader accepts must hold together; loaders check finiteness of strands afterwards.
bool holds(const coif::PolygonMesh& mesh) {
  return validate(mesh).ok() && mesh.faceCount() > 0;
}
bool holds(const coif::StrandSet& set) {
  return validate(set, false).ok();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const auto result = coif::io::COIF_FUZZ_READER(std::as_bytes(std::span(data, size)), "fuzz");
  if (result.ok() ? !holds(*result) : result.error().message.empty()) std::abort();
  return 0;
}
