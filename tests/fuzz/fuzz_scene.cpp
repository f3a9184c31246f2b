// The .coif reader under libFuzzer: any text gives a scene that keeps every invariant, or an error.
#include <cstdlib>
#include <string_view>

#include "coif/hairmesh/invariants.h"
#include "coif/scene/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const auto scene = coif::parseScene({reinterpret_cast<const char*>(data), size}, "fuzz.coif");
  if (scene.ok() ? !coif::checkInvariants(scene->hairMesh).empty() : scene.error().message.empty())
    std::abort();
  return 0;
}
