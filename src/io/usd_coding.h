// The two codings inside a crate: blocks of LZ4, and integers as differences of 0, 1, 2 or 4 (2, 4, 8) bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/result.h"

namespace coif::io::usd {

/// LZ4 blocks in USD's framing: a byte of chunks (0: one block, no sizes), each of at most 0x7E000000 bytes.
std::vector<std::byte> compress(std::span<const std::byte> bytes);
/// At most `greatest` bytes come out; no more memory is taken than LZ4 could need for so many compressed
/// bytes. Errors: Malformed.
Result<std::vector<std::byte>> decompress(std::span<const std::byte> packed, std::uint64_t greatest);

/// Integers of 32 or 64 bits, coded and compressed. T: int32_t, int64_t.
template <class T>
std::vector<std::byte> encodeIntegers(std::span<const T> values);
/// Errors: Malformed, also when `count` values cannot hide in so few bytes.
template <class T>
Result<std::vector<T>> decodeIntegers(std::span<const std::byte> packed, std::uint64_t count);

}  // namespace coif::io::usd
