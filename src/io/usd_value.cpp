#include "usd_value.h"

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace coif::io::usd {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays go to files as they lie in memory");

struct NamedType {
  std::string_view name;
  Base base;
  std::uint8_t components;
};
constexpr std::array kTypes = {
    NamedType{"bool", Base::Bool, 1},
    NamedType{"uchar", Base::UChar, 1},
    NamedType{"int", Base::Int, 1},
    NamedType{"int2", Base::Int, 2},
    NamedType{"int3", Base::Int, 3},
    NamedType{"int4", Base::Int, 4},
    NamedType{"uint", Base::UInt, 1},
    NamedType{"int64", Base::Int64, 1},
    NamedType{"uint64", Base::UInt64, 1},
    NamedType{"half", Base::Half, 1},
    NamedType{"half2", Base::Half, 2},
    NamedType{"half3", Base::Half, 3},
    NamedType{"half4", Base::Half, 4},
    NamedType{"float", Base::Float, 1},
    NamedType{"float2", Base::Float, 2},
    NamedType{"float3", Base::Float, 3},
    NamedType{"float4", Base::Float, 4},
    NamedType{"double", Base::Double, 1},
    NamedType{"double2", Base::Double, 2},
    NamedType{"double3", Base::Double, 3},
    NamedType{"double4", Base::Double, 4},
    NamedType{"timecode", Base::Double, 1},
    NamedType{"point3h", Base::Half, 3},
    NamedType{"point3f", Base::Float, 3},
    NamedType{"point3d", Base::Double, 3},
    NamedType{"vector3h", Base::Half, 3},
    NamedType{"vector3f", Base::Float, 3},
    NamedType{"vector3d", Base::Double, 3},
    NamedType{"normal3h", Base::Half, 3},
    NamedType{"normal3f", Base::Float, 3},
    NamedType{"normal3d", Base::Double, 3},
    NamedType{"color3h", Base::Half, 3},
    NamedType{"color3f", Base::Float, 3},
    NamedType{"color3d", Base::Double, 3},
    NamedType{"color4h", Base::Half, 4},
    NamedType{"color4f", Base::Float, 4},
    NamedType{"color4d", Base::Double, 4},
    NamedType{"texCoord2h", Base::Half, 2},
    NamedType{"texCoord2f", Base::Float, 2},
    NamedType{"texCoord2d", Base::Double, 2},
    NamedType{"texCoord3h", Base::Half, 3},
    NamedType{"texCoord3f", Base::Float, 3},
    NamedType{"texCoord3d", Base::Double, 3},
    NamedType{"quath", Base::Half, 4},
    NamedType{"quatf", Base::Float, 4},
    NamedType{"quatd", Base::Double, 4},
    NamedType{"matrix2d", Base::Double, 4},
    NamedType{"matrix3d", Base::Double, 9},
    NamedType{"matrix4d", Base::Double, 16},
    NamedType{"frame4d", Base::Double, 16},
    NamedType{"string", Base::String, 1},
    NamedType{"token", Base::Token, 1},
    NamedType{"asset", Base::Asset, 1},
    NamedType{"dictionary", Base::Dictionary, 1},
    // Names from before roles had one form; test layers and old files still carry them.
    NamedType{"Vec2f", Base::Float, 2},
    NamedType{"Vec3f", Base::Float, 3},
    NamedType{"Vec3d", Base::Double, 3},
    NamedType{"PointFloat", Base::Float, 3},
    NamedType{"Point", Base::Double, 3},
    NamedType{"NormalFloat", Base::Float, 3},
    NamedType{"ColorFloat", Base::Float, 3},
    NamedType{"Matrix4d", Base::Double, 16},
    NamedType{"Transform", Base::Double, 16},
};

Value texts(Base base, bool array, std::vector<std::string> values) {
  Value value;
  value.type = {base, 1, array};
  value.strings = std::move(values);
  return value;
}

template <class T>
Value scalar(Base base, T number) {
  Value value = owned<T>({base, 1, false}, {number});
  return value;
}

template <class From, class T>
void append(std::span<const std::byte> bytes, std::vector<T>& out) {
  for (std::size_t at = 0; at + sizeof(From) <= bytes.size(); at += sizeof(From)) {
    From number;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    if constexpr (std::is_integral_v<T> && !std::is_integral_v<From>) {
      const double wide = double(number);  // 2^53: beyond it a double names no integer exactly
      out.push_back(std::abs(wide) < 0x1p53 ? T(wide) : std::numeric_limits<T>::min());
    } else {
      out.push_back(static_cast<T>(number));
    }
  }
}

template <class T>
void appendPiece(Base base, std::span<const std::byte> bytes, std::vector<T>& out) {
  switch (base) {
    case Base::Bool:
    case Base::UChar:
      return append<std::uint8_t>(bytes, out);
    case Base::Int:
      return append<std::int32_t>(bytes, out);
    case Base::UInt:
      return append<std::uint32_t>(bytes, out);
    case Base::Int64:
      return append<std::int64_t>(bytes, out);
    case Base::UInt64:
      return append<std::uint64_t>(bytes, out);
    case Base::Half:
      return append<Eigen::half>(bytes, out);
    case Base::Float:
      return append<float>(bytes, out);
    case Base::Double:
      return append<double>(bytes, out);
    default:
      return;
  }
}

}  // namespace

