// ghc_controller.core.native: the Python face of the core.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "build_modules.hpp"
#include "compare_modules.hpp"
#include "level.hpp"
#include "null_space.hpp"
#include "solve_module.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Array1 = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Array2 = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using NewArray = nb::ndarray<double, nb::numpy, nb::c_contig>;

// None stands for an array without entries.
ghc::ConstMatrix matrix(const Array2& a) {
  if (!a.is_valid()) return {nullptr, 0, 0};
  return {a.data(), static_cast<ghc::Index>(a.shape(0)), static_cast<ghc::Index>(a.shape(1))};
}

ghc::ConstVector vector(const Array1& a) {
  if (!a.is_valid()) return {nullptr, 0};
  return {a.data(), static_cast<ghc::Index>(a.size())};
}

// A new NumPy array: what it holds outlives the workspace.
template <typename Values>
NewArray array(const Values& values, std::initializer_list<size_t> shape) {
  auto* memory = new double[values.size()];
  ghc::Index i = 0;
  for (ghc::Index r = 0; r < values.rows(); ++r) {
    for (ghc::Index c = 0; c < values.cols(); ++c) memory[i++] = values(r, c);
  }
  nb::capsule owner(memory, [](void* kept) noexcept { delete[] static_cast<double*>(kept); });
  return NewArray(memory, shape, owner);
}

NewArray array(const ghc::Vector& v) { return array(v, {static_cast<size_t>(v.size())}); }

NewArray array(const ghc::Matrix& m) {
  return array(m, {static_cast<size_t>(m.rows()), static_cast<size_t>(m.cols())});
}

void check(bool fits, const char* what) {
  if (!fits) throw nb::value_error(what);
}

nb::tuple level_optimum(const Array2& jacobian, const Array1& target, const Array1& y,
                        ghc::NullSpace& above, double w) {
  const auto m = jacobian.shape(0), d = jacobian.shape(1);
  check(target.size() == m && y.size() == d && above.dimension() == static_cast<ghc::Index>(d),
        "rows (m, d), target (m,), y (d,) and a null space of d directions expected");
  ghc::Level level;
  level.solve(matrix(jacobian), vector(target), vector(y), above, w);
  return nb::make_tuple(array(level.optimum()), array(level.rows()), level.damping());
}

}  // namespace

NB_MODULE(native, m) {
  // Blocks of large products follow the caches that Eigen finds, and sums follow the blocks:
  // fixed sizes give the same digits on every machine.
  Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 2 << 20);
  ghc::python::bind_model(m);
  ghc::python::bind_tasks(m);
  ghc::python::bind_bodies(m);
  ghc::python::bind_boxes(m);
  ghc::python::bind_contacts(m);
  ghc::python::bind_formulations(m);
  ghc::python::bind_qp(m);
  ghc::python::bind_motions(m);
  ghc::python::bind_plans(m);
  nb::class_<ghc::NullSpace>(m, "NullSpace")
      .def("__init__",
           [](ghc::NullSpace* self, ghc::Index d, ghc::Index capacity) {
             check(d >= 0 && capacity >= 0, "d and capacity expected, at least 0");
             new (self) ghc::NullSpace();
             self->reset(d, capacity);
           })
      .def("append", [](ghc::NullSpace& self, const Array2& rows, double e) {
        const auto given = matrix(rows);
        check(given.cols() == self.dimension() && given.rows() <= self.left(),
              "rows of d entries expected, no more than the capacity");
        ghc::Matrix projected;
        self.project_rows(given, projected);
        self.append(given, projected, e);
      })
      .def("projector", [](const ghc::NullSpace& self) { return array(self.projector()); });
  ghc::bind_solve(m);
  ghc::bind_step(m);
  m.def("level_optimum", &level_optimum);
  m.def("level_damping", [](const Array2& jacobian, const Array2& rows, const Array1& residual,
                            double w) {
    return ghc::level_damping(static_cast<ghc::Index>(jacobian.shape(0)),
                              matrix(jacobian).squaredNorm(), matrix(rows).squaredNorm(),
                              vector(residual).squaredNorm(), w);
  });
}
