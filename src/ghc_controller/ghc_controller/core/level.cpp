#include "level.hpp"

#include <algorithm>
#include <cmath>

namespace ghc {
namespace {

constexpr double kShortest = 1e-4;  // [-] length of rows below which the damping falls no further
constexpr double kLargest = 50.0;   // [rad/s^2] asked for along a direction that is being lost
constexpr double kMost = 4.0;       // [-] of w that is added for it at most

}  // namespace

double level_damping(const Eigen::Ref<const Matrix>& jacobian, const Eigen::Ref<const Matrix>& rows,
                     const Eigen::Ref<const Vector>& residual, double w) {
  const double m = static_cast<double>(std::max<Index>(jacobian.rows(), 1));
  const double whole = jacobian.squaredNorm();
  const double kept = std::min(1.0, rows.squaredNorm() / std::max(whole, 1e-300));
  const double length = std::min(1.0, std::max(std::sqrt(whole / m), kShortest));
  const double pull = residual.squaredNorm() / (4.0 * kLargest * kLargest);
  return w * (1.0 - kept * (1.0 - length)) + (1.0 - kept) * std::min(pull, kMost * w);
}

void Level::solve(const Eigen::Ref<const Matrix>& jacobian, const Eigen::Ref<const Vector>& target,
                  const Eigen::Ref<const Vector>& y, const NullSpace& above, double w) {
  const Index m = jacobian.rows(), d = jacobian.cols();
  rows_.resize(m, d);
  for (Index r = 0; r < m; ++r) above.project(jacobian.row(r), rows_.row(r));
  residual_ = target;
  residual_.noalias() -= jacobian * y;
  damping_ = level_damping(jacobian, rows_, residual_, w);
  root_ = std::sqrt(damping_);
  factor_.resize(m, m);
  for (Index r = 0; r < m; ++r) {
    for (Index c = 0; c <= r; ++c) factor_(r, c) = rows_.row(r).dot(rows_.row(c));
    factor_(r, r) += damping_;
  }
  Eigen::LLT<Eigen::Ref<Matrix>, Eigen::Lower> cholesky(factor_);  // in place: S
  shifted_ = factor_;
  shifted_.diagonal().array() += root_;
  weights_ = residual_;
  factor_.triangularView<Eigen::Lower>().solveInPlace(weights_);
  factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(weights_);
  whitened_.noalias() = rows_.transpose() * weights_;
  optimum_.resize(d);
  above.project(whitened_.transpose(), optimum_.transpose());
  optimum_ += y;
}

void Level::times_k() {
  // v^T K = ((S + sqrt(w) I)^-T S^-1 v)^T
  factor_.triangularView<Eigen::Lower>().solveInPlace(weights_);
  shifted_.transpose().triangularView<Eigen::Upper>().solveInPlace(weights_);
}

void Level::k_times() {
  shifted_.triangularView<Eigen::Lower>().solveInPlace(weights_);
  factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(weights_);
}

void Level::step(const Eigen::Ref<const Vector>& s, const NullSpace& above, Vector& out) {
  weights_.noalias() = rows_ * s;
  k_times();
  whitened_ = s;
  whitened_.noalias() -= rows_.transpose() * weights_;
  whitened_ /= root_;
  out.resize(s.size());
  above.project(whitened_.transpose(), out.transpose());
}

}  // namespace ghc
