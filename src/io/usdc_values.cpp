#include "usdc_values.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "usd_coding.h"

namespace coif::io::usd::crate {
namespace {

constexpr std::uint64_t kArrayEdit = 1ULL << 60;  // since 0.13: a change to an array, not an array

const TypePair* numericType(CrateType type) {
  for (const TypePair& pair : kNumericTypes) {
    if (pair.crate == type) return &pair;
  }
  return nullptr;
}

bool isQuaternion(CrateType type) {
  return type == CrateType::Quatd || type == CrateType::Quatf || type == CrateType::Quath;
}

/// Crates keep the real part last, text (and a Layer) first.
void realPartFirst(std::span<std::byte> bytes, std::size_t size) {
  for (std::size_t at = 0; at + 4 * size <= bytes.size(); at += 4 * size) {
    std::rotate(bytes.begin() + std::ptrdiff_t(at), bytes.begin() + std::ptrdiff_t(at + 3 * size),
                bytes.begin() + std::ptrdiff_t(at + 4 * size));
  }
}

template <class To, class From>
Value converted(const Type& type, const std::vector<From>& from) {
  std::vector<To> to;
  to.reserve(from.size());
  for (const From value : from) to.push_back(To(value));
  return owned(type, std::move(to));
}

template <class T>
Result<Value> fromLookup(const Type& type, std::span<const std::byte> table,
                         const std::vector<std::int32_t>& indices) {
  std::vector<T> out;
  out.reserve(indices.size());
  for (const std::int32_t i : indices) {
    if (i < 0 || std::size_t(i) >= table.size() / sizeof(T)) {
      return makeError(ErrorCode::Malformed, "an index of a packed array is out of range");
    }
    T value;
    std::memcpy(&value, table.data() + std::size_t(i) * sizeof(T), sizeof value);
    out.push_back(value);
  }
  return owned(type, std::move(out));
}

}  // namespace

Error ValueReader::broken(std::uint64_t at, const char* why) {
  return makeError(ErrorCode::Malformed, why, "byte " + std::to_string(at));
}

Result<Value> ValueReader::read(Rep rep) {
  const auto known = known_.find(rep);
  if (known != known_.end()) return known->second;
  COIF_ASSIGN(Value value, readNew(rep));
  known_.emplace(rep, value);
  return value;
}

Result<Value> ValueReader::readNew(Rep rep) {
  if (rep.bits & kArrayEdit) return Value();
  switch (rep.type()) {
    case CrateType::Token:
      return texts(rep, Base::Token);
    case CrateType::String:
      return texts(rep, Base::String);
    case CrateType::AssetPath:
      return texts(rep, Base::Asset);
    case CrateType::TokenVector:
      return tokenVector(rep);
    case CrateType::TimeSamples:
      return firstSample(rep);
    case CrateType::Specifier:
    case CrateType::Variability: {
      Value value = integer(std::int32_t(rep.payload()));
      return value;
    }
    default:
      break;
  }
  const TypePair* type = numericType(rep.type());
  return type == nullptr ? Value() : numeric(rep, *type);
}

Result<Value> ValueReader::numeric(Rep rep, const TypePair& type) {
  if (rep.array()) return array(rep, type);
  if (rep.inlined()) return inlined(rep, type);
  Cursor cursor(file_, rep.payload());
  const Type plain{type.base, type.components, false};
  const auto bytes = cursor.takeBytes(baseBytes(type.base) * type.components);
  if (!cursor.ok) return broken(rep.payload(), "a value lies outside the file");
  std::vector<std::byte> copy(bytes.begin(), bytes.end());
  if (isQuaternion(type.crate)) realPartFirst(copy, baseBytes(type.base));
  Value value = owned(plain, std::move(copy));
  value.array.count = 1;
  return value;
}

/// Numbers of 4 bytes or less as they are; doubles as floats, 64-bit integers as 32, vectors and the
/// diagonals of matrices as signed bytes.
Result<Value> ValueReader::inlined(Rep rep, const TypePair& type) const {
  const Type plain{type.base, type.components, false};
  const auto bits = std::uint32_t(rep.payload());
  if (type.components == 1) {
    if (type.base == Base::Double) {
      float narrow;
      std::memcpy(&narrow, &bits, sizeof narrow);
      return number(narrow);
    }
    if (type.base == Base::Int64) return owned(plain, std::vector<std::int64_t>{std::int32_t(bits)});
    if (type.base == Base::UInt64) return owned(plain, std::vector<std::uint64_t>{bits});
    std::vector<std::byte> bytes(baseBytes(type.base));
    std::memcpy(bytes.data(), &bits, bytes.size());
    Value value = owned(plain, std::move(bytes));
    value.array.count = 1;
    return value;
  }
  const bool matrix = type.components == 9 || type.components == 16 || type.crate == CrateType::Matrix2d;
  const int side = type.components == 16 ? 4 : type.components == 9 ? 3 : 2;
  std::vector<double> numbers(type.components, 0.0);
  for (int i = 0; i < (matrix ? side : type.components); ++i) {
    numbers[std::size_t(matrix ? i * side + i : i)] = std::int8_t(bits >> (8 * i));
  }
  Value value = owned({Base::Double, type.components, false}, std::move(numbers));
  value.array.count = 1;
  return value;
}

std::uint64_t ValueReader::count(Cursor& cursor) const {
  if (tables_.minor < 5) cursor.take<std::uint32_t>();  // a rank, always 1
  return tables_.minor < 7 ? cursor.take<std::uint32_t>() : cursor.take<std::uint64_t>();
}

Result<Value> ValueReader::array(Rep rep, const TypePair& type) {
  const Type plain{type.base, type.components, true};
  if (rep.payload() == 0) return owned(plain, std::vector<std::byte>());
  Cursor cursor(file_, rep.payload());
  const std::uint64_t elements = count(cursor);
  if (!cursor.ok) return broken(rep.payload(), "an array lies outside the file");
  if (rep.compressed() && elements >= kLeastCompressed) {
    auto value = packed(cursor, plain, elements);
    if (!value) {
      Error error = value.error();
      if (error.place.empty()) error.place = "byte " + std::to_string(rep.payload());
      return error;
    }
    return value;
  }
  const std::size_t size = baseBytes(type.base) * type.components;
  if (elements > cursor.left() / size) return broken(rep.payload(), "an array is longer than the file");
  const auto bytes = cursor.takeBytes(elements * size);
  if (isQuaternion(type.crate)) {
    COIF_TRY(budget_.take(bytes.size(), 1));
    std::vector<std::byte> copy(bytes.begin(), bytes.end());
    realPartFirst(copy, baseBytes(type.base));
    Value value = owned(plain, std::move(copy));
    value.array.count = elements;
    return value;
  }
  Value value;
  value.type = plain;
  value.array.data = bytes.data();
  value.array.count = elements;
  return value;
}

Result<Value> ValueReader::packed(Cursor cursor, const Type& type, std::uint64_t elements) {
  if (type.components != 1) return broken(cursor.at(), "only arrays of plain numbers are packed");
  COIF_TRY(budget_.take(elements, 4 * sizeof(std::int64_t)));
  if (type.base == Base::Half || type.base == Base::Float || type.base == Base::Double) {
    return packedFloats(cursor, type, elements);
  }
  const auto block = cursor.takeSized();
  if (!cursor.ok) return broken(cursor.at(), "a packed array is cut off");
  if (type.base == Base::Int || type.base == Base::UInt) {
    COIF_ASSIGN(std::vector<std::int32_t> values, decodeIntegers<std::int32_t>(block, elements));
    return owned(type, std::move(values));
  }
  if (type.base == Base::Int64 || type.base == Base::UInt64) {
    COIF_ASSIGN(std::vector<std::int64_t> values, decodeIntegers<std::int64_t>(block, elements));
    return owned(type, std::move(values));
  }
  return broken(cursor.at(), "only arrays of plain numbers are packed");
}

/// 'i': whole numbers as integers; 't': a table of the few values that occur, and indices into it.
Result<Value> ValueReader::packedFloats(Cursor cursor, const Type& type, std::uint64_t elements) {
  const auto code = char(cursor.take<std::uint8_t>());
  std::span<const std::byte> table;
  if (code == 't') {
    const std::uint64_t values = cursor.take<std::uint32_t>();
    table = cursor.takeBytes(values * baseBytes(type.base));
  }
  const auto block = cursor.takeSized();
  if (!cursor.ok || (code != 'i' && code != 't')) return broken(cursor.at(), "a packed array is cut off");
  COIF_ASSIGN(const std::vector<std::int32_t> indices, decodeIntegers<std::int32_t>(block, elements));
  if (code == 'i') {
    if (type.base == Base::Half) return converted<Eigen::half>(type, indices);
    return type.base == Base::Float ? converted<float>(type, indices) : converted<double>(type, indices);
  }
  if (type.base == Base::Half) return fromLookup<std::uint16_t>(type, table, indices);
  return type.base == Base::Float ? fromLookup<float>(type, table, indices)
                                  : fromLookup<double>(type, table, indices);
}

Result<Value> ValueReader::texts(Rep rep, Base base) {
  Value value;
  value.type = {base, 1, rep.array()};
  std::vector<std::uint64_t> indices;
  if (!rep.array()) {
    indices.push_back(rep.payload());
  } else if (rep.payload() != 0) {
    Cursor cursor(file_, rep.payload());
    const std::uint64_t elements = count(cursor);
    if (!cursor.ok || elements > cursor.left() / 4) {
      return broken(rep.payload(), "an array is longer than the file");
    }
    COIF_TRY(budget_.take(elements, sizeof(std::string) + 8));
    for (std::uint64_t i = 0; i < elements; ++i) indices.push_back(cursor.take<std::uint32_t>());
  }
  for (std::uint64_t index : indices) {
    if (base == Base::String) {
      if (index >= tables_.strings.size()) return broken(rep.payload(), "a string's index is out of range");
      index = tables_.strings[index];
    }
    if (index >= tables_.tokens.size()) return broken(rep.payload(), "a name's index is out of range");
    value.strings.emplace_back(tables_.tokens[index]);
  }
  return value;
}

Result<Value> ValueReader::tokenVector(Rep rep) {
  Cursor cursor(file_, rep.payload());
  const auto elements = cursor.take<std::uint64_t>();
  if (!cursor.ok || elements > cursor.left() / 4)
    return broken(rep.payload(), "a list is longer than the file");
  COIF_TRY(budget_.take(elements, sizeof(std::string)));
  std::vector<std::string> names;
  for (std::uint64_t i = 0; i < elements; ++i) {
    const auto index = cursor.take<std::uint32_t>();
    if (index >= tables_.tokens.size()) return broken(rep.payload(), "a name's index is out of range");
    names.emplace_back(tables_.tokens[index]);
  }
  return tokens(std::move(names));
}

/// Two parts, each at a distance that goes before it: where the times are, then the number of values and the
/// values.
Result<Value> ValueReader::firstSample(Rep rep) {
  auto jump = [&](std::uint64_t from) {
    Cursor cursor(file_, from);
    const std::uint64_t target = from + std::uint64_t(cursor.take<std::int64_t>());
    return Cursor(file_, cursor.ok ? target : std::numeric_limits<std::uint64_t>::max());
  };
  Cursor times = jump(rep.payload());
  times.take<std::uint64_t>();
  if (!times.ok) return broken(rep.payload(), "time samples lie outside the file");
  Cursor values = jump(times.at());
  const auto elements = values.take<std::uint64_t>();
  if (!values.ok) return broken(rep.payload(), "time samples lie outside the file");
  if (elements == 0) return Value();
  const Rep first{values.take<std::uint64_t>()};
  if (!values.ok) return broken(rep.payload(), "time samples lie outside the file");
  return first.type() == CrateType::TimeSamples ? Value() : read(first);
}

Result<std::vector<std::uint32_t>> ValueReader::paths(Rep rep) {
  std::vector<std::uint32_t> found;
  if (rep.type() != CrateType::PathListOp) return found;
  Cursor cursor(file_, rep.payload());
  const auto flags = cursor.take<std::uint8_t>();
  // The lists lie in this order; deletions and orders after them are of no use here.
  for (const int list : {kHasExplicit, kHasAdded, kHasPrepended, kHasAppended}) {
    if (!(flags & list)) continue;
    const auto elements = cursor.take<std::uint64_t>();
    if (!cursor.ok || elements > cursor.left() / 4)
      return broken(rep.payload(), "a list is longer than the file");
    for (std::uint64_t i = 0; i < elements; ++i) {
      const auto path = cursor.take<std::uint32_t>();
      if (path >= tables_.nodes.size()) return broken(rep.payload(), "a path's index is out of range");
      found.push_back(path);
    }
  }
  if (!cursor.ok) return broken(rep.payload(), "a list lies outside the file");
  return found;
}

}  // namespace coif::io::usd::crate
