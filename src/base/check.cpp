#include "coif/base/check.h"

namespace coif {

void failCheck(const char* condition, const char* file, int line, const std::string& detail) {
  throw InvariantError(std::string(file) + ":" + std::to_string(line) + ": " + detail + " (" + condition +
                       ")");
}

}  // namespace coif
