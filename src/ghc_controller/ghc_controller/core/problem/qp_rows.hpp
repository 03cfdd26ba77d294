// Rows of the bounded QP on the variables s of an affine parametrization of (x, f), and checks of
// answers against the bounds.
//
// n accelerations x = offset + basis y, d reduced ones y = y0 + F s, c contact forces f = f0 + G s,
// a joints, p variables s, g general rows on x and f, r rows on f.
#pragma once

#include "matrix.hpp"

namespace ghc {

struct QpRowParts {
  bool in_contact;      // false: x = y, without basis and offset
  ConstMatrix basis;    // (n, d)
  ConstVector offset;   // (n,)
  ConstVector y0, f0;   // (d,), (c,)
  ConstMatrix factor, force_factor;  // F (d, p), G (c, p)
  ConstVector x_lower, x_upper;      // (n,)
  ConstMatrix general, general_force;         // (g, n); (g, c), empty: the rows are on x alone
  ConstVector general_lower, general_upper;   // (g,)
  Index soft;                                 // the first general ones, which come before forces
  ConstMatrix force_matrix;                   // (r, c)
  ConstVector force_lower, force_upper;       // (r,)
  ConstMatrix torque_matrix, torque_force;    // (a, d), (a, c)
  ConstVector torque_offset;                  // (a,): tau = T y + t + T_f f
  ConstVector tau_lower, tau_upper;           // (a,)

  // Throws std::invalid_argument where sizes do not fit together.
  void check() const;
  Index count() const;
};

// Normalized rows (count, p) on s, their bounds and the norms that they were divided by. In this
// order: accelerations, soft general ones, forces, torques, the other general ones.
void write_qp_rows(const QpRowParts& parts, Eigen::Ref<Matrix> rows, Eigen::Ref<Vector> lower,
                   Eigen::Ref<Vector> upper, Eigen::Ref<Vector> norm);

// Whether every entry lies between its bounds; false for NaN.
bool is_inside(const Eigen::Ref<const Vector>& value, const ConstVector& lower,
               const ConstVector& upper);

// Largest distance of an entry from its bounds, at least 0; inf where an entry is not finite.
double largest_excess(const Eigen::Ref<const Vector>& value, const ConstVector& lower,
                      const ConstVector& upper);

}  // namespace ghc
