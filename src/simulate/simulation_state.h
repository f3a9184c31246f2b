// State as bytes: numbers and arrays with their lengths, one after the other, of the machine's little-endian
// form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace coif::simulate {

class StateWriter {
 public:
  template <class T>
  void add(std::span<const T> values) {
    add(std::uint64_t(values.size()));
    const auto bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void add(std::uint64_t value) { addNumber(value); }
  void add(double value) { addNumber(value); }
  std::vector<std::byte> bytes() && { return std::move(bytes_); }

 private:
  template <class T>
  void addNumber(T value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::byte> bytes_;
};

/// Past the end everything is zero and complete() false.
class StateReader {
 public:
  explicit StateReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  void take(std::uint64_t& value) { copy(&value, sizeof value); }
  void take(double& value) { copy(&value, sizeof value); }
  template <class T>
  void take(std::vector<T>& values) {
    std::uint64_t count = 0;
    take(count);
    if (count > bytes_.size() / sizeof(T)) {
      good_ = false;
      return;
    }
    values.resize(std::size_t(count));
    copy(static_cast<void*>(values.data()), std::size_t(count) * sizeof(T));
  }
  bool complete() const { return good_ && bytes_.empty(); }

 private:
  void copy(void* to, std::size_t size) {
    good_ = good_ && size <= bytes_.size();
    if (!good_ || size == 0) return;
    std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

}  // namespace coif::simulate
