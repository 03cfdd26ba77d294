#include "projected.hpp"

#include <cmath>

#include "small_factors.hpp"

namespace ghc {
namespace {

constexpr double kMetricFloor = 1e-15;  // keeps the metric of no motion positive

ConstMatrix projector(const double* projectors, Index i, Index d) {
  return {projectors + i * d * d, d, d};
}

template <typename Row>
bool is_strict(const Row& alpha) {
  for (Index j = 0; j < alpha.size(); ++j) {
    if (alpha[j] != 0.0 && alpha[j] != 1.0) return false;
  }
  return true;
}

auto targets(const TaskRows& tasks, const ConstVector& target, Index i) {
  return target.segment(tasks.starts[i], tasks.starts[i + 1] - tasks.starts[i]);
}

}  // namespace

void ghc_target(const TaskRows& tasks, const ConstVector& target, const double* projectors,
                double w, Eigen::Ref<Vector> x0) {
  const Index d = tasks.jacobian.cols();
  Vector values, alone(d), share;
  Matrix lower;
  x0.setZero();
  for (Index i = 0; i < tasks.count(); ++i) {
    const auto rows = tasks.rows(i);
    if (selected_values(rows, values)) {  // alone = J_i^T (J_i J_i^T + w I)^-1 b_i
      alone.noalias() = rows.transpose() * targets(tasks, target, i);
      alone.array() /= values.array().square() + w;
    } else {
      damped_factor(rows, w, lower);
      share = targets(tasks, target, i);
      solve_factored(lower, share);
      alone.noalias() = rows.transpose() * share;
    }
    x0.noalias() += projector(projectors, i, d) * alone;
  }
}

void ghc_factor(const TaskRows& tasks, const double* projectors, double w, bool exact,
                Matrix& factor) {
  const Index d = tasks.jacobian.cols();
  Matrix metric = Matrix::Zero(d, d), projected, lower;
  Vector values, left_over;
  for (Index i = 0; i < tasks.count(); ++i) {
    const ConstMatrix P = projector(projectors, i, d);
    const bool idempotent = exact && is_strict(tasks.alpha.row(i));
    const auto rows = tasks.rows(i);
    auto half = metric.triangularView<Eigen::Lower>();
    if (selected_values(rows, values)) {  // P D P with D = I - J^T (J J^T + w I)^-1 J, diagonal
      left_over = w / (values.array().square() + w);
      if (idempotent && left_over.minCoeff() == left_over.maxCoeff()) {
        metric += left_over[0] * P;
      } else {
        projected = left_over.asDiagonal() * P;
        half += P * projected;
      }
      continue;
    }
    if (idempotent) {
      metric += P;
    } else {
      half += P * P;
    }
    projected.noalias() = rows * P;
    damped_factor(rows, w, lower);
    lower.triangularView<Eigen::Lower>().solveInPlace(projected);
    half -= projected.transpose() * projected;
  }
  metric.diagonal().array() += kMetricFloor;
  cholesky(metric, factor);
}

void balanced_system(const TaskRows& tasks, const double* projectors, double w,
                     Eigen::Ref<Matrix> system) {
  const Index d = tasks.jacobian.cols();
  Matrix projected;
  Vector values;
  system.setZero();
  system.diagonal().setConstant(w);
  for (Index i = 0; i < tasks.count(); ++i) {
    if (tasks.alpha(i, i) >= 1.0) continue;  // removed: P_i J_i^T = 0
    const ConstMatrix P = projector(projectors, i, d);
    const auto rows = tasks.rows(i);
    if (selected_values(rows, values)) {
      system += P * values.array().square().matrix().asDiagonal();
    } else {
      projected.noalias() = rows * P;
      system.noalias() += projected.transpose() * rows;
    }
  }
}

double balanced_target(const TaskRows& tasks, const ConstVector& target, const double* projectors,
                       double w, double guard, Eigen::Ref<Vector> x) {
  const Index d = tasks.jacobian.cols();
  Matrix system(d, d);
  balanced_system(tasks, projectors, w, system);
  Vector right = Vector::Zero(d), pull(d);
  for (Index i = 0; i < tasks.count(); ++i) {
    if (tasks.alpha(i, i) >= 1.0) continue;
    pull.noalias() = tasks.rows(i).transpose() * targets(tasks, target, i);
    right.noalias() += projector(projectors, i, d) * pull;
  }
  Matrix inverse = system, lower;
  const double sigma = invert(inverse) ? 1.0 / inverse.norm() : 0.0;
  if (sigma >= guard) {
    x.noalias() = inverse * right;
    return sigma;
  }
  Matrix normal = system.transpose() * system;
  normal.diagonal().array() += guard * guard - sigma * sigma;
  cholesky(normal, lower);
  x.noalias() = system.transpose() * right;
  solve_factored(lower, x);
  return sigma;
}

}  // namespace ghc
