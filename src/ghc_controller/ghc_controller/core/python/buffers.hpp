// NumPy arrays by the buffer protocol, for the time of one call.
//
// That takes 0.1 us an array; nb::ndarray goes through DLPack, which takes three times as long.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "matrix.hpp"

namespace ghc::python {

namespace nb = nanobind;

template <typename T>
struct Kind;
template <>
struct Kind<double> {
  static constexpr const char* name = "float64";
  static bool matches(char format) { return format == 'd'; }
};
template <>
struct Kind<std::int64_t> {
  static constexpr const char* name = "int64";
  static bool matches(char format) { return format == 'l' || format == 'q'; }
};
template <>
struct Kind<bool> {
  static constexpr const char* name = "bool";
  static bool matches(char format) { return format == '?'; }
};

inline void fits(bool holds, const char* expected) {
  if (!holds) throw std::invalid_argument(expected);
}

// A C-contiguous array of so many axes; another layout, alignment or type is copied, of an input.
template <typename T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() {
    if (held_) PyBuffer_Release(&buffer_);
  }

  void take(nb::handle given, int axes) {
    if (!fetch(given.ptr(), PyBUF_C_CONTIGUOUS | PyBUF_FORMAT)) {
      // Not `ascontiguousarray`, which leaves what is contiguous but not aligned, as part of a
      // received message may be.
      const nb::object make = nb::module_::import_("numpy").attr("array");
      copy_ = make(given, Kind<T>::name, nb::arg("order") = "C");
      if (!fetch(copy_.ptr(), PyBUF_C_CONTIGUOUS | PyBUF_FORMAT)) {
        throw std::invalid_argument("an array of numbers expected");
      }
    }
    fits(buffer_.ndim == axes, "an array of another number of axes expected");
  }

  void take_writable(nb::handle given, int axes) {
    if (!fetch(given.ptr(), PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | PyBUF_WRITABLE)) {
      throw std::invalid_argument("a writable C-contiguous array of the right type expected");
    }
    fits(buffer_.ndim == axes, "an array of another number of axes expected");
  }

  T* data() const { return static_cast<T*>(buffer_.buf); }
  Index shape(int axis) const { return static_cast<Index>(buffer_.shape[axis]); }
  Index size() const { return static_cast<Index>(buffer_.len / buffer_.itemsize); }

 private:
  bool fetch(PyObject* given, int flags) {
    if (PyObject_GetBuffer(given, &buffer_, flags) != 0) {
      PyErr_Clear();
      return false;
    }
    held_ = true;
    const char* format = buffer_.format;
    if (format && Kind<T>::matches(format[0]) && format[1] == '\0') return true;
    PyBuffer_Release(&buffer_);
    held_ = false;
    return false;
  }

  Py_buffer buffer_{};
  bool held_ = false;
  nb::object copy_;
};

// What every NumPy array begins with (PyArrayObject_fields in its ABI, since 1.0 and in 2.x).
struct ArrayFields {
  PyObject_HEAD
  char* data;
  int axes;
  Py_ssize_t* shape;
  Py_ssize_t* strides;
  PyObject* base;
  PyObject* type;  // of its numbers
  int flags;
};

// The fields of a NumPy array of float64 as the core reads them, C-contiguous and aligned; nullptr
// for any other object. The buffer protocol takes ten times as long: it writes the type as text.
inline const ArrayFields* array_fields(nb::handle array) {
  static PyObject* const kind =
      nb::module_::import_("numpy").attr("ndarray").inc_ref().ptr();  // for good
  static PyObject* const number =
      nb::module_::import_("numpy").attr("dtype")(Kind<double>::name).release().ptr();
  constexpr int kContiguous = 0x1, kAligned = 0x100;
  if (reinterpret_cast<PyObject*>(Py_TYPE(array.ptr())) != kind) return nullptr;
  const auto* fields = reinterpret_cast<const ArrayFields*>(array.ptr());
  const bool fits = fields->type == number && fields->flags & kContiguous &&
                    fields->flags & kAligned;
  return fits ? fields : nullptr;
}

