// Errors, reports, and the conversions that every other binding unit uses.
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <limits>

#include "bind.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif::python {

namespace {

nb::handle errorClass;  // borrowed from the module, which lives as long as the interpreter
nb::handle argumentClass;
nb::handle missingClass;

void raiseError(const Error& error) {
  nb::handle type = errorClass;
  if (error.code == ErrorCode::InvalidArgument) type = argumentClass;
  if (error.code == ErrorCode::NotFound && !error.file.empty()) type = missingClass;
  const nb::object raised = type(error.text(), error.code, error.message, error.file, error.place);
  PyErr_SetObject(type.ptr(), raised.ptr());
}

void bindErrors(nb::module_& m) {
  nb::enum_<ErrorCode>(m, "ErrorCode", "The kinds of fault that coif.Error carries.")
      .value("INVALID_ARGUMENT", ErrorCode::InvalidArgument, "a parameter is outside its stated range")
      .value("NOT_FOUND", ErrorCode::NotFound, "a file, group or id that does not exist")
      .value("UNREADABLE", ErrorCode::Unreadable,
             "the file system refused: permissions, disk full, a directory")
      .value("MALFORMED", ErrorCode::Malformed, "the bytes break their format")
      .value("UNSUPPORTED", ErrorCode::Unsupported, "well formed, but of a kind that Coif does not read")
      .value("DEGENERATE", ErrorCode::Degenerate, "geometry that cannot carry hair")
      .value("TOO_LARGE", ErrorCode::TooLarge, "a stated count would exceed the memory or format limit")
      .value("CANCELLED", ErrorCode::Cancelled, "the caller asked to stop");

  const nb::module_ errors = nb::module_::import_("coif._errors");
  for (const char* name : {"Error", "ArgumentError", "MissingFileError"}) m.attr(name) = errors.attr(name);
  errorClass = m.attr("Error");
  argumentClass = m.attr("ArgumentError");
  missingClass = m.attr("MissingFileError");
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const ErrorException& e) {
      raiseError(e.error);
    }
  });
}

/// str(object).
std::string textOf(nb::handle object) {
  return nb::str(object).c_str();
}

std::string shapeText(std::initializer_list<int> shape) {
  std::string text = "(";
  for (const int n : shape) text += (text.size() > 1 ? ", " : "") + (n < 0 ? "N" : std::to_string(n));
  return text + (shape.size() == 1 ? ",)" : ")");
}

template <class T>
constexpr const char* kTypeName = nullptr;
template <>
constexpr const char* kTypeName<double> = "float64";
template <>
constexpr const char* kTypeName<float> = "float32";
template <>
constexpr const char* kTypeName<std::int64_t> = "int64";
template <>
constexpr const char* kTypeName<std::uint64_t> = "uint64";

/// `value` as a NumPy array of T, or a ValueError (TypeError for fractions as indices) that names the
/// argument.
template <class T>
nb::object asNumpy(const ArrayLike& value, const char* argument) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  try {
    nb::object array = numpy.attr("asarray")(value.object);
    const bool numeric =
        std::string("biuf").find(nb::cast<char>(array.attr("dtype").attr("kind"))) != std::string::npos;
    const bool fraction = nb::cast<char>(array.attr("dtype").attr("kind")) == 'f';
    if (!numeric || (std::is_integral_v<T> && fraction && nb::cast<std::size_t>(array.attr("size")) > 0)) {
      const std::string message = std::string(argument) + ": expected numbers" +
                                  (std::is_integral_v<T> ? " that are integers" : "") + ", got an array of " +
                                  textOf(nb::object(array.attr("dtype")));
      throw nb::type_error(message.c_str());
    }
    return numpy.attr("asarray")(array, nb::arg("dtype") = kTypeName<T>, nb::arg("order") = "C");
  } catch (nb::python_error& e) {
    if (!e.matches(PyExc_ValueError) && !e.matches(PyExc_TypeError) && !e.matches(PyExc_OverflowError)) throw;
    throw nb::value_error((std::string(argument) + ": " + textOf(e.value())).c_str());
  }
}

}  // namespace

template <class T>
InputArray<T> toArray(const ArrayLike& value, const char* argument, std::initializer_list<int> shape) {
  const nb::object array = asNumpy<T>(value, argument);
  const nb::tuple found = nb::cast<nb::tuple>(array.attr("shape"));
  bool fits = found.size() == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) {
    const int wanted = shape.begin()[i];
    fits = wanted < 0 || nb::cast<std::int64_t>(found[i]) == wanted;
  }
  if (!fits) {
    const std::string message =
        std::string(argument) + ": expected an array of shape " + shapeText(shape) + ", got " + textOf(found);
    throw nb::value_error(message.c_str());
  }
  return nb::cast<InputArray<T>>(array);
}

template InputArray<double> toArray(const ArrayLike&, const char*, std::initializer_list<int>);
template InputArray<float> toArray(const ArrayLike&, const char*, std::initializer_list<int>);
template InputArray<std::int64_t> toArray(const ArrayLike&, const char*, std::initializer_list<int>);
template InputArray<std::uint64_t> toArray(const ArrayLike&, const char*, std::initializer_list<int>);

