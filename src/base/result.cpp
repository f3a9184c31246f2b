#include "coif/base/result.h"

#include <stdexcept>

namespace coif {

std::string Error::text() const {
  std::string out;
  for (const std::string* part : {&file, &place}) {
    if (!part->empty()) out += *part + ": ";
  }
  return out + message;
}

void throwMissingValue(const Error& error) {
  throw std::logic_error("value of a failed Result used: " + error.text());
}

}  // namespace coif
