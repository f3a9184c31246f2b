#include "usda_lexer.h"

#include <algorithm>

#include "scan.h"

namespace coif::io::usd {
namespace {

bool isWordCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ':' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

void appendEscape(char c, std::string& out) {
  switch (c) {
    case 'n':
      out += '\n';
      break;
    case 't':
      out += '\t';
      break;
    case 'r':
      out += '\r';
      break;
    default:
      out += c;
      break;
  }
}

}  // namespace

Error TextLexer::fail(std::string message, ErrorCode code) const {
  return makeError(code, std::move(message), linePlace(text_, at_));
}

void TextLexer::skipBlank() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (isSpace(c) || c == '\n' || c == ';') {
      ++at_;
    } else {
      return;
    }
  }
}

bool TextLexer::skipToLineEnd() {
  while (at_ < text_.size() && isSpace(text_[at_])) ++at_;
  return at_ >= text_.size() || text_[at_] == '\n' || text_[at_] == '#' || text_[at_] == ';';
}

bool TextLexer::accept(char c) {
  skipBlank();
  if (peek() != c || atEnd()) return false;
  ++at_;
  return true;
}

std::string_view TextLexer::word() {
  const std::string_view found = peekWord();
  at_ += found.size();
  return found;
}

std::string_view TextLexer::peekWord() {
  skipBlank();
  std::size_t end = at_;
  while (end < text_.size() && isWordCharacter(text_[end])) ++end;
  return text_.substr(at_, end - at_);
}

Result<std::string> TextLexer::quoted() {
  skipBlank();
  const char quote = peek();
  if (quote != '"' && quote != '\'') return fail("a string is expected here");
  const bool triple = text_.substr(at_, 3) == std::string(3, quote);
  const std::size_t open = triple ? 3 : 1;
  const std::string_view close = text_.substr(at_, open);
  std::string out;
  for (std::size_t i = at_ + open; i < text_.size(); ++i) {
    const char c = text_[i];
    if (c == '\\' && i + 1 < text_.size()) {
      appendEscape(text_[++i], out);
    } else if (c == quote && text_.substr(i, open) == close) {
      at_ = i + open;
      return out;
    } else if (c == '\n' && !triple) {
      break;
    } else {
      out += c;
    }
  }
  return fail("a string is not closed");
}

Result<std::string> TextLexer::asset() {
  skipBlank();
  const std::size_t marks = rest().starts_with("@@@") ? 3 : 1;
  if (peek() != '@') return fail("an asset path is expected here");
  const std::size_t start = at_ + marks;
  const std::size_t end = text_.find(text_.substr(at_, marks), start);
  if (end == std::string_view::npos) return fail("an asset path is not closed");
  at_ = end + marks;
  return std::string(text_.substr(start, end - start));
}

Result<std::string> TextLexer::path() {
  skipBlank();
  if (peek() != '<') return fail("a path is expected here");
  const std::size_t end = text_.find('>', at_);
  if (end == std::string_view::npos) return fail("a path is not closed");
  std::string found(text_.substr(at_ + 1, end - at_ - 1));
  at_ = end + 1;
  return found;
}

Status TextLexer::skipToken() {
  switch (peek()) {
    case '"':
    case '\'': {
      const auto text = quoted();
      return text ? Status() : Status(text.error());
    }
    case '@': {
      const auto text = asset();
      return text ? Status() : Status(text.error());
    }
    case '<': {
      const auto text = path();
      return text ? Status() : Status(text.error());
    }
    default:
      advance();
      return {};
  }
}

Status TextLexer::skipValue() {
  skipBlank();
  std::size_t depth = 0;
  do {
    skipBlank();
    if (atEnd()) return fail("the text ends inside a value");
    const char c = peek();
    if (c == '[' || c == '(' || c == '{') {
      ++depth;
      advance();
    } else if (c == ']' || c == ')' || c == '}') {
      if (depth == 0) return fail("a value is expected here");
      --depth;
      advance();
    } else if (isWordCharacter(c) || c == '-' || c == '+' || c == '.') {
      do advance();
      while (!atEnd() && (isWordCharacter(peek()) || peek() == '-' || peek() == '+' || peek() == '.'));
    } else {
      COIF_TRY(skipToken());
    }
  } while (depth > 0);
  return {};
}

Status TextLexer::skipStatement() {
  std::size_t depth = 0;
  while (!atEnd()) {
    const char c = peek();
    if (depth == 0 && (skipToLineEnd() || c == ')' || c == ']' || c == '}')) return {};
    if (atEnd()) break;
    if (depth > 0) skipBlank();
    const char next = peek();
    if (next == '[' || next == '(' || next == '{') ++depth;
    if (next == ']' || next == ')' || next == '}') {
      if (depth == 0) return {};
      --depth;
    }
    COIF_TRY(skipToken());
  }
  return depth == 0 ? Status() : Status(fail("the text ends inside a value"));
}

}  // namespace coif::io::usd
