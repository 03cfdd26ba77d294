// ghc_controller.core.native: the Python face of the core.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "cascade.hpp"

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

// Sizes of the problem; nothing is read beyond the arrays that Python hands over.
void check_sizes(const ghc::Terms& t, ghc::Index m, ghc::Index targets, ghc::Index d) {
  const ghc::Index n = t.x_lower.size(), a = t.tau_lower.size(), c = t.center.size();
  const ghc::Index u = t.residual.size(), g = t.general_lower.size(), r = t.force_lower.size();
  check(targets == m, "as many targets as rows of the Jacobian expected");
  check(t.basis.rows() == 0 ? n == d : t.basis.rows() == n && t.basis.cols() == d &&
                                           t.offset.size() == n,
        "basis (n, d) and offset (n,) do not fit the box on accelerations");
  check(t.torque_matrix.rows() == a && t.torque_matrix.cols() == d &&
            t.torque_offset.size() == a &&
            (c == 0 || (t.torque_force.rows() == a && t.torque_force.cols() == c)),
        "torque terms (a, d), (a,) and (a, c) expected");
  check((u == 0 || (t.gain.rows() == c && t.gain.cols() == u)) &&
            (t.free.cols() == 0 || t.free.rows() == c),
        "force terms (c, u) and (c, q) expected");
  if (u) {
    check(t.balance_matrix.rows() == u && t.balance_matrix.cols() == d &&
              t.balance_force.rows() == u && t.balance_force.cols() == c,
          "balance (u, d) and (u, c) expected");
  }
  check(t.x_upper.size() == n && t.tau_upper.size() == a && t.general_upper.size() == g &&
            t.force_upper.size() == r,
        "upper bounds do not fit the lower ones");
  check(t.general.rows() == g && (g == 0 || t.general.cols() == n) && t.force_matrix.rows() == r &&
            (r == 0 || t.force_matrix.cols() == c),
        "rows (g, n) and (r, c) expected");
}

nb::tuple solve(ghc::Cascade& cascade, const Array2& jacobian, const Array1& target,
                const Array1& y, const Array2& basis, const Array1& offset,
                const Array2& torque_matrix, const Array1& torque_offset,
                const Array2& torque_force, const Array1& center, const Array2& gain,
                const Array2& free, const Array1& residual, const Array2& balance_matrix,
                const Array2& balance_force, const Array2& general, const Array2& force_matrix,
                const Array1& x_lower, const Array1& x_upper, const Array1& tau_lower,
                const Array1& tau_upper, const Array1& general_lower, const Array1& general_upper,
                const Array1& force_lower, const Array1& force_upper, double w, double e,
                bool bounded, ghc::Index of_qp, ghc::Index of_order) {
  const ghc::Terms terms{matrix(basis),         vector(offset),        matrix(torque_matrix),
                         vector(torque_offset), matrix(torque_force),  vector(center),
                         matrix(gain),          matrix(free),          vector(residual),
                         matrix(balance_matrix), matrix(balance_force), matrix(general),
                         matrix(force_matrix),  vector(x_lower),       vector(x_upper),
                         vector(tau_lower),     vector(tau_upper),     vector(general_lower),
                         vector(general_upper), vector(force_lower),   vector(force_upper)};
  const auto rows = matrix(jacobian);
  check_sizes(terms, rows.rows(), static_cast<ghc::Index>(target.size()), rows.cols());
  check(static_cast<ghc::Index>(y.size()) == rows.cols() && cascade.fits(rows.rows()),
        "y (d,) and a Jacobian with every row of the order expected");
  const ghc::Index answered =
      cascade.solve(rows, vector(target), vector(y), terms, {w, e}, {bounded, of_qp, of_order});
  if (answered == 0) {
    return nb::make_tuple(0, cascade.pivots(), cascade.qps(), 0.0, nb::none(), nb::none(),
                          nb::none());
  }
  return nb::make_tuple(answered, cascade.pivots(), cascade.qps(), cascade.violation(),
                        array(cascade.acceleration()), array(cascade.torque()),
                        array(cascade.force()));
}

nb::tuple level_optimum(const Array2& jacobian, const Array1& target, const Array1& y,
                        const ghc::NullSpace& above, double w) {
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
        self.append(given, e);
      })
      .def("projector", [](const ghc::NullSpace& self) { return array(self.projector()); });
  nb::class_<ghc::Cascade>(m, "Cascade")
      .def(nb::init<std::vector<std::int64_t>, std::vector<std::int64_t>>())
      .def("solve", &solve, "jacobian"_a, "target"_a, "y"_a, "basis"_a.none(), "offset"_a.none(),
           "torque_matrix"_a, "torque_offset"_a, "torque_force"_a.none(), "center"_a.none(),
           "gain"_a.none(), "free"_a.none(), "residual"_a.none(), "balance_matrix"_a.none(),
           "balance_force"_a.none(), "general"_a.none(), "force_matrix"_a.none(), "x_lower"_a,
           "x_upper"_a, "tau_lower"_a, "tau_upper"_a, "general_lower"_a.none(),
           "general_upper"_a.none(), "force_lower"_a.none(), "force_upper"_a.none(), "w"_a, "e"_a,
           "bounded"_a, "of_qp"_a, "of_order"_a)
      .def("forget", &ghc::Cascade::forget);
  m.def("level_optimum", &level_optimum);
  m.def("level_damping", [](const Array2& jacobian, const Array2& rows, const Array1& residual,
                            double w) {
    return ghc::level_damping(static_cast<ghc::Index>(jacobian.shape(0)),
                              matrix(jacobian).squaredNorm(), matrix(rows).squaredNorm(),
                              vector(residual).squaredNorm(), w);
  });
}
