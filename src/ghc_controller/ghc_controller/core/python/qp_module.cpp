// The Python face of QPs: their rows, solver and residuals, and the checks of an answer.
#include <algorithm>

#include "buffers.hpp"
#include "compare_modules.hpp"
#include "dual_method.hpp"
#include "qp_rows.hpp"
#include "residuals.hpp"

namespace ghc::python {
namespace {

nb::handle entry(const nb::tuple& given, size_t index) { return given[index]; }

// One bound (r,) on each side of r values.
struct GivenBounds {
  In lower, upper;

  GivenBounds(nb::handle low, nb::handle high, Index size) : lower(low, 1), upper(high, 1) {
    fits(lower.entries() == size && upper.entries() == size, "as many bounds as values expected");
  }
  bool hold(const Eigen::Ref<const Vector>& value) const {
    return is_inside(value, lower.vector(), upper.vector());
  }
  double excess(const Eigen::Ref<const Vector>& value) const {
    return largest_excess(value, lower.vector(), upper.vector());
  }
};

nb::tuple rows_of(nb::handle basis, nb::handle offset, nb::tuple parametrization,
                  nb::handle x_lower, nb::handle x_upper, nb::handle general, Index soft,
                  nb::handle contacts, nb::handle torque_matrix, nb::handle torque_offset,
                  nb::handle torque_force, nb::handle tau_lower, nb::handle tau_upper) {
  fits(parametrization.size() >= 4, "a parametrization expected");
  const nb::tuple none = nb::make_tuple(nb::none(), nb::none(), nb::none(), nb::none(), nb::none(),
                                        nb::none());
  const nb::tuple g = general.is_none() ? none : nb::cast<nb::tuple>(general);
  const nb::tuple c = contacts.is_none() ? none : nb::cast<nb::tuple>(contacts);
  fits(g.size() >= 5 && c.size() >= 6, "AccelerationRows and ContactRows, or None, expected");
  const In Z(basis, 2), x_c(offset, 1), y0(entry(parametrization, 0), 1),
      F(entry(parametrization, 1), 2), f0(entry(parametrization, 2), 1),
      G(entry(parametrization, 3), 2), low(x_lower, 1), high(x_upper, 1), rows(entry(g, 0), 2),
      rows_low(entry(g, 1), 1), rows_high(entry(g, 2), 1), rows_force(entry(g, 4), 2),
      forces(entry(c, 3), 2), forces_low(entry(c, 4), 1), forces_high(entry(c, 5), 1),
      T(torque_matrix, 2), t(torque_offset, 1), T_f(torque_force, 2), tau_low(tau_lower, 1),
      tau_high(tau_upper, 1);
  const QpRowParts parts{Z.given() && x_c.given(),
                         Z.matrix(),        x_c.vector(),       y0.vector(),
                         f0.vector(),       F.matrix(),         G.matrix(),
                         low.vector(),      high.vector(),      rows.matrix(),
                         rows_force.matrix(), rows_low.vector(), rows_high.vector(),
                         soft,              forces.matrix(),    forces_low.vector(),
                         forces_high.vector(), T.matrix(),      T_f.matrix(),
                         t.vector(),        tau_low.vector(),   tau_high.vector()};
  parts.check();
  const Index count = parts.count();
  const NewArray out(count, F.cols()), lower(count), upper(count), norm(count);
  write_qp_rows(parts, out.matrix(), lower.vector(), upper.vector(), norm.vector());
  return nb::make_tuple(out.object(), lower.object(), upper.object(), norm.object());
}

bool inside(nb::handle value, nb::handle lower, nb::handle upper) {
  const In v(value, 1);
  return GivenBounds(lower, upper, v.entries()).hold(v.vector());
}

double excess_of(nb::handle value, nb::handle lower, nb::handle upper) {
  const In v(value, 1);
  return GivenBounds(lower, upper, v.entries()).excess(v.vector());
}

bool rows_inside(nb::handle matrix, nb::handle x, nb::handle lower, nb::handle upper) {
  const In rows(matrix, 2), at(x, 1);
  fits(rows.cols() == at.entries(), "rows (r, n) and x (n,) expected");
  const GivenBounds bounds(lower, upper, rows.rows());
  return bounds.hold(rows.matrix() * at.vector());
}

nb::tuple torques_inside(nb::handle x, nb::handle matrix, nb::handle offset, nb::handle lower,
                         nb::handle upper, nb::handle tau_lower, nb::handle tau_upper) {
  const In at(x, 1), M(matrix, 2), h(offset, 1);
  fits(M.cols() == at.entries() && M.rows() == h.entries(), "x (d,), M (a, d), h (a,) expected");
  const GivenBounds box(lower, upper, at.entries()), torque(tau_lower, tau_upper, h.entries());
  const NewArray tau(h.entries());
  tau.vector() = h.vector();
  tau.vector().noalias() += M.matrix() * at.vector();
  return nb::make_tuple(box.hold(at.vector()) && torque.hold(tau.vector()), tau.object());
}

nb::tuple answer_in_contact(nb::handle y, nb::handle force, nb::handle offset, nb::handle basis,
                            nb::handle torque_matrix, nb::handle torque_offset,
                            nb::handle torque_force) {
  const In at(y, 1), f(force, 1), x_c(offset, 1), Z(basis, 2), T(torque_matrix, 2),
      t(torque_offset, 1), T_f(torque_force, 2);
  fits(Z.rows() == x_c.entries() && Z.cols() == at.entries() && T.rows() == t.entries() &&
           T.cols() == at.entries() && T_f.rows() == t.entries() && T_f.cols() == f.entries(),
       "the arrays of a ReducedProblem expected");
  const NewArray x(x_c.entries()), tau(t.entries());
  x.vector() = x_c.vector();
  x.vector().noalias() += Z.matrix() * at.vector();
  tau.vector() = t.vector();
  tau.vector().noalias() += T.matrix() * at.vector();
  tau.vector().noalias() += T_f.matrix() * f.vector();
  return nb::make_tuple(x.object(), tau.object());
}

double violation_of_boxes(nb::handle mass_matrix, nb::handle bias, nb::handle x, nb::handle tau,
                          nb::handle push, nb::handle lower, nb::handle upper,
                          nb::handle tau_lower, nb::handle tau_upper) {
  const In M(mass_matrix, 2), h(bias, 1), at(x, 1), torque(tau, 1), J_f_f(push, 1);
  const Index n = h.entries(), a = torque.entries();
  fits(M.rows() == n && M.cols() == n && at.entries() == n && a <= n &&
           (!J_f_f.given() || J_f_f.entries() == n),
       "M (n, n), h (n,), x (n,), tau (a,) and a push (n,) or None expected");
  const GivenBounds box(lower, upper, n), limits(tau_lower, tau_upper, a);
  Vector missing = h.vector();
  missing.noalias() += M.matrix() * at.vector();
  missing.tail(a) -= torque.vector();
  if (J_f_f.given()) missing -= J_f_f.vector();
  const Vector nothing = Vector::Zero(n);
  const ConstVector zero(nothing.data(), n);
  return std::max({box.excess(at.vector()), limits.excess(torque.vector()),
                   largest_excess(missing, zero, zero)});
}

// The arrays of a QpProblem.
class GivenQp {
 public:
  GivenQp(nb::handle H, nb::handle g, nb::handle A, nb::handle b, nb::handle C, nb::handle l,
          nb::handle u)
      : H_(H, 2), g_(g, 1), A_(A, 2), b_(b, 1), C_(C, 2), l_(l, 1), u_(u, 1),
        qp_{H_.matrix(), g_.vector(), A_.matrix(), b_.vector(),
            C_.matrix(), l_.vector(), u_.vector()} {
    qp_.check();
  }
  const Qp& qp() const { return qp_; }

