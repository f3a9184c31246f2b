// Characters of a .usda text into words, strings, numbers; every read is inside the text.
#pragma once

#include <algorithm>
#include <charconv>
#include <limits>
#include <string>
#include <string_view>

#include "coif/base/result.h"

namespace coif::io::usd {

class TextLexer {
 public:
  explicit TextLexer(std::string_view text) : text_(text) {}

  bool atEnd() const { return at_ >= text_.size(); }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  std::size_t position() const { return at_; }
  std::string_view rest() const { return text_.substr(at_); }
  void advance(std::size_t count = 1) { at_ = std::min(at_ + count, text_.size()); }

  /// White space, line ends, comments (# to the end of the line) and stray semicolons.
  void skipBlank();
  /// White space of this line alone; true when the line (or the text) ends here.
  bool skipToLineEnd();
  /// Skips blank, then takes `c` if it comes next.
  bool accept(char c);
  /// Letters, digits, _ : and bytes beyond ASCII; empty when none comes next.
  std::string_view word();
  /// The word that comes next, left where it is.
  std::string_view peekWord();
  Result<std::string> quoted();  ///< "…", '…', """…""", '''…'''
  Result<std::string> asset();   ///< @…@ or @@@…@@@
  Result<std::string> path();    ///< <…>
  template <class T>
  bool number(T& value);
  /// One value of any kind, brackets and all. Not recursive.
  Status skipValue();
  /// To the end of the line outside brackets, or to an unmatched closing bracket.
  Status skipStatement();

  Error fail(std::string message, ErrorCode code = ErrorCode::Malformed) const;

 private:
  Status skipToken();
  std::string_view text_;
  std::size_t at_ = 0;
};

template <class T>
bool TextLexer::number(T& value) {
  skipBlank();
  const char* first = text_.data() + at_;
  const char* last = text_.data() + text_.size();
  if (first != last && *first == '+') ++first;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) {
    if constexpr (std::is_floating_point_v<T>) {
      // Too small is zero; too large is what later stages refuse as not finite.
      const bool tiny = std::string_view(first, end).find("e-") != std::string_view::npos ||
                        std::string_view(first, end).find("E-") != std::string_view::npos;
      value = tiny ? T(0) : std::numeric_limits<T>::infinity();
    } else {
      return false;
    }
  }
  at_ = std::size_t(end - text_.data());
  return true;
}

}  // namespace coif::io::usd
