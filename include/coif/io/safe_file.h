// Reading with a limit, and writing that never harms the old file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coif/base/result.h"

namespace coif {

/// The whole file. Errors: NotFound, Unreadable (a directory, no permission), TooLarge past maxBytes.
Result<std::vector<std::byte>> readFile(const std::filesystem::path& path,
                                        std::uint64_t maxBytes = std::uint64_t{1} << 31);

/// Writes to a temporary file beside `path`; commit() flushes it to disk and renames it over `path`. Without
/// a commit the temporary file is removed and the old file is as it was. The first failed write is kept and
/// returned by commit(), so callers need not test each one.
class SafeFile {
 public:
  static Result<SafeFile> create(const std::filesystem::path& path);
  SafeFile(SafeFile&&) noexcept;
  SafeFile& operator=(SafeFile&&) noexcept;
  ~SafeFile();

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  template <class T>
  void writeArray(std::span<const T> values) {
    write(std::as_bytes(values));
  }
  std::uint64_t position() const;             ///< bytes written so far (or the last seek)
  void seek(std::uint64_t position);          ///< to patch an earlier header
  const std::filesystem::path& path() const;  ///< the final name
  Status commit();

 private:
  struct Impl;
  explicit SafeFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
