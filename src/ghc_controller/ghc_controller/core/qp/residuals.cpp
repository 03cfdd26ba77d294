#include "residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ghc {

void Qp::check() const {
  const Index n = linear.size(), e = right.size(), r = lower.size();
  if (hessian.rows() != n || hessian.cols() != n || equalities.rows() != e ||
      (e && equalities.cols() != n) || rows.rows() != r || (r && rows.cols() != n) ||
      upper.size() != r) {
    throw std::invalid_argument("H (n, n), g (n,), A (e, n), b (e,), C (r, n), l and u expected");
  }
}

int Qp::not_finite() const {
  const Index n = linear.size(), e = right.size(), r = lower.size();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!std::isfinite(hessian.sum())) return 0;
  if (n && !std::isfinite(linear.sum())) return 1;
  for (Index i = 0; i < e; ++i) {
    if (!std::isfinite(equalities.row(i).sum())) return 2;
    if (!std::isfinite(right[i])) return 3;
  }
  for (Index i = 0; i < r; ++i) {
    if (!std::isfinite(rows.row(i).sum())) return 4;
    if (!(lower[i] < infinity)) return 5;
    if (!(upper[i] > -infinity)) return 6;
  }
  return -1;
}

Residuals kkt_residuals(const Qp& qp, const ConstVector& x, const ConstVector& y,
                        const ConstVector& z, const ConstVector& units) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (!x.allFinite() || !y.allFinite() || !z.allFinite()) return {nan, nan, nan, 1.0, 1.0};
  Residuals out{0.0, 0.0, 0.0, 1.0, 1.0};
  Vector gradient = qp.linear;
  const Vector curved = qp.hessian * x;
  const auto largest = [](const auto& v) {
    return v.size() ? v.cwiseAbs().maxCoeff() : 0.0;
  };
  out.size += largest(x);
  out.terms = 1.0 + std::max(largest(gradient), largest(curved));
  gradient += curved;
  const auto pull = [&](double weight, const auto& row) {
    gradient += weight * row.transpose();
    out.terms = std::max(out.terms, 1.0 + std::abs(weight) * largest(row));
  };
  for (Index r = 0; r < y.size(); ++r) {
    out.primal = std::max(out.primal, std::abs(qp.equalities.row(r).dot(x) - qp.right[r]));
    pull(y[r], qp.equalities.row(r));
  }
  const Vector values = qp.rows * x;
  for (Index r = 0; r < z.size(); ++r) {
    out.primal = std::max({out.primal, units[r] * (qp.lower[r] - values[r]),
                           units[r] * (values[r] - qp.upper[r])});
    if (z[r] == 0.0) continue;
    const double distance = z[r] > 0.0 ? qp.upper[r] - values[r] : values[r] - qp.lower[r];
    out.complementarity = std::max(out.complementarity, std::abs(z[r] * distance));
    pull(z[r], qp.rows.row(r));
  }
  if (!gradient.allFinite() || !values.allFinite()) return {nan, nan, nan, 1.0, 1.0};
  out.dual = largest(gradient);
  return out;
}

}  // namespace ghc
