#include "level.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "few_rows.hpp"

namespace ghc {
namespace {

constexpr double kShortest = 1e-4;  // [-] length of rows below which the damping falls no further
constexpr double kLargest = 50.0;   // [rad/s^2] asked for along a direction that is being lost
constexpr Index kMany = 12;         // rows up to which loops over rows are faster than Eigen's kernels
constexpr double kMost = 4.0;       // [-] of w that is added for it at most

// L in place of L L^T, of few rows.
void factor_small(Matrix& matrix) {
  const Index m = matrix.rows();
  for (Index k = 0; k < m; ++k) {
    double squares = 0.0;
    for (Index c = 0; c < k; ++c) squares += matrix(k, c) * matrix(k, c);
    const double pivot = matrix(k, k) - squares;
    if (pivot <= 0.0) return;
    matrix(k, k) = std::sqrt(pivot);
    const double inverse = 1.0 / matrix(k, k);
    for (Index i = k + 1; i < m; ++i) {
      double product = 0.0;
      for (Index c = 0; c < k; ++c) product += matrix(i, c) * matrix(k, c);
      matrix(i, k) = (matrix(i, k) - product) * inverse;
    }
  }
}

// out = L^-T L^-1 out for columns of `out` (m, m), with L the lower triangle of `lower`.
void solve_columns(const Matrix& lower, Matrix& out) {
  const Index m = lower.rows();
  if (m > kMany) {
    lower.triangularView<Eigen::Lower>().solveInPlace(out);
    lower.transpose().triangularView<Eigen::Upper>().solveInPlace(out);
    return;
  }
  for (Index i = 0; i < m; ++i) {
    for (Index c = 0; c < i; ++c) out.row(i) -= lower(i, c) * out.row(c);
    out.row(i) *= 1.0 / lower(i, i);
  }
  for (Index i = m - 1; i >= 0; --i) {
    out.row(i) *= 1.0 / lower(i, i);
    for (Index c = 0; c < i; ++c) out.row(c) -= lower(i, c) * out.row(i);
  }
}

// out (m, d) = L^T rows, with L the lower triangle of `lower`.
template <typename Rows>
void times_transposed(const Matrix& lower, const Rows& rows, Matrix& out) {
  const Index m = lower.rows();
  out.resize(m, rows.cols());
  if (m > kMany) {
    out.noalias() = lower.transpose().triangularView<Eigen::Upper>() * rows;
    return;
  }
  for (Index i = 0; i < m; ++i) {
    out.row(i) = lower(i, i) * rows.row(i);
    for (Index c = i + 1; c < m; ++c) out.row(i) += lower(c, i) * rows.row(c);
  }
}

// The lower triangle of rows rows^T.
template <typename Rows>
void gram(const Rows& rows, Matrix& out) {
  const Index m = rows.rows();
  out.resize(m, m);
  for (Index r = 0; r < m; ++r) {
    dot_rows(rows.data(), rows.outerStride(), r + 1, rows.row(r).data(), rows.cols(), &out(r, 0));
  }
}

}  // namespace

double level_damping(Index m, double jacobian, double rows, double residual, double w) {
  const double kept = std::min(1.0, rows / std::max(jacobian, 1e-300));
  const double mean = std::sqrt(jacobian / static_cast<double>(std::max<Index>(m, 1)));
  const double length = std::min(1.0, std::max(mean, kShortest));
  const double pull = residual / (4.0 * kLargest * kLargest);
  return w * (1.0 - kept * (1.0 - length)) + (1.0 - kept) * std::min(pull, kMost * w);
}

void Level::solve(const Eigen::Ref<const Matrix>& jacobian, const Eigen::Ref<const Vector>& target,
                  const Eigen::Ref<const Vector>& y, NullSpace& above, double w) {
  const Index m = jacobian.rows(), d = jacobian.cols();
  identity_ = prepared_ = false, inner_rows_ = m;
  above.project_rows(jacobian, inner_);
  residual_.resize(m);
  times(jacobian, y, residual_);
  residual_ = target - residual_;
  damping_ = level_damping(m, jacobian.squaredNorm(), inner_.squaredNorm(),
                           residual_.squaredNorm(), w);
  gram(inner_, factor_);
  factor_.diagonal().array() += damping_;
  factor(factor_);
  weights_ = residual_;
  solve_factored();
  whitened_.setZero(d), optimum_.resize(d);
  add_rows(inner_, weights_, 1.0, whitened_);
  above.project(whitened_.transpose(), optimum_.transpose());
  optimum_ += y;
}

// P = I - V^T V, E = I - V V^T: P^2 = I - V^T (I + E) V, and by Woodbury's identity
// (P^2 + w I)^-1 = (I + V^T X V) / (1 + w) with X = (w I + E^2)^-1 (I + E).
void Level::solve_identity(const Eigen::Ref<const Vector>& target,
                           const Eigen::Ref<const Vector>& y, const NullSpace& above, double w) {
  const Index d = target.size(), r = above.used();
  const auto V = above.basis();
  identity_ = true, prepared_ = false, inner_rows_ = r;
  gram(V, overlap_);
  overlap_ *= -1.0;
  overlap_.diagonal().array() += 1.0;
  overlap_.triangularView<Eigen::StrictlyUpper>() = overlap_.transpose();
  gram(overlap_, factor_);  // E^2
  residual_ = target - y;
  damping_ = level_damping(d, static_cast<double>(d),
                           static_cast<double>(d - r) + factor_.trace(), residual_.squaredNorm(),
                           w);
  factor_.diagonal().array() += damping_;
  factor(factor_);
  whitened_.resize(d), optimum_.resize(d);
  above.project(residual_.transpose(), whitened_.transpose());
  weights_.resize(r), spread_of_.resize(r);
  times(V, whitened_, weights_);
  times(overlap_, weights_, spread_of_);
  weights_ += spread_of_;  // (I + E) V u
  solve_factored();
  add_rows(V, weights_, 1.0, whitened_);
  whitened_ *= 1.0 / (1.0 + damping_);
  above.project(whitened_.transpose(), optimum_.transpose());
  optimum_ += y;
}

// Of J = I: W = X_h^T V with X = X_h X_h^T, then F = (1 + w)^-1/2 (I + W^T (S + I)^-1 W) with
// S S^T = I + W W^T.
void Level::prepare(const NullSpace& above) {
  if (prepared_) return;
  prepared_ = true;
  if (!identity_) {
    shifted_ = factor_;
    shifted_.diagonal().array() += std::sqrt(damping_);
    scale_ = 1.0 / std::sqrt(damping_);
    return;
  }
  spread_ = overlap_;
  spread_.diagonal().array() += 1.0;
  solve_columns(factor_, spread_);  // X
  factor(spread_);  // X_h
  times_transposed(spread_, above.basis(), inner_);
  gram(inner_, root_);
  root_.diagonal().array() += 1.0;
  factor(root_);
  shifted_ = root_;
  shifted_.diagonal().array() += 1.0;
  scale_ = 1.0 / std::sqrt(1.0 + damping_);
}

// What Eigen::LLT does in place, without the norm that it takes to estimate the condition.
void Level::factor(Matrix& square) {
  if (square.rows() <= kFew) {
    factor_small(square);
  } else {
    Eigen::internal::llt_inplace<double, Eigen::Lower>::blocked(square);
  }
}

void Level::solve_factored() {
  divide_by_lower(factor_, weights_);
  divide_by_lower_transposed(factor_, weights_);
}

void Level::weights_times_k() {
  if (!identity_) {
    divide_by_lower(factor_, weights_);
    weights_ *= -1.0;
  }
  divide_by_lower_transposed(shifted_, weights_);
}

void Level::k_times_weights() {
  divide_by_lower(shifted_, weights_);
  if (identity_) return;
  divide_by_lower_transposed(factor_, weights_);
  weights_ *= -1.0;
}

void Level::step(const Eigen::Ref<const Vector>& s, const NullSpace& above, Vector& out) {
  weights_.resize(inner_.rows());
  times(inner_, s, weights_);
  k_times_weights();
  whitened_ = s;
  add_rows(inner_, weights_, 1.0, whitened_);
  whitened_ *= scale_;
  out.resize(s.size());
  above.project(whitened_.transpose(), out.transpose());
}

void Level::see(const double* rows, Index stride, Index count, const NullSpace& above) {
  const Index k = inner_rows_, d = optimum_.size();
  seen_.resize(k, count), through_.resize(k, count);
  weights_.resize(k), spread_of_.resize(k);
  for (Index j = 0; j < count; ++j) {
    const ConstVector row(rows + j * stride, d);
    if (identity_) {
      times(above.basis(), row, weights_);
      seen_.col(j) = weights_;
      times(overlap_, weights_, spread_of_);
      weights_ += spread_of_;
    } else {
      times(inner_, row, weights_);
    }
    through_.col(j) = weights_;
  }
  divide_columns_by_lower(factor_, through_);
  if (identity_) {
    divide_columns_by_lower_transposed(factor_, through_);
  } else {
    seen_ = through_;
  }
}

void Level::step_of_pull(const Eigen::Ref<const Vector>& pull, const NullSpace& above,
                         Vector& out) {
  whitened_ = pull;
  weights_.resize(inner_rows_);
  if (!identity_) {
    times(inner_, pull, weights_);
    solve_factored();
    add_rows(inner_, weights_, -1.0, whitened_);
    whitened_ *= 1.0 / damping_;
  } else {
    times(above.basis(), pull, weights_);
    spread_of_.resize(inner_rows_);
    times(overlap_, weights_, spread_of_);
    weights_ += spread_of_;
    solve_factored();
    add_rows(above.basis(), weights_, 1.0, whitened_);
    whitened_ *= 1.0 / (1.0 + damping_);
  }
  out.resize(pull.size());
  above.project(whitened_.transpose(), out.transpose());
}

}  // namespace ghc