std::size_t baseBytes(Base base) {
  switch (base) {
    case Base::Bool:
    case Base::UChar:
      return 1;
    case Base::Half:
      return 2;
    case Base::Int:
    case Base::UInt:
    case Base::Float:
      return 4;
    case Base::Int64:
    case Base::UInt64:
    case Base::Double:
      return 8;
    default:
      return 0;
  }
}

Type typeOfName(std::string_view typeName) {
  Type type;
  type.array = typeName.ends_with("[]");
  if (type.array) typeName.remove_suffix(2);
  for (const NamedType& known : kTypes) {
    if (known.name == typeName) {
      type.base = known.base;
      type.components = known.components;
    }
  }
  return type;
}

const Attribute* Prim::attribute(std::string_view wanted) const {
  for (const Attribute& a : attributes) {
    if (a.name == wanted) return &a;
  }
  return nullptr;
}

const Value* Prim::value(std::string_view wanted) const {
  const Attribute* a = attribute(wanted);
  if (a == nullptr) return nullptr;
  if (a->value && a->value->type.base != Base::None) return &*a->value;
  return a->samples.empty() ? nullptr : &a->samples.front().value;
}

const Value* find(std::span<const Entry> entries, std::string_view name) {
  for (const Entry& entry : entries) {
    if (entry.name == name) return &entry.value;
  }
  return nullptr;
}

Value token(std::string text) {
  return texts(Base::Token, false, {std::move(text)});
}
Value string(std::string text) {
  return texts(Base::String, false, {std::move(text)});
}
Value tokens(std::vector<std::string> values) {
  return texts(Base::Token, true, std::move(values));
}
Value prependedTokens(std::vector<std::string> values) {
  return texts(Base::PrependedTokens, false, std::move(values));
}
Value matrix(const Eigen::Matrix4d& columns) {
  std::vector<double> numbers(columns.data(), columns.data() + 16);  // by columns: USD's rows
  Value value = owned(Type{Base::Double, 16, false}, std::move(numbers));
  value.array.count = 1;
  return value;
}
Value number(double value) {
  return scalar(Base::Double, value);
}
Value integer(std::int32_t value) {
  return scalar(Base::Int, value);
}
Value floatValue(float value) {
  return scalar(Base::Float, value);
}
Value boolean(bool value) {
  return scalar(Base::Bool, std::uint8_t(value));
}

template <class T>
std::vector<T> numbers(const Value& value) {
  std::vector<T> out;
  if (!isNumeric(value.type.base)) return out;
  out.reserve(value.array.count * value.type.components);
  value.array.forEachPiece(value.elementBytes(), [&](std::span<const std::byte> bytes) {
    if constexpr (std::is_same_v<T, float>) {  // the large ones, as they are
      if (value.type.base == Base::Float) {
        const std::size_t first = out.size();
        out.resize(first + bytes.size() / sizeof(float));
        if (!bytes.empty()) std::memcpy(out.data() + first, bytes.data(), bytes.size());
        return;
      }
    }
    appendPiece(value.type.base, bytes, out);
  });
  return out;
}
template std::vector<float> numbers(const Value&);
template std::vector<double> numbers(const Value&);
template std::vector<std::int64_t> numbers(const Value&);

double firstNumber(const Value* value, double otherwise) {
  if (value == nullptr || !isNumeric(value->type.base) || value->array.count == 0) return otherwise;
  Value first = *value;
  first.type.array = false;
  first.array.runs = nullptr;
  first.array.count = 1;
  return numbers<double>(first).front();
}

}  // namespace coif::io::usd
