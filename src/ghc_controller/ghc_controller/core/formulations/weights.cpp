#include "weights.hpp"

#include <algorithm>
#include <cmath>

#include "small_factors.hpp"

namespace ghc {

void priority_weights(const ConstMatrix& alpha, double ratio, double spread,
                      Eigen::Ref<Vector> weights) {
  const Index k = alpha.rows();
  weights.setZero();
  double longest = 1.0;
  for (Index i = 0; i < k; ++i) {
    for (Index j = 0; j < k; ++j) {
      if (j != i) weights[i] += (1.0 - alpha(j, j)) * alpha(j, i);
    }
    longest = std::max(longest, weights[i]);
  }
  const double base = std::min(ratio, std::pow(spread, 1.0 / longest));
  for (Index i = 0; i < k; ++i) weights[i] = (1.0 - alpha(i, i)) * std::pow(base, weights[i]);
}

void weighted_system(const TaskRows& tasks, const ConstVector& target, const Vector& weights,
                     double damping, Eigen::Ref<Matrix> hessian, Eigen::Ref<Vector> right) {
  if (hessian.rows() == 0) return;  // contacts hold every motion
  Vector values;
  Matrix weighted;
  hessian.setZero();
  hessian.diagonal().setConstant(damping);
  right.setZero();
  for (Index i = 0; i < tasks.count(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    const auto rows = tasks.rows(i);
    weighted = weights[i] * rows;
    if (selected_values(rows, values)) {
      hessian.diagonal().array() += weights[i] * values.array().square();
    } else {
      hessian.triangularView<Eigen::Lower>() += weighted.transpose() * rows;
    }
    right.noalias() += weighted.transpose() * target.segment(tasks.starts[i], rows.rows());
  }
  hessian.triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
}

}  // namespace ghc