std::vector<Vec3> toPoints(const ArrayLike& value, const char* argument) {
  const auto array = toArray<double>(value, argument, {-1, 3});
  std::vector<Vec3> points(array.shape(0));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Map<const Vec3>(array.data() + 3 * i);
  return points;
}

Vec3 toVec3(const ArrayLike& value, const char* argument) {
  const auto array = toArray<double>(value, argument, {3});
  return Eigen::Map<const Vec3>(array.data());
}

std::vector<std::uint32_t> toIndices(const ArrayLike& value, const char* argument) {
  const auto array = toArray<std::int64_t>(value, argument, {-1});
  std::vector<std::uint32_t> indices(array.shape(0));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::int64_t index = array.data()[i];
    if (index < 0 || index >= std::int64_t{kNone}) {
      throw nb::value_error((std::string(argument) + ": " + std::to_string(index) + " is no index").c_str());
    }
    indices[i] = std::uint32_t(index);
  }
  return indices;
}

Faces toFaces(nb::handle value, const char* argument) {
  Faces faces;
  for (const nb::handle face : nb::iter(value)) {
    const auto corners = toIndices(ArrayLike{nb::borrow(face)}, argument);
    faces.corners.insert(faces.corners.end(), corners.begin(), corners.end());
    faces.offsets.push_back(std::uint32_t(faces.corners.size()));
  }
  return faces;
}

Run::Run(int threads, nb::object progress) : progress_(std::move(progress)) {
  context_.threads = threads;
  context_.cancel = &cancel_;
  context_.progress = [this](std::string_view what, double fraction) { report(what, fraction); };
}

void Run::report(std::string_view what, double fraction) {
  const nb::gil_scoped_acquire locked;
  if (failure_) return;
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress_.is_none()) progress_(what, fraction);
  } catch (nb::python_error& e) {
    failure_.emplace(std::move(e));
    cancel_ = true;
  }
}

void Run::rethrow() {
  if (failure_) throw std::move(*failure_);
}

namespace {

void bindReports(nb::module_& m) {
  nb::enum_<StageState>(m, "StageState", "What a stage did.")
      .value("RAN", StageState::Ran, "computed anew")
      .value("REUSED", StageState::Reused, "its inputs had not changed")
      .value("SKIPPED", StageState::Skipped, "its result was not needed");
  nb::class_<ErrorEstimate>(m, "ErrorEstimate", "An error with its unit and how it was estimated.")
      .def_ro("value", &ErrorEstimate::value, "The error; negative: none is claimed.")
      .def_ro("unit", &ErrorEstimate::unit, "For example 'of the bounding box'.")
      .def_ro("method", &ErrorEstimate::method, "How it was estimated.")
      .def("__repr__", [](const ErrorEstimate& e) {
        return e.value < 0 ? std::string("<coif.ErrorEstimate: none claimed>")
                           : "<coif.ErrorEstimate: " + std::to_string(e.value) + " " + e.unit + ">";
      });
  nb::class_<LeftOut>(m, "LeftOut", "Work that a scene did not need.")
      .def_ro("what", &LeftOut::what, "What was left out.")
      .def_ro("switch", &LeftOut::control, "The setting that has a say in it.")
      .def_ro("trigger", &LeftOut::trigger, "Why it could be left out.")
      .def_ro("share", &LeftOut::share, "How much of `of` was left out, 0 to 1.")
      .def_ro("of", &LeftOut::of, "What `share` is a part of.")
      .def("__repr__", [](const LeftOut& l) { return "<coif.LeftOut: " + l.what + " (" + l.control + ")>"; });
  nb::class_<StageReport>(m, "StageReport", "What one stage of an evaluation says of itself.")
      .def_ro("name", &StageReport::name, "Name of the stage.")
      .def_ro("state", &StageReport::state, "Ran, reused or skipped.")
      .def_ro("reason", &StageReport::reason, "Why it ran, was reused or was skipped.")
      .def_ro("seconds", &StageReport::seconds, "Wall-clock seconds.")
      .def_ro("bytes", &StageReport::bytes, "Size of its result in bytes.")
      .def_ro("error", &StageReport::error, "Its error estimate.")
      .def_ro("left_out", &StageReport::leftOut, "What it did not need: a list of LeftOut.")
      .def_ro("notes", &StageReport::notes, "Counts and warnings, a sentence each.")
      .def("__repr__", [](const StageReport& r) {
        return "<coif.StageReport: " + r.name + " " + name(r.state) + " (" + r.reason + ")>";
      });
  nb::enum_<UpAxis>(m, "UpAxis", "Which axis points up.")
      .value("Y", UpAxis::Y, "y is up")
      .value("Z", UpAxis::Z, "z is up");
}

}  // namespace

void bindBase(nb::module_& m) {
  bindErrors(m);
  bindReports(m);
  m.attr("__version__") = COIF_VERSION;
}

}  // namespace coif::python
