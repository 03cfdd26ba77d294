#include "qp_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ghc {
namespace {

constexpr double kSmallestNorm = 1e-9;

void expect_fit(bool fits, const char* what) {
  if (!fits) throw std::invalid_argument(what);
}

}  // namespace

void QpRowParts::check() const {
  const Index n = x_lower.size(), d = y0.size(), c = f0.size(), p = factor.cols();
  expect_fit(factor.rows() == d && force_factor.rows() == c && force_factor.cols() == p,
             "a parametrization (d,), (d, p), (c,), (c, p) expected");
  expect_fit(in_contact ? basis.rows() == n && basis.cols() == d && offset.size() == n : n == d,
             "a basis (n, d) and an offset (n,) expected, or neither and d = n");
  expect_fit(x_upper.size() == n, "bounds (n,) on accelerations expected");
  const Index g = general.rows();
  expect_fit((g == 0 || general.cols() == n) && general_lower.size() == g &&
                 general_upper.size() == g && soft >= 0 && soft <= g &&
                 (general_force.size() == 0 ||
                  (general_force.rows() == g && general_force.cols() == c)),
             "general rows (g, n) and (g, c) with bounds (g,) expected");
  const Index r = force_matrix.rows();
  expect_fit((r == 0 || force_matrix.cols() == c) && force_lower.size() == r &&
                 force_upper.size() == r,
             "rows (r, c) on forces with bounds (r,) expected");
  const Index a = torque_offset.size();
  expect_fit(torque_matrix.rows() == a && torque_matrix.cols() == d && torque_force.rows() == a &&
                 torque_force.cols() == c && tau_lower.size() == a && tau_upper.size() == a,
             "torque rows (a, d), (a, c), (a,) with bounds (a,) expected");
}

Index QpRowParts::count() const {
  return x_lower.size() + general.rows() + force_matrix.rows() + torque_offset.size();
}

void write_qp_rows(const QpRowParts& q, Eigen::Ref<Matrix> rows, Eigen::Ref<Vector> lower,
                   Eigen::Ref<Vector> upper, Eigen::Ref<Vector> norm) {
  const Index n = q.x_lower.size(), g = q.general.rows(), r = q.force_matrix.rows(),
              a = q.torque_offset.size(), hard = g - q.soft;
  const bool forces = q.f0.size() > 0;
  const auto bound = [&](Index first, const auto& low, const auto& high, const Vector& value) {
    lower.segment(first, value.size()) = low - value;
    upper.segment(first, value.size()) = high - value;
  };
  Vector x0 = q.y0, value;
  auto on_x = rows.topRows(n);
  if (q.in_contact) {
    on_x.noalias() = q.basis * q.factor;
    x0 = q.offset;
    x0.noalias() += q.basis * q.y0;
  } else {
    on_x = q.factor;
  }
  bound(0, q.x_lower, q.x_upper, x0);
  const auto general = [&](Index from, Index count, Index first) {
    if (count == 0) return;
    auto out = rows.middleRows(first, count);
    const auto matrix = q.general.middleRows(from, count);
    out.noalias() = matrix * on_x;
    value.noalias() = matrix * x0;
    if (q.general_force.size()) {
      out.noalias() += q.general_force.middleRows(from, count) * q.force_factor;
      value.noalias() += q.general_force.middleRows(from, count) * q.f0;
    }
    bound(first, q.general_lower.segment(from, count), q.general_upper.segment(from, count), value);
  };
  general(0, q.soft, n);
  const Index first_force = n + q.soft, first_torque = first_force + r;
  if (r) {
    rows.middleRows(first_force, r).noalias() = q.force_matrix * q.force_factor;
    value.noalias() = q.force_matrix * q.f0;
    bound(first_force, q.force_lower, q.force_upper, value);
  }
  auto on_tau = rows.middleRows(first_torque, a);
  on_tau.noalias() = q.torque_matrix * q.factor;
  value = q.torque_offset;
  value.noalias() += q.torque_matrix * q.y0;
  if (forces) {
    on_tau.noalias() += q.torque_force * q.force_factor;
    value.noalias() += q.torque_force * q.f0;
  }
  bound(first_torque, q.tau_lower, q.tau_upper, value);
  general(q.soft, hard, first_torque + a);
  for (Index i = 0; i < rows.rows(); ++i) {
    norm[i] = std::max(rows.row(i).norm(), kSmallestNorm);
    const double scale = 1.0 / norm[i];
    rows.row(i) *= scale;
    lower[i] *= scale;
    upper[i] *= scale;
  }
}

bool is_inside(const Eigen::Ref<const Vector>& value, const ConstVector& lower,
               const ConstVector& upper) {
  for (Index r = 0; r < value.size(); ++r) {
    if (!(lower[r] <= value[r] && value[r] <= upper[r])) return false;
  }
  return true;
}

double largest_excess(const Eigen::Ref<const Vector>& value, const ConstVector& lower,
                      const ConstVector& upper) {
  double worst = 0.0;
  for (Index r = 0; r < value.size(); ++r) {
    if (!std::isfinite(value[r])) return std::numeric_limits<double>::infinity();
    worst = std::max({worst, lower[r] - value[r], value[r] - upper[r]});
  }
  return worst;
}

}  // namespace ghc
