#include "scene/typed_array.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace coif::scene {

namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are stored as they lie in memory");

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string toBase64(std::span<const std::uint8_t> bytes) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < n; ++j) word |= std::uint32_t(bytes[i + j]) << (16 - 8 * j);
    for (std::size_t j = 0; j < 4; ++j) out += j <= n ? kDigits[(word >> (18 - 6 * j)) & 63] : '=';
  }
  return out;
}

std::optional<std::vector<std::uint8_t>> fromBase64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::array<std::int8_t, 256> value;
  value.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i) value[std::uint8_t(kDigits[i])] = std::int8_t(i);
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    const bool last = i + 4 == text.size();
    const std::size_t pad = last ? std::size_t(text[i + 3] == '=') + std::size_t(text[i + 2] == '=') : 0;
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 4 - pad; ++j) {
      const std::int8_t digit = value[std::uint8_t(text[i + j])];
      if (digit < 0) return std::nullopt;
      word |= std::uint32_t(digit) << (18 - 6 * j);
    }
    for (std::size_t j = 0; j < 3 - pad; ++j) out.push_back(std::uint8_t(word >> (16 - 8 * j)));
  }
  return out;
}

template <class Stored, class Value>
std::string encodeAs(const char* prefix, std::span<const Value> values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(Stored));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Stored stored = static_cast<Stored>(values[i]);
    std::memcpy(bytes.data() + i * sizeof(Stored), &stored, sizeof(Stored));
  }
  return prefix + toBase64(bytes);
}

template <class Stored, class Value>
std::optional<std::vector<Value>> decodeAs(std::string_view base64) {
  const auto bytes = fromBase64(base64);
  if (!bytes || bytes->size() % sizeof(Stored) != 0) return std::nullopt;
  std::vector<Value> values(bytes->size() / sizeof(Stored));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Stored stored;
    std::memcpy(&stored, bytes->data() + i * sizeof(Stored), sizeof(Stored));
    values[i] = static_cast<Value>(stored);
  }
  return values;
}

}  // namespace

std::string encodeIntegers(std::span<const std::uint32_t> values) {
  const std::uint32_t top = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  if (top <= 0xff) return encodeAs<std::uint8_t>("u8:", values);
  if (top <= 0xffff) return encodeAs<std::uint16_t>("u16:", values);
  return encodeAs<std::uint32_t>("u32:", values);
}

std::string encodeDoubles(std::span<const double> values) {
  return encodeAs<double>("f64:", values);
}

std::optional<std::vector<std::uint32_t>> decodeIntegers(std::string_view text) {
  if (text.starts_with("u8:")) return decodeAs<std::uint8_t, std::uint32_t>(text.substr(3));
  if (text.starts_with("u16:")) return decodeAs<std::uint16_t, std::uint32_t>(text.substr(4));
  if (text.starts_with("u32:")) return decodeAs<std::uint32_t, std::uint32_t>(text.substr(4));
  return std::nullopt;
}

std::optional<std::vector<double>> decodeDoubles(std::string_view text) {
  if (text.starts_with("f64:")) return decodeAs<double, double>(text.substr(4));
  return std::nullopt;
}

}  // namespace coif::scene
