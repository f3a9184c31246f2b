// Numbers that the crate format fixes (version 0.8.0), shared by its writer and its reader.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "usd_value.h"

namespace coif::io::usd::crate {

inline constexpr std::string_view kMagic = "PXR-USDC";
inline constexpr std::size_t kHeaderBytes =
    88;  ///< magic, version, offset of the table of contents, reserved
inline constexpr std::size_t kSectionBytes = 32;  ///< char[16] name, int64 start, int64 size
inline constexpr std::array<std::uint8_t, 8> kVersion = {0, 8, 0};
inline constexpr std::uint64_t kLeastCompressed = 16;  ///< shorter arrays are never compressed
inline constexpr std::uint32_t kEndOfFieldSet = 0xFFFFFFFF;

enum class CrateType : std::uint8_t {
  Invalid,
  Bool,
  UChar,
  Int,
  UInt,
  Int64,
  UInt64,
  Half,
  Float,
  Double,
  String,
  Token,
  AssetPath,
  Matrix2d,
  Matrix3d,
  Matrix4d,
  Quatd,
  Quatf,
  Quath,
  Vec2d,
  Vec2f,
  Vec2h,
  Vec2i,
  Vec3d,
  Vec3f,
  Vec3h,
  Vec3i,
  Vec4d,
  Vec4f,
  Vec4h,
  Vec4i,
  Dictionary,
  TokenListOp,
  StringListOp,
  PathListOp,
  ReferenceListOp,
  IntListOp,
  Int64ListOp,
  UIntListOp,
  UInt64ListOp,
  PathVector,
  TokenVector,
  Specifier,
  Permission,
  Variability,
  VariantSelectionMap,
  TimeSamples,
  Payload,
  DoubleVector,
  LayerOffsetVector,
  StringVector,
  ValueBlock,
  Value,
  UnregisteredValue,
  UnregisteredValueListOp,
  PayloadListOp,
  TimeCode,
};

enum class SpecType : std::int32_t {
  Attribute = 1,
  Prim = 6,
  PseudoRoot = 7,
  Relationship = 8,
  Variant = 10
};

/// A value in a field: 48 bits of offset or of the value itself, the type, and three flags.
struct Rep {
  std::uint64_t bits = 0;
  static constexpr std::uint64_t kArray = 1ULL << 63, kInlined = 1ULL << 62, kCompressed = 1ULL << 61;
  static constexpr std::uint64_t kPayload = (1ULL << 48) - 1;
  static Rep of(CrateType type, std::uint64_t flags, std::uint64_t payload) {
    return {flags | (std::uint64_t(type) << 48) | (payload & kPayload)};
  }
  CrateType type() const { return CrateType((bits >> 48) & 0xFF); }
  bool array() const { return bits & kArray; }
  bool inlined() const { return bits & kInlined; }
  bool compressed() const { return bits & kCompressed; }
  std::uint64_t payload() const { return bits & kPayload; }
  auto operator<=>(const Rep&) const = default;
};

/// Bits of a list operation's first byte, in the order in which its lists follow.
enum ListOp : std::uint8_t {
  kExplicitFlag = 1,
  kHasExplicit = 2,
  kHasAdded = 4,
  kHasDeleted = 8,
  kHasOrdered = 16,
  kHasPrepended = 32,
  kHasAppended = 64
};

struct TypePair {
  CrateType crate;
  Base base;
  std::uint8_t components;
};
/// Kinds of numbers. The first entry of a (base, components) pair is the one that is written.
inline constexpr std::array kNumericTypes = {
    TypePair{CrateType::Bool, Base::Bool, 1},        TypePair{CrateType::UChar, Base::UChar, 1},
    TypePair{CrateType::Int, Base::Int, 1},          TypePair{CrateType::UInt, Base::UInt, 1},
    TypePair{CrateType::Int64, Base::Int64, 1},      TypePair{CrateType::UInt64, Base::UInt64, 1},
    TypePair{CrateType::Half, Base::Half, 1},        TypePair{CrateType::Float, Base::Float, 1},
    TypePair{CrateType::Double, Base::Double, 1},    TypePair{CrateType::Vec2d, Base::Double, 2},
    TypePair{CrateType::Vec2f, Base::Float, 2},      TypePair{CrateType::Vec2h, Base::Half, 2},
    TypePair{CrateType::Vec2i, Base::Int, 2},        TypePair{CrateType::Vec3d, Base::Double, 3},
    TypePair{CrateType::Vec3f, Base::Float, 3},      TypePair{CrateType::Vec3h, Base::Half, 3},
    TypePair{CrateType::Vec3i, Base::Int, 3},        TypePair{CrateType::Vec4d, Base::Double, 4},
    TypePair{CrateType::Vec4f, Base::Float, 4},      TypePair{CrateType::Vec4h, Base::Half, 4},
    TypePair{CrateType::Vec4i, Base::Int, 4},        TypePair{CrateType::Quatd, Base::Double, 4},
    TypePair{CrateType::Quatf, Base::Float, 4},      TypePair{CrateType::Quath, Base::Half, 4},
    TypePair{CrateType::Matrix2d, Base::Double, 4},  TypePair{CrateType::Matrix3d, Base::Double, 9},
    TypePair{CrateType::Matrix4d, Base::Double, 16}, TypePair{CrateType::TimeCode, Base::Double, 1},
};

}  // namespace coif::io::usd::crate
