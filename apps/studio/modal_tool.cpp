#include "modal_tool.h"

#include <cstdlib>

namespace coif::studio {

void TypedNumbers::take(const Keys& keys) {
  for (const char c : keys.typed()) {
    if (c == '\t') {
      at_ = (at_ + 1) % 3;
    } else if (c != '\b') {
      texts_[at_] += c;
    } else if (!texts_[at_].empty()) {
      texts_[at_].pop_back();
    }
  }
}

double TypedNumbers::number(std::size_t i) const {
  return std::strtod(texts_[i].c_str(), nullptr);
}

std::string TypedNumbers::text() const {
  std::string out = texts_[0];
  for (std::size_t i = 1; i < 3; ++i) {
    if (!texts_[i].empty() || i <= at_) out += ", " + texts_[i];
  }
  return out;
}

}  // namespace coif::studio
