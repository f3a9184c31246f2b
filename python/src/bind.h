// What the binding units share: one function a room, errors, arrays in and out, long computations.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <atomic>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/report.h"
#include "coif/base/result.h"
#include "coif/base/vec.h"

namespace coif::python {

namespace nb = nanobind;

void bindBase(nb::module_& m);
void bindScalp(nb::module_& m);
void bindHairMesh(nb::module_& m);
void bindPlace(nb::module_& m);
void bindStrands(nb::module_& m);
void bindScene(nb::module_& m);
void bindEditor(nb::module_& m);
void bindLight(nb::module_& m);
void bindPreview(nb::module_& m);

/// A coif::Error on its way to Python, where it becomes coif.Error (bindBase registers the translator).
struct ErrorException : std::exception {
  explicit ErrorException(Error e) : error(std::move(e)), text(error.text()) {}
  const char* what() const noexcept override { return text.c_str(); }
  Error error;
  std::string text;
};

template <class T>
T take(Result<T> result) {
  if (!result.ok()) throw ErrorException(result.error());
  return std::move(result).value();
}
inline void take(Status status) {
  if (!status.ok()) throw ErrorException(status.error());
}

// ---- arrays in
// -------------------------------------------------------------------------------------------------

/// Any object that NumPy turns into an array. Conversion happens in the functions below, which name the
/// argument in their ValueError.
struct ArrayLike {
  nb::object object;
};

template <class T>
using InputArray = nb::ndarray<nb::numpy, const T, nb::c_contig, nb::device::cpu>;

/// The argument as a contiguous array of T with the given shape (-1: any length). ValueError otherwise.
template <class T>
InputArray<T> toArray(const ArrayLike& value, const char* argument, std::initializer_list<int> shape);

std::vector<Vec3> toPoints(const ArrayLike& value, const char* argument);  ///< shape (N, 3)
Vec3 toVec3(const ArrayLike& value, const char* argument);                 ///< shape (3,)

std::vector<std::uint32_t> toIndices(const ArrayLike& value,
                                     const char* argument);  ///< shape (N,), all in range

/// Faces as a sequence of index sequences, or an F×k integer array: offsets (F + 1) and corners.
struct Faces {
  std::vector<std::uint32_t> offsets{0};
  std::vector<std::uint32_t> corners;
};
Faces toFaces(nb::handle value, const char* argument);

// ---- arrays out
// ------------------------------------------------------------------------------------------------

template <class T>
using Array1 = nb::ndarray<nb::numpy, T, nb::ndim<1>, nb::c_contig>;
template <class T>
using Array2 = nb::ndarray<nb::numpy, T, nb::shape<-1, 2>, nb::c_contig>;
template <class T>
using Array3 = nb::ndarray<nb::numpy, T, nb::shape<-1, 3>, nb::c_contig>;

/// A view of `count` values inside `owner`, which the array keeps alive. No copy.
template <class T>
Array1<T> view1(nb::handle owner, T* data, std::size_t count) {
  static std::remove_const_t<T> none{};
  return Array1<T>(count ? data : &none, {count}, owner);
}
template <class T>
Array3<T> view3(nb::handle owner, T* data, std::size_t rows) {
  static std::remove_const_t<T> none{};
  return Array3<T>(rows ? data : &none, {rows, 3}, owner);
}
template <class T>
Array2<T> view2(nb::handle owner, T* data, std::size_t rows) {
  static std::remove_const_t<T> none{};
  return Array2<T>(rows ? data : &none, {rows, 2}, owner);
}

/// An array that owns the vector it was made from.
template <class T>
Array1<T> own1(std::vector<T> values) {
  auto* kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return view1<T>(owner, kept->data(), kept->size());
}
inline Array3<double> own3(std::vector<Vec3> values) {
  auto* kept = new std::vector<Vec3>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Vec3>*>(p); });
  return view3<double>(owner, kept->empty() ? nullptr : kept->front().data(), kept->size());
}
inline Array1<double> own(const Vec3& v) {
  return own1<double>({v.x(), v.y(), v.z()});
}

// ---- long computations
// -----------------------------------------------------------------------------------------

/// Runs a computation without the interpreter lock. Its Context reports to `progress` (a callable or None)
/// and stops on Ctrl-C or when the callable raises; that exception then reaches the caller.
class Run {
 public:
  Run(int threads, nb::object progress);

  template <class Compute>
  auto operator()(Compute&& compute) {
    auto result = [&] {
      nb::gil_scoped_release unlocked;
      return compute(static_cast<const Context&>(context_));
    }();
    rethrow();
    return take(std::move(result));
  }

 private:
  void report(std::string_view what, double fraction);
  void rethrow();

  Context context_;
  nb::object progress_;
  std::atomic<bool> cancel_{false};
  std::optional<nb::python_error> failure_;
};

}  // namespace coif::python

NAMESPACE_BEGIN(NB_NAMESPACE)
NAMESPACE_BEGIN(detail)
template <>
struct type_caster<coif::python::ArrayLike> {
  NB_TYPE_CASTER(coif::python::ArrayLike, const_name("numpy.typing.ArrayLike"))
  bool from_python(handle src, uint8_t, cleanup_list*) noexcept {
    if (src.is_none()) return false;
    value.object = borrow(src);
    return true;
  }
};
NAMESPACE_END(detail)
NAMESPACE_END(NB_NAMESPACE)
