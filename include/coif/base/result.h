// Errors that travel with the value: bad input is a Result, never an exception or an abort.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace coif {

enum class ErrorCode {
  InvalidArgument,  ///< a parameter is outside its stated range
  NotFound,         ///< a file, group or id that does not exist
  Unreadable,       ///< the file system refused: permissions, disk full, a directory
  Malformed,        ///< the bytes break their format
  Unsupported,      ///< well formed, but of a kind that Coif does not read
  Degenerate,       ///< geometry that cannot carry hair: zero area, non-manifold, not finite
  TooLarge,         ///< a stated count would exceed the memory or format limit
  Cancelled,        ///< the caller's Context asked to stop
};

/// One fault: what is wrong, in which file, and at which place of it.
struct Error {
  ErrorCode code = ErrorCode::InvalidArgument;
  std::string message;  ///< one sentence, without file and place
  std::string file;     ///< empty when no file is involved
  std::string place;    ///< "line 12", "byte 128", "face 7"; may be empty

  /// "file: place: message", leaving out what is empty.
  std::string text() const;
};

/// A value or an Error. value() of an error throws std::logic_error: test first.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return require(), std::get<0>(state_); }
  const T& value() const& { return require(), std::get<0>(state_); }
  T&& value() && { return require(), std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const { return std::get<1>(state_); }

 private:
  void require() const;
  std::variant<T, Error> state_;
};

[[noreturn]] void throwMissingValue(const Error& error);

template <class T>
void Result<T>::require() const {
  if (!ok()) throwMissingValue(error());
}

/// Success or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}
  bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};
using Status = Result<void>;

inline Error makeError(ErrorCode code, std::string message, std::string place = {}, std::string file = {}) {
  return Error{code, std::move(message), std::move(file), std::move(place)};
}

/// The same error with the file named, where it was not yet.
inline Error inFile(Error error, const std::string& file) {
  if (error.file.empty()) error.file = file;
  return error;
}

}  // namespace coif

/// Returns the error of `expression` from the enclosing function, or goes on.
#define COIF_TRY(expression)                                \
  do {                                                      \
    if (auto coifStatus = (expression); !coifStatus.ok()) { \
      return coifStatus.error();                            \
    }                                                       \
  } while (false)

#define COIF_CONCAT_(a, b) a##b
#define COIF_CONCAT(a, b) COIF_CONCAT_(a, b)
/// Binds `declaration` to the value of a Result, or returns its error: COIF_ASSIGN(auto mesh, load(path));
#define COIF_ASSIGN(declaration, expression) \
  COIF_ASSIGN_(declaration, expression, COIF_CONCAT(coifResult, __LINE__))
#define COIF_ASSIGN_(declaration, expression, result) \
  auto result = (expression);                         \
  if (!result.ok()) return result.error();            \
  declaration = std::move(result).value()
