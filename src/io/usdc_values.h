// Values of a crate, read where a field points.
#pragma once

#include <map>

#include "usdc_tables.h"

namespace coif::io::usd::crate {

class ValueReader {
 public:
  ValueReader(std::span<const std::byte> file, const Tables& tables, MemoryBudget& budget)
      : file_(file), tables_(tables), budget_(budget) {}

  /// Numbers, texts, token vectors; of time samples the first. Base::None for what Coif does not read. Plain
  /// arrays are views of the file; a value that several fields point to is unpacked once. Errors: Malformed
  /// (place: the byte), TooLarge.
  Result<Value> read(Rep rep);
  /// The targets of a path list operation or a path vector, as path indices.
  Result<std::vector<std::uint32_t>> paths(Rep rep);

 private:
  Result<Value> readNew(Rep rep);
  Result<Value> numeric(Rep rep, const TypePair& type);
  Result<Value> inlined(Rep rep, const TypePair& type) const;
  Result<Value> array(Rep rep, const TypePair& type);
  Result<Value> packed(Cursor cursor, const Type& type, std::uint64_t count);
  Result<Value> packedFloats(Cursor cursor, const Type& type, std::uint64_t count);
  Result<Value> texts(Rep rep, Base base);
  Result<Value> tokenVector(Rep rep);
  Result<Value> firstSample(Rep rep);
  std::uint64_t count(Cursor& cursor) const;
  static Error broken(std::uint64_t at, const char* why);

  std::span<const std::byte> file_;
  const Tables& tables_;
  std::map<Rep, Value> known_;
  MemoryBudget& budget_;
};

}  // namespace coif::io::usd::crate
