#include "problem.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

namespace ghc {
namespace {

void expect(bool fits, const char* what) {
  if (!fits) throw std::invalid_argument(what);
}

bool is_finite(const View& view) {
  return view.size() == 0 || std::isfinite(view.vector().sum());
}

bool has_nan(const View& view) {
  for (Index i = 0; i < view.size(); ++i) {
    if (std::isnan(view.data[i])) return true;
  }
  return false;
}

bool same(const View& one, const View& other) {
  return one.data == other.data ||
         std::memcmp(one.data, other.data, sizeof(double) * static_cast<size_t>(one.size())) == 0;
}

}  // namespace

void Problem::check() const {
  const Index m = jacobian.rows, n = jacobian.cols, a = n - unactuated;
  expect(unactuated >= 0 && a >= 0, "0 to n unactuated coordinates expected");
  expect(target.size() == m, "as many targets as rows of the Jacobian expected");
  expect(mass_matrix.rows == n && mass_matrix.cols == n && bias.size() == n &&
             velocity.size() == n,
         "M (n, n), h (n,) and v (n,) expected");
  expect(x_lower.size() == n && x_upper.size() == n, "bounds (n,) on accelerations expected");
  expect(tau_lower.size() == a && tau_upper.size() == a && limit_lower.size() == a &&
             limit_upper.size() == a,
         "bounds (a,) on torques expected");
  const Index g = general_lower.size();
  expect(general_upper.size() == g && general.rows == g && (g == 0 || general.cols == n),
         "general rows (g, n) and their bounds (g,) expected");
  expect(general_force.size() == 0 || (in_contact && general_force.rows == g &&
                                       general_force.cols == force_center.size()),
         "general rows (g, c) on forces expected");
  if (!in_contact) return;
  const Index c = force_center.size(), r = force_lower.size();
  expect(contact_jacobian.cols == n && drift_target.size() == contact_jacobian.rows,
         "contact rows (q, n) and targets (q,) expected");
  expect(force_jacobian.rows == c && (c == 0 || force_jacobian.cols == n) &&
             force_factor.rows == c && force_factor.cols == c,
         "J_f (c, n), center (c,) and factor (c, c) expected");
  for (const ForceExpansion& one : of_orders) {
    expect(one.center.size() == c && one.factor.rows == c && one.factor.cols == c,
           "center (c,) and factor (c, c) of each order expected");
  }
  expect(force_upper.size() == r && force_matrix.rows == r && (r == 0 || force_matrix.cols == c),
         "rows (r, c) on forces and their bounds (r,) expected");
}

bool Problem::finite() const {
  for (const View* part : {&jacobian, &target, &mass_matrix, &bias, &velocity, &general, &general_force}) {
    if (!is_finite(*part)) return false;
  }
  if (has_nan(general_lower) || has_nan(general_upper)) return false;
  if (!in_contact) return true;
  for (const View* part :
       {&contact_jacobian, &drift_target, &force_jacobian, &force_center, &force_factor}) {
    if (!is_finite(*part)) return false;
  }
  for (const ForceExpansion& one : of_orders) {
    if (!is_finite(one.center) || !is_finite(one.factor)) return false;
  }
  return true;
}

bool Problem::limits_rate() const {
  return !(same(tau_lower, limit_lower) && same(tau_upper, limit_upper));
}

}  // namespace ghc