// Memory of an array of `size` doubles one behind the other, which lives as long as the array;
// nullptr for any other object.
inline const double* memory_of(nb::handle array, Index size) {
  if (const ArrayFields* fields = array_fields(array)) {
    const bool fits = fields->axes == 1 && fields->shape[0] == size;
    return fits ? reinterpret_cast<const double*>(fields->data) : nullptr;
  }
  Py_buffer buffer;
  if (PyObject_GetBuffer(array.ptr(), &buffer, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
    PyErr_Clear();
    return nullptr;
  }
  const char* format = buffer.format;
  const bool fits = format && Kind<double>::matches(format[0]) && format[1] == '\0' &&
                    buffer.ndim == 1 && buffer.shape[0] == size;
  const auto* data = static_cast<const double*>(buffer.buf);
  PyBuffer_Release(&buffer);
  return fits ? data : nullptr;
}

// (r, c) or (r,) of numbers that are read; None is an array without entries.
struct In : Buffer<double> {
  In(nb::handle given, int axes) : axes_(axes) {
    if (!given.is_none()) take(given, axes);
    given_ = !given.is_none();
  }
  bool given() const { return given_; }
  Index rows() const { return given_ ? shape(0) : 0; }
  Index cols() const { return !given_ ? 0 : axes_ == 1 ? 1 : shape(1); }
  Index entries() const { return given_ ? size() : 0; }
  ConstMatrix matrix() const { return {given_ ? data() : nullptr, rows(), cols()}; }
  ConstVector vector() const { return {given_ ? data() : nullptr, entries()}; }

 private:
  int axes_;
  bool given_ = false;
};

// PyArray_New of NumPy's table of functions for C, whose places stay where they are from version to
// version. `numpy.empty` takes twice as long.
inline auto array_maker() {
  using Maker = PyObject* (*)(PyTypeObject*, int, const Py_ssize_t*, int, const Py_ssize_t*, void*,
                              int, int, PyObject*);
  constexpr int kPlace = 93;
  static const Maker maker = []() -> Maker {
    const nb::module_ numpy = nb::module_::import_("numpy");
    const char* const core = nb::hasattr(numpy, "_core") ? "numpy._core.multiarray"
                                                         : "numpy.core.multiarray";
    const nb::object table = nb::module_::import_(core).attr("_ARRAY_API");
    auto* functions = static_cast<void**>(PyCapsule_GetPointer(table.ptr(), nullptr));
    if (!functions) throw nb::python_error();
    return reinterpret_cast<Maker>(functions[kPlace]);
  }();
  return maker;
}

// A new array.
class NewArray {
 public:
  explicit NewArray(Index size) : NewArray(1, {1, size, 1}, size) {}
  NewArray(Index rows, Index cols) : NewArray(2, {1, rows, cols}, rows, cols) {}
  NewArray(Index blocks, Index rows, Index cols)
      : NewArray(3, {blocks, rows, cols}, blocks, rows, cols) {}

  double* data() const { return data_; }
  Eigen::Map<Vector> vector() const { return {data_, shape_[0] * shape_[1] * shape_[2]}; }
  Eigen::Map<Matrix> matrix() const { return {data_, shape_[1], shape_[2]}; }
  const nb::object& object() const { return array_; }

 private:
  template <typename... Sizes>
  NewArray(int axes, std::array<Index, 3> shape, Sizes... given) : shape_(shape) {
    constexpr int kNumber = 12;  // NPY_DOUBLE
    static PyObject* const kind =
        nb::module_::import_("numpy").attr("ndarray").inc_ref().ptr();  // for good
    const Py_ssize_t sizes[] = {static_cast<Py_ssize_t>(given)...};
    array_ = nb::steal(array_maker()(reinterpret_cast<PyTypeObject*>(kind), axes, sizes, kNumber,
                                     nullptr, nullptr, 0, 0, nullptr));
    if (!array_.is_valid()) throw nb::python_error();
    data_ = reinterpret_cast<double*>(
        reinterpret_cast<const ArrayFields*>(array_.ptr())->data);
  }

  nb::object array_;
  std::array<Index, 3> shape_;
  double* data_ = nullptr;
};

inline nb::object new_array_of(const Eigen::Ref<const Vector>& values) {
  const NewArray made(values.size());
  made.vector() = values;
  return made.object();
}

}  // namespace ghc::python
