#include "usd_coding.h"

#include <lz4.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace coif::io::usd {
namespace {

constexpr std::uint64_t kChunk = LZ4_MAX_INPUT_SIZE;
constexpr std::uint64_t kGreatestRatio = 255;  // LZ4: a byte of a length field stands for 255 bytes

/// Small, medium and full sizes of a coded difference.
template <class T>
struct Widths;
template <>
struct Widths<std::int32_t> {
  using Small = std::int8_t;
  using Medium = std::int16_t;
};
template <>
struct Widths<std::int64_t> {
  using Small = std::int16_t;
  using Medium = std::int32_t;
};

template <class T>
T difference(T after, T before) {
  using U = std::make_unsigned_t<T>;
  return T(U(after) - U(before));
}

/// The commonest difference costs no bytes at all. Ties go to the greater one, as in OpenUSD.
template <class T>
T commonest(std::span<const T> values) {
  std::vector<T> differences(values.size());
  T before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    differences[i] = difference(values[i], before);
    before = values[i];
  }
  std::sort(differences.begin(), differences.end());
  T best = 0;
  std::size_t bestCount = 0;
  for (std::size_t i = 0; i < differences.size();) {
    std::size_t end = i;
    while (end < differences.size() && differences[end] == differences[i]) ++end;
    if (end - i >= bestCount) {
      best = differences[i];
      bestCount = end - i;
    }
    i = end;
  }
  return best;
}

template <class T>
void push(T value, std::vector<std::byte>& out) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

template <class Narrow, class T>
bool fits(T value) {
  return T(Narrow(value)) == value;
}

template <class T>
std::size_t codeBytes(std::size_t count) {
  return sizeof(T) + (count * 2 + 7) / 8;
}

/// Bytes out of a buffer; `ok` falls when they run out.
struct Source {
  std::span<const std::byte> bytes;
  bool ok = true;
  template <class T>
  T take() {
    T value{};
    if (bytes.size() < sizeof value) {
      ok = false;
      return value;
    }
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes = bytes.subspan(sizeof value);
    return value;
  }
};

Error broken(const char* what) {
  return makeError(ErrorCode::Malformed, what);
}

Status unpackBlock(std::span<const std::byte> block, std::uint64_t room, std::vector<std::byte>& out) {
  const std::uint64_t most = std::min({room, kChunk, block.size() * kGreatestRatio + 64});
  const std::size_t at = out.size();
  out.resize(at + most);
  const int got = LZ4_decompress_safe(reinterpret_cast<const char*>(block.data()),
                                      reinterpret_cast<char*>(out.data() + at), int(block.size()), int(most));
  if (got < 0) return broken("a compressed block is broken");
  out.resize(at + std::size_t(got));
  return {};
}

}  // namespace

std::vector<std::byte> compress(std::span<const std::byte> bytes) {
  const std::size_t chunks = (bytes.size() + kChunk - 1) / kChunk;
  std::vector<std::byte> out;
  push(std::uint8_t(chunks <= 1 ? 0 : chunks), out);
  for (std::size_t at = 0; at < bytes.size() || at == 0; at += kChunk) {
    const auto chunk = bytes.subspan(at, std::min<std::size_t>(kChunk, bytes.size() - at));
    const std::size_t head = chunks > 1 ? sizeof(std::int32_t) : 0;
    const std::size_t start = out.size();
    out.resize(start + head + std::size_t(LZ4_compressBound(int(chunk.size()))));
    const std::int32_t size = LZ4_compress_default(reinterpret_cast<const char*>(chunk.data()),
                                                   reinterpret_cast<char*>(out.data() + start + head),
                                                   int(chunk.size()), int(out.size() - start - head));
    if (head > 0) std::memcpy(out.data() + start, &size, sizeof size);
    out.resize(start + head + std::size_t(size));
  }
  return out;
}

Result<std::vector<std::byte>> decompress(std::span<const std::byte> packed, std::uint64_t greatest) {
  if (packed.empty()) return broken("a compressed block is empty");
  const auto chunks = std::to_integer<unsigned>(packed[0]);
  packed = packed.subspan(1);
  std::vector<std::byte> out;
  if (chunks == 0) {
    if (packed.size() > kChunk) return broken("a compressed block is longer than LZ4 allows");
    COIF_TRY(unpackBlock(packed, greatest, out));
    return out;
  }
  Source source{packed};
  for (unsigned c = 0; c < chunks; ++c) {
    const auto size = source.take<std::int32_t>();
    if (!source.ok || size < 0 || std::size_t(size) > source.bytes.size()) {
      return broken("a compressed block ends too early");
    }
    COIF_TRY(unpackBlock(source.bytes.first(std::size_t(size)), greatest - out.size(), out));
    source.bytes = source.bytes.subspan(std::size_t(size));
  }
  return out;
}

template <class T>
std::vector<std::byte> encodeIntegers(std::span<const T> values) {
  using Small = typename Widths<T>::Small;
  using Medium = typename Widths<T>::Medium;
  const T common = commonest(values);
  std::vector<std::byte> coded(codeBytes<T>(values.size()));
  std::memcpy(coded.data(), &common, sizeof common);
  T before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T step = difference(values[i], before);
    before = values[i];
    unsigned code = 0;
    if (step == common) {
    } else if (fits<Small>(step)) {
      code = 1;
      push(Small(step), coded);
    } else if (fits<Medium>(step)) {
      code = 2;
      push(Medium(step), coded);
    } else {
      code = 3;
      push(step, coded);
    }
    coded[sizeof(T) + i / 4] |= std::byte(code << (2 * (i % 4)));
  }
  return compress(coded);
}

template <class T>
Result<std::vector<T>> decodeIntegers(std::span<const std::byte> packed, std::uint64_t count) {
  using Small = typename Widths<T>::Small;
  using Medium = typename Widths<T>::Medium;
  using U = std::make_unsigned_t<T>;
  // Two bits at least a number, each byte of LZ4 at most kGreatestRatio: refuses wild counts before any
  // memory.
  if (count / 4 > (packed.size() + 1) * kGreatestRatio) {
    return broken("a list of integers claims more than its bytes can hold");
  }
  COIF_ASSIGN(const std::vector<std::byte> coded,
              decompress(packed, codeBytes<T>(count) + count * sizeof(T)));
  if (coded.size() < codeBytes<T>(count)) return broken("a list of integers ends too early");
  T common;
  std::memcpy(&common, coded.data(), sizeof common);
  Source source{std::span(coded).subspan(codeBytes<T>(count))};
  std::vector<T> values(count);
  U value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    switch (std::to_integer<unsigned>(coded[sizeof(T) + i / 4] >> (2 * (i % 4))) & 3U) {
      case 0:
        value += U(common);
        break;
      case 1:
        value += U(T(source.take<Small>()));
        break;
      case 2:
        value += U(T(source.take<Medium>()));
        break;
      default:
        value += U(source.take<T>());
        break;
    }
    values[i] = T(value);
  }
  if (!source.ok) return broken("a list of integers ends too early");
  return values;
}

template std::vector<std::byte> encodeIntegers(std::span<const std::int32_t>);
template std::vector<std::byte> encodeIntegers(std::span<const std::int64_t>);
template Result<std::vector<std::int32_t>> decodeIntegers(std::span<const std::byte>, std::uint64_t);
template Result<std::vector<std::int64_t>> decodeIntegers(std::span<const std::byte>, std::uint64_t);

}  // namespace coif::io::usd
