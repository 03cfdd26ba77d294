// The control problem of one tick, as arrays that Python hands over (problem/control_problem.py).
//
// M x + h = [0; tau] + J_f^T f with the first u coordinates unactuated; contacts keep J_c x = drift
// target. Rows on forces: first the bounds of normal forces, then what friction can hold.
#pragma once

#include <vector>

#include "matrix.hpp"

namespace ghc {

// Cost on contact forces: 1/2 (f - f_0)^T H_f (f - f_0).
struct ForceExpansion {
  View center, factor;  // f_0 (c,), F (c, c) with F F^T = H_f^-1
};

struct Problem {
  View jacobian, target;                // (m, n), (m,)
  View mass_matrix, bias, velocity;     // M (n, n), h (n,), v (n,)
  View x_lower, x_upper;                // (n,) of accelerations
  View tau_lower, tau_upper;            // (a,) torque limits and torque rate
  View limit_lower, limit_upper;        // (a,) torque limits alone
  View general, general_lower, general_upper;  // (g, n), (g,), (g,)
  View general_force;                          // (g, c), empty: the rows are on x alone
  bool in_contact = false;
  View contact_jacobian, drift_target;  // J_c (q, n), (q,)
  View force_jacobian;                  // J_f (c, n)
  View force_matrix, force_lower, force_upper;  // (r, c), (r,), (r,)
  View force_center, force_factor;      // f_0 (c,), F (c, c) with F F^T = H_f^-1
  std::vector<ForceExpansion> of_orders;  // the same of each order; none: they share the above
  Index unactuated = 0;

  // Throws std::invalid_argument where sizes do not fit together.
  void check() const;

  // Whether every number that an answer is made of is finite; bounds only must not be NaN.
  bool finite() const;

  // Whether the torque rate bounds torques beside the torque limits.
  bool limits_rate() const;
};

}  // namespace ghc
