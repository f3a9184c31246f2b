// The tables of a crate file: names, fields, paths, specs; every offset and count checked against the file.
#pragma once

#include <string_view>
#include <vector>

#include "coif/base/vec.h"
#include "scan.h"
#include "usd_crate.h"

namespace coif::io::usd::crate {

/// Checked reading at an offset of the file; `ok` falls at the first read past the end and stays down.
class Cursor {
 public:
  Cursor(std::span<const std::byte> file, std::uint64_t at) : file_(file), at_(at), ok(at <= file.size()) {}
  template <class T>
  T take() {
    T value{};
    const auto bytes = takeBytes(sizeof value);
    if (ok) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> takeBytes(std::uint64_t count) {
    ok = ok && count <= file_.size() - at_;
    if (!ok) return {};
    at_ += count;
    return file_.subspan(at_ - count, count);
  }
  /// A block whose size in bytes goes before it.
  std::span<const std::byte> takeSized() { return takeBytes(take<std::uint64_t>()); }
  std::uint64_t at() const { return at_; }
  std::uint64_t left() const { return ok ? file_.size() - at_ : 0; }

 private:
  std::span<const std::byte> file_;
  std::uint64_t at_ = 0;

 public:
  bool ok = true;
};

/// A prim, a property or the root, with its place in the tree.
struct Node {
  std::uint32_t parent = kNone;
  std::uint32_t name = 0;  ///< token
  bool property = false;
  SpecType type{};  ///< of the spec at this path; 0: none
  std::uint32_t fieldSet = 0;
};

struct Tables {
  std::uint8_t minor = 0;  ///< version 0.minor
  std::vector<std::byte> text;
  std::vector<std::string_view> tokens;  ///< into `text`
  std::vector<std::uint32_t> strings;    ///< tokens
  std::vector<std::uint32_t> fieldNames;
  std::vector<Rep> fieldReps;
  std::vector<std::uint32_t> fieldSets;
  std::vector<Node> nodes;           ///< by path index; those that no path names have no parent and no type
  std::vector<std::uint32_t> order;  ///< path indices, parents before children, siblings as in the file
};

/// Errors: Malformed (place: the section), Unsupported (version before 0.4 or after 0.13), TooLarge.
Result<Tables> readTables(std::span<const std::byte> file, MemoryBudget& budget);

}  // namespace coif::io::usd::crate
