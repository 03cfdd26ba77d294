// NumPy arrays of the Python faces: what they take, and views of what the core holds.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "frames.hpp"

namespace ghc::python {

namespace nb = nanobind;

using In1 = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using In2 = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using InOut1 = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using InOut2 = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using View = nb::ndarray<double, nb::numpy, nb::c_contig>;

// A view that keeps its owner alive; `values` must not be resized.
template <typename Values>
View view(const Values& values, std::initializer_list<size_t> shape, nb::handle owner) {
  return View(const_cast<double*>(values.data()), shape, owner);
}

inline View view(const Vector& values, nb::handle owner) {
  return view(values, {static_cast<size_t>(values.size())}, owner);
}

inline View view(const Matrix& values, nb::handle owner) {
  return view(values, {static_cast<size_t>(values.rows()), static_cast<size_t>(values.cols())},
              owner);
}

// Rotation above position (4, 3), Jacobian (6, n), velocity above drift (2, 6).
inline nb::tuple frame_views(const FrameTerms& terms, nb::handle owner) {
  return nb::make_tuple(view(terms.pose, {4, 3}, owner), view(terms.jacobian, owner),
                        view(terms.motion, {2, 6}, owner));
}

inline void expect(bool fits, const char* what) {
  if (!fits) throw nb::value_error(what);
}

}  // namespace ghc::python
