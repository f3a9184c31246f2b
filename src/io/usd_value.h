// A USD layer in memory: prims, attributes, values. One description serves both file forms, both ways.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif::io::usd {

/// What one component of a value is. Token lists are the list operations that `prepend apiSchemas` needs.
enum class Base : std::uint8_t {
  None,  ///< blocked, or of a kind that Coif does not read
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
  Asset,
  Dictionary,
  PrependedTokens,
};

struct Type {
  Base base = Base::None;
  std::uint8_t components = 1;  ///< 3 of float3, 16 of matrix4d
  bool array = false;
  bool operator==(const Type&) const = default;
};

std::size_t baseBytes(Base base);  ///< of one number in memory and in crates; 0 of what is not a number
inline bool isNumeric(Base base) {
  return base >= Base::Bool && base <= Base::Double;
}
inline bool isText(Base base) {
  return base >= Base::String && base <= Base::Asset;
}

/// "point3f[]" → float, 3, array. Base::None when the name is unknown.
Type typeOfName(std::string_view typeName);

/// `count` consecutive elements from `first`.
struct Run {
  std::uint64_t first = 0, count = 0;
};

/// Numbers, seen not owned (unless `owner` is set), of the machine's little-endian form; with `runs`, those
/// pieces of them one after the other, so that the strands of a group are sent out of the whole set without a
/// copy.
struct Array {
  const std::byte* data = nullptr;  ///< may be unaligned
  std::uint64_t count = 0;          ///< elements, all runs together
  std::shared_ptr<const std::vector<Run>> runs;
  std::shared_ptr<const void> owner;

  /// Calls piece(bytes) for each run in order; `elementBytes` is of one element.
  template <class F>
  void forEachPiece(std::size_t elementBytes, F&& piece) const {
    if (!runs) return piece(std::span(data, std::size_t(count) * elementBytes));
    for (const Run& run : *runs) {
      piece(std::span(data + run.first * elementBytes, std::size_t(run.count) * elementBytes));
    }
  }
};

struct Entry;

struct Value {
  Type type;
  Array array;                       ///< numbers; a scalar is an array of one
  std::vector<std::string> strings;  ///< strings, tokens, assets, prepended tokens
  std::vector<Entry> entries;        ///< of a dictionary

  std::size_t elementBytes() const { return baseBytes(type.base) * type.components; }
  /// The string of a scalar token, string or asset; else empty.
  std::string_view text() const {
    return isText(type.base) && !strings.empty() ? std::string_view(strings[0]) : std::string_view();
  }
};

struct Entry {
  std::string name;
  Value value;
};

struct Sample {
  double time = 0;
  Value value;
};

struct Attribute {
  std::string name, typeName;
  bool uniform = false, custom = false;
  std::optional<Value> value;
  std::vector<Sample> samples;  ///< by ascending time; the readers keep the first alone
  std::vector<Entry> metadata;  ///< interpolation and the like
  std::vector<std::string> connections;
};

struct Relationship {
  std::string name;
  std::vector<std::string> targets;
};

enum class Specifier : std::uint8_t { Def, Over, Class };

struct Prim {
  std::string name, typeName;
  Specifier specifier = Specifier::Def;
  std::vector<Entry> metadata;
  std::vector<Attribute> attributes;
  std::vector<Relationship> relationships;
  std::vector<Prim> children;

  const Attribute* attribute(std::string_view wanted) const;
  /// The default of an attribute or, without one, its first sample; null when it has neither.
  const Value* value(std::string_view wanted) const;
};

struct Layer {
  std::vector<Entry> metadata;
  std::vector<Prim> prims;
  std::vector<std::string> notes;  ///< what the reader left out
};

const Value* find(std::span<const Entry> entries, std::string_view name);

// Making values.
Value token(std::string text);
Value string(std::string text);
Value tokens(std::vector<std::string> texts);
/// matrix4d: USD's points are rows, so that the transpose is stored.
Value matrix(const Eigen::Matrix4d& columns);
Value prependedTokens(std::vector<std::string> texts);
Value number(double value);
Value integer(std::int32_t value);
Value floatValue(float value);
Value boolean(bool value);

/// An array over numbers that the caller keeps alive; T is the element (Vec3f, float, …).
template <class T>
Value view(Type type, std::span<const T> elements, std::shared_ptr<const std::vector<Run>> runs = {},
           std::uint64_t count = 0) {
  Value value;
  value.type = type;
  value.array = {reinterpret_cast<const std::byte*>(elements.data()), runs ? count : elements.size(),
                 std::move(runs), nullptr};
  return value;
}

/// An array that keeps its numbers.
template <class T>
Value owned(Type type, std::vector<T> elements) {
  auto keep = std::make_shared<const std::vector<T>>(std::move(elements));
  Value value = view(type, std::span<const T>(*keep));
  value.array.owner = keep;
  return value;
}

/// All numbers of a value, component after component, as T; empty when it holds none.
template <class T>
std::vector<T> numbers(const Value& value);
/// The first number, or `otherwise`.
double firstNumber(const Value* value, double otherwise);

}  // namespace coif::io::usd
