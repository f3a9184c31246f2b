#include "io/scan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace coif::io {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}
bool isLineEnd(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

Status MemoryBudget::take(std::uint64_t count, std::uint64_t size) {
  if (used_ > kMaxReaderBytes || count > (kMaxReaderBytes - used_) / size) {
    return makeError(ErrorCode::TooLarge, "reading this file would take more than 2 GiB of memory");
  }
  used_ += count * size;
  return {};
}

std::string linePlace(std::string_view text, std::size_t offset) {
  std::size_t line = 1;
  for (std::size_t i = 0; i < std::min(offset, text.size()); ++i) {
    const bool pair = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if (isLineEnd(text[i]) && !pair) ++line;
  }
  return "line " + std::to_string(line);
}

bool TextCursor::skipBlanks() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (isBlank(c)) {
      ++at_;
    } else if (style_ == Style::HashComments && c == '#') {
      while (at_ < text_.size() && !isLineEnd(text_[at_])) ++at_;
    } else if (style_ == Style::Continuations && c == '\\' && at_ + 1 < text_.size() &&
               isLineEnd(text_[at_ + 1])) {
      at_ += text_.substr(at_ + 1, 2) == "\r\n" ? 3 : 2;
    } else {
      return !isLineEnd(c);
    }
  }
  return false;
}

std::string_view TextCursor::wordOnLine() {
  if (!skipBlanks()) return {};
  word_ = at_;
  while (at_ < text_.size() && !isBlank(text_[at_]) && !isLineEnd(text_[at_])) {
    const bool continued = style_ == Style::Continuations && text_[at_] == '\\' && at_ + 1 < text_.size() &&
                           isLineEnd(text_[at_ + 1]);
    if (continued || (style_ == Style::HashComments && text_[at_] == '#')) break;
    ++at_;
  }
  return text_.substr(word_, at_ - word_);
}

std::string_view TextCursor::word() {
  while (!atEnd()) {
    const std::string_view found = wordOnLine();
    if (!found.empty()) return found;
    if (!atEnd()) ++at_;  // a line end
  }
  return {};
}

std::string_view TextCursor::restOfLine() {
  while (at_ < text_.size() && isBlank(text_[at_])) ++at_;
  const std::size_t begin = at_;
  while (at_ < text_.size() && !isLineEnd(text_[at_])) ++at_;
  std::size_t end = at_;
  while (end > begin && isBlank(text_[end - 1])) --end;
  return text_.substr(begin, end - begin);
}

void TextCursor::nextLine() {
  if (style_ == Style::Continuations) {
    while (!wordOnLine().empty()) {
    }
  }
  while (at_ < text_.size() && !isLineEnd(text_[at_])) ++at_;
  if (at_ < text_.size()) at_ += text_.substr(at_, 2) == "\r\n" ? 2 : 1;
}

bool parseNumber(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = end == word.data() + word.size();
  if (code == std::errc::result_out_of_range && whole) {
    const std::size_t exponent = word.find_first_of("eE");
    const bool tiny =
        exponent == std::string_view::npos ? std::abs(value) < 1 : word.substr(exponent + 1, 1) == "-";
    value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return true;
  }
  if (code == std::errc() &&
      word.find(".#") != std::string_view::npos) {  // 1.#IND, as some C libraries print NaN
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  return code == std::errc() && whole;
}

bool parseInteger(std::string_view word, std::int64_t& value) {
  if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && end == word.data() + word.size();
}

Status FaceNames::set(Kind kind, std::string_view name, std::size_t firstFace, MemoryBudget& budget) {
  auto& names = names_[kind];
  const std::string key(name.empty() ? "default" : name);
  const auto [entry, isNew] = indexOf_[kind].try_emplace(key, std::uint32_t(names.size()));
  if (isNew) {
    constexpr std::uint64_t kEntryBytes = 160;  // two strings, a table node and the vectors' spare room
    COIF_TRY(budget.take(key.size() + kEntryBytes, 1));
    names.push_back(key);
  }
  if (runs_.back().firstFace != firstFace) {
    COIF_TRY(budget.take(3, sizeof(Run)));  // a growing vector holds up to three times its size
    runs_.push_back({firstFace, runs_.back().names});
  }
  runs_.back().names[kind] = entry->second;
  return {};
}

std::vector<std::uint8_t> FaceNames::namesInUse(Kind kind, std::size_t faceCount) const {
  std::vector<std::uint8_t> used(names_[kind].size() + 1, 0);  // the last: faces without a name
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const std::size_t end = r + 1 < runs_.size() ? runs_[r + 1].firstFace : faceCount;
    const std::uint32_t name = runs_[r].names[kind];
    if (end > runs_[r].firstFace) used[name == kNone ? used.size() - 1 : name] = 1;
  }
  return used;
}

void FaceNames::finish(PolygonMesh& mesh, const std::array<const char*, kKinds>& kindNames) const {
  const std::size_t faceCount = mesh.faceCount();
  int chosen = -1;
  std::string others;
  for (const bool apart : {true, false}) {
    for (int kind = 0; kind < kKinds && chosen < 0; ++kind) {
      const auto used = namesInUse(Kind(kind), faceCount);
      const auto named = std::count(used.begin(), used.end() - 1, 1);
      if (named + used.back() >= (apart ? 2 : 1) && named > 0) chosen = kind;
    }
  }
  if (chosen < 0) return;
  for (int kind = 0; kind < kKinds; ++kind) {
    const auto used = namesInUse(Kind(kind), faceCount);
    const bool named = std::find(used.begin(), used.end() - 1, 1) != used.end() - 1;
    if (kind != chosen && named)
      others += std::string(others.empty() ? "" : " and ") + kindNames[std::size_t(kind)];
  }

  const auto& names = names_[std::size_t(chosen)];
  const auto unnamed = indexOf_[std::size_t(chosen)].find("default");  // faces without a name join it
  const std::size_t unnamedIndex =
      unnamed == indexOf_[std::size_t(chosen)].end() ? names.size() : unnamed->second;
  std::vector<std::uint32_t> groupOf(names.size() + 1, kNone);
  mesh.faceGroups.reserve(faceCount);
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const std::size_t end = r + 1 < runs_.size() ? runs_[r + 1].firstFace : faceCount;
    if (end <= runs_[r].firstFace) continue;
    const std::uint32_t name = runs_[r].names[std::size_t(chosen)];
    const std::size_t index = name == kNone ? unnamedIndex : name;
    if (groupOf[index] == kNone) {
      groupOf[index] = std::uint32_t(mesh.groupNames.size());
      mesh.groupNames.push_back(index < names.size() ? names[index] : "default");
    }
    mesh.faceGroups.insert(mesh.faceGroups.end(), end - runs_[r].firstFace, groupOf[index]);
  }
  if (!others.empty()) {
    mesh.notes.push_back(std::string("Face groups are the file's ") + kindNames[std::size_t(chosen)] +
                         "; its " + others + " are left out.");
  }
}

void noteCount(PolygonMesh& mesh, std::uint64_t count, const std::string& what) {
  if (count > 0) mesh.notes.push_back(std::to_string(count) + " " + what);
}

}  // namespace coif::io
