// NumPy arrays as the core reads and makes them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "problem.hpp"

namespace ghc {

namespace nb = nanobind;

// An argument that is mostly the same array from tick to tick: it is held, and looked at again
// only where it is another one. Arrays that are not float64 and C-contiguous are copied.
//
// The array itself is held, not an nb::ndarray of it: NumPy gives what that borrows back only while
// the interpreter runs, so that whoever owns the memory would outlive it.
class HeldArray {
 public:
  // Memory of an array of so many axes, none where it is None; ValueError for another array.
  View take(nb::handle given, size_t axes) {
    if (given.ptr() == object_.ptr() && axes == axes_) return view_;
    object_ = nb::object();
    copy_ = Array{};
    view_ = View{};
    if (given.is_none()) return view_;
    Array array;
    const bool as_it_is = nb::try_cast(given, array, false);
    if (!as_it_is && !nb::try_cast(given, array, true)) {
      throw nb::value_error("an array of numbers expected");
    }
    if (array.ndim() != axes) {
      throw nb::value_error("an array of another number of axes expected");
    }
    axes_ = axes;
    view_ = {array.data(), static_cast<Index>(array.shape(0)),
             axes == 2 ? static_cast<Index>(array.shape(1)) : Index{1}};
    if (as_it_is) {
      object_ = nb::borrow(given);
    } else {
      copy_ = array;
    }
    return view_;
  }

 private:
  using Array = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

  nb::object object_;
  Array copy_;
  size_t axes_ = 0;
  View view_;
};

// A new NumPy array: what it holds outlives the workspace.
inline nb::object new_array(const double* values, std::initializer_list<size_t> shape) {
  size_t size = 1;
  for (const size_t axis : shape) size *= axis;
  auto* memory = new double[size];
  for (size_t i = 0; i < size; ++i) memory[i] = values[i];
  nb::capsule owner(memory, [](void* kept) noexcept { delete[] static_cast<double*>(kept); });
  return nb::cast(nb::ndarray<double, nb::numpy, nb::c_contig>(memory, shape, owner));
}

inline nb::object new_vector(const View& view) {
  return new_array(view.data, {static_cast<size_t>(view.size())});
}

inline nb::object new_matrix(const View& view) {
  return new_array(view.data, {static_cast<size_t>(view.rows), static_cast<size_t>(view.cols)});
}

inline nb::object new_vector(const Vector& vector) {
  return new_array(vector.data(), {static_cast<size_t>(vector.size())});
}

inline nb::object new_matrix(const Matrix& matrix) {
  return new_array(matrix.data(),
                   {static_cast<size_t>(matrix.rows()), static_cast<size_t>(matrix.cols())});
}

}  // namespace ghc
