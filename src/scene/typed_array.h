// Arrays inside JSON as "type:base64" strings of little-endian values: exact and a third of the digits' size.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coif::scene {

/// The narrowest of u8, u16, u32 that holds every value.
std::string encodeIntegers(std::span<const std::uint32_t> values);
std::string encodeDoubles(std::span<const double> values);

/// Empty when the text is no such array.
std::optional<std::vector<std::uint32_t>> decodeIntegers(std::string_view text);
std::optional<std::vector<double>> decodeDoubles(std::string_view text);

}  // namespace coif::scene