 private:
  In H_, g_, A_, b_, C_, l_, u_;
  Qp qp_;
};

int not_finite(nb::handle H, nb::handle g, nb::handle A, nb::handle b, nb::handle C, nb::handle l,
               nb::handle u) {
  return GivenQp(H, g, A, b, C, l, u).qp().not_finite();
}

nb::tuple residuals_of(nb::handle H, nb::handle g, nb::handle A, nb::handle b, nb::handle C,
                       nb::handle l, nb::handle u, nb::handle x, nb::handle y, nb::handle z,
                       nb::handle units) {
  const GivenQp given(H, g, A, b, C, l, u);
  const In at(x, 1), of_equalities(y, 1), of_rows(z, 1), of_units(units, 1);
  const Qp& qp = given.qp();
  const Index r = qp.lower.size();
  fits(at.entries() == qp.linear.size() && of_equalities.entries() == qp.right.size() &&
           of_rows.entries() == r && (!of_units.given() || of_units.entries() == r),
       "x (n,), y (e,), z (r,) and units (r,) expected");
  Vector ones;
  if (!of_units.given()) ones.setOnes(r);
  const Residuals out =
      kkt_residuals(qp, at.vector(), of_equalities.vector(), of_rows.vector(),
                    of_units.given() ? of_units.vector() : ConstVector(ones.data(), r));
  return nb::make_tuple(out.primal, out.dual, out.complementarity, out.size, out.terms);
}

nb::tuple solve_dual(nb::handle H, nb::handle g, nb::handle A, nb::handle b, nb::handle C,
                     nb::handle l, nb::handle u, Index limit) {
  const GivenQp given(H, g, A, b, C, l, u);
  DualMethod method;
  const DualEnd end = method.solve(given.qp(), limit);
  return nb::make_tuple(static_cast<int>(end), method.pivots(), new_array_of(method.x()),
                        new_array_of(method.y()), new_array_of(method.z()));
}

}  // namespace

void bind_qp(nb::module_& m) {
  const auto some = nb::arg();
  const auto maybe = nb::arg().none();
  m.def("qp_rows", &rows_of, maybe, maybe, some, some, some, maybe, some, maybe, some, some, some,
        some, some);
  m.def("is_inside", &inside);
  m.def("largest_excess", &excess_of);
  m.def("rows_inside", &rows_inside);
  m.def("torques_inside", &torques_inside);
  m.def("contact_answer", &answer_in_contact);
  m.def("box_violation", &violation_of_boxes, some, some, some, some, maybe, some, some, some,
        some);
  m.def("qp_not_finite", &not_finite);
  m.def("kkt_residuals", &residuals_of, some, some, some, some, some, some, some, some, some, some,
        maybe);
  m.def("solve_dual", &solve_dual);
}

}  // namespace ghc::python
