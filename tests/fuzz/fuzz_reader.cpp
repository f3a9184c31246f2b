// One reader under libFuzzer: any bytes give a valid result or an error.
#include <cmath>
#include <cstdlib>
#include <optional>

#include "io/formats.h"

namespace {

/// Whatever a reader accepts must hold together; loaders check finiteness of strands afterwards.
bool holds(const coif::PolygonMesh& mesh) {
  return validate(mesh).ok() && mesh.faceCount() > 0;
}
bool holds(const coif::StrandSet& set) {
  return validate(set, false).ok();
}
/// Rows of whole length, each of weights that add up to 1 or are all 0.
bool holds(const std::optional<coif::SkinBinding>& skin) {
  if (!skin) return true;
  const std::size_t n = skin->influences;
  if (n == 0 || skin->joints.size() != skin->weights.size() || skin->joints.size() % n != 0) return false;
  for (std::size_t row = 0; row < skin->weights.size(); row += n) {
    double sum = 0;
    for (std::size_t i = row; i < row + n; ++i) {
      if (!(skin->weights[i] >= 0)) return false;
      sum += skin->weights[i];
    }
    if (sum != 0 && std::abs(sum - 1) > 1e-4) return false;  // n ≤ a few dozen floats, each rounded once
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const auto result = coif::io::COIF_FUZZ_READER(std::as_bytes(std::span(data, size)), "fuzz");
  if (result.ok() ? !holds(*result) : result.error().message.empty()) std::abort();
  return 0;
}
