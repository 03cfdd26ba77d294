#include "dual_method.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "small_factors.hpp"

namespace ghc {
namespace {

constexpr int kSkipped = 2;            // depends on the active rows and agrees with them
constexpr double kFeasibleRow = 1e-14;  // [-] of 1 + |x|: a normalized row violated by less is met
constexpr double kAgrees = 1e-10;  // [-] of 1 + |x|: violation of a dependent row that is rounding
constexpr double kDependentRow = 1e-11;  // [-] what is left of a row that depends on the others
constexpr int kRefinements = 2;        // corrections of the answer on its active rows
constexpr double kLeastLength = 1e-300;
constexpr double kNever = std::numeric_limits<double>::infinity();

// Rotate two rows or columns by a plane rotation.
template <typename A, typename B>
void rotate(A&& upper, B&& under, double cosine, double sine) {
  for (Index i = 0; i < upper.size(); ++i) {
    const double kept = upper[i];
    upper[i] = cosine * kept + sine * under[i];
    under[i] = cosine * under[i] - sine * kept;
  }
}

}  // namespace

DualEnd DualMethod::solve(const Qp& qp, Index limit) {
  const Index n = qp.linear.size(), e = qp.right.size(), count = qp.lower.size();
  qp_ = &qp;
  pivots_ = 0, q_ = 0;
  Matrix factor(n, n);
  inverse_factor(qp.hessian, factor);  // H^-1 = F F^T
  basis_ = factor.transpose();
  x_.noalias() = -(factor * (factor.transpose() * qp.linear));
  triangle_.setZero(n, n), normals_.setZero(n, n);
  for (Vector* v : {&values_, &multiplier_, &sign_of_}) v->setZero(n);
  active_.assign(static_cast<size_t>(n), -1);
  side_.assign(static_cast<size_t>(count), 0);
  y_.setZero(e), z_.setZero(count), norm_.resize(count);
  normal_.resize(n), step_.resize(n);
  for (Index r = 0; r < count; ++r) {
    if (qp.lower[r] > qp.upper[r]) return DualEnd::infeasible;
    norm_[r] = std::max(qp.rows.row(r).norm(), kLeastLength);
  }
  Index next_equality = 0;
  while (true) {
    const double size = 1.0 + x_.norm();
    if (!std::isfinite(size)) return DualEnd::failed;
    const Candidate candidate =
        next_equality < e ? equality(next_equality++) : most_violated();
    if (!candidate.is_equality &&
        (candidate.row < 0 || candidate.violation <= kFeasibleRow * size)) {
      break;
    }
    switch (take_in(qp, candidate, limit)) {
      case Step::conflict: return DualEnd::infeasible;
      case Step::limit: return DualEnd::limit;
      case Step::failed: return DualEnd::failed;
      default: break;
    }
  }
  for (int i = 0; i < kRefinements; ++i) refine();
  for (Index k = 0; k < q_; ++k) {
    const double weight = -multiplier_[k] * sign_of_[k];
    const Index row = active_[static_cast<size_t>(k)];
    if (row < e) {
      y_[row] = weight;
    } else {
      z_[row - e] = weight;
    }
  }
  return DualEnd::solved;
}

DualMethod::Candidate DualMethod::equality(Index row) {
  const auto A = qp_->equalities.row(row);
  const double length = std::max(A.norm(), kLeastLength);
  const double violation = (qp_->right[row] - A.dot(x_)) / length;
  const int sign = violation >= 0.0 ? 1 : -1;
  normal_ = (sign / length) * A.transpose();
  return {row, sign, std::abs(violation), sign * qp_->right[row] / length, length, true};
}

DualMethod::Candidate DualMethod::most_violated() {
  Candidate worst{-1, 0, 0.0, 0.0, 1.0, false};
  for (Index r = 0; r < qp_->lower.size(); ++r) {
    const int side = side_[static_cast<size_t>(r)];
    if (side == kSkipped) continue;
    const double value = qp_->rows.row(r).dot(x_);
    const double below = (qp_->lower[r] - value) / norm_[r];
    const double above = (value - qp_->upper[r]) / norm_[r];
    if (side <= 0 && below > worst.violation) worst.violation = below, worst.row = r, worst.sign = 1;
    if (side >= 0 && above > worst.violation) {
      worst.violation = above, worst.row = r, worst.sign = -1;
    }
  }
  if (worst.row < 0) return worst;
  worst.length = norm_[worst.row];
  normal_ = (worst.sign / worst.length) * qp_->rows.row(worst.row).transpose();
  worst.value = (worst.sign > 0 ? qp_->lower[worst.row] : -qp_->upper[worst.row]) / worst.length;
  return worst;
}

DualMethod::Step DualMethod::take_in(const Qp& qp, Candidate candidate, Index limit) {
  const Index n = x_.size(), e = qp.right.size();
  const double size = 1.0 + x_.norm();
  double added = 0.0, violation = candidate.violation;
  while (true) {
    if (pivots_ >= limit) return Step::limit;
    ++pivots_;
    along_.noalias() = basis_ * normal_;
    const double whole = along_.squaredNorm(), free = along_.tail(n - q_).squaredNorm();
    auto step = step_.head(q_);
    step = along_.head(q_);
    triangle_.topLeftCorner(q_, q_).triangularView<Eigen::Upper>().solveInPlace(step);
    Index blocking = -1;
    double dual_step = kNever;
    for (Index k = 0; k < q_; ++k) {
      if (active_[static_cast<size_t>(k)] >= e && step[k] > 0.0 &&
          multiplier_[k] < dual_step * step[k]) {
        blocking = k, dual_step = multiplier_[k] / step[k];
      }
    }
    const bool dependent = q_ == n || free <= kDependentRow * kDependentRow * whole;
    const bool agrees = dependent && violation <= kAgrees * size;
    if (agrees && candidate.is_equality) return Step::skipped;
    if (dependent && blocking < 0) {
      if (!agrees) return Step::conflict;
      side_[static_cast<size_t>(candidate.row)] = kSkipped;  // until x moves on
      return Step::skipped;
    }
    const double primal_step = dependent ? kNever : violation / free;
    if (blocking < 0 && !(primal_step <= dual_step)) return Step::failed;  // not a number
    const double length = std::min(dual_step, primal_step);
    multiplier_.head(q_) -= length * step;
    added += length;
    if (!dependent) {
      x_.noalias() += basis_.bottomRows(n - q_).transpose() * (length * along_.tail(n - q_));
    }
    if (primal_step <= dual_step) {
      add(along_);
      normals_.row(q_) = normal_.transpose();
      values_[q_] = candidate.value, sign_of_[q_] = candidate.sign / candidate.length;
      active_[static_cast<size_t>(q_)] = candidate.is_equality ? candidate.row : e + candidate.row;
      multiplier_[q_] = added;
      if (!candidate.is_equality) side_[static_cast<size_t>(candidate.row)] = candidate.sign;
      ++q_;
      std::replace(side_.begin(), side_.end(), kSkipped, 0);
      return Step::taken;
    }
    side_[static_cast<size_t>(active_[static_cast<size_t>(blocking)] - e)] = 0;
    drop(blocking);
    violation = candidate.value - normal_.dot(x_);
    if (violation <= 0.0 && !candidate.is_equality) violation = 0.0;
  }
}

// Rotate entries q.. of d (n,) into d[q], and append d[:q + 1] as column q of the triangle.
void DualMethod::add(Vector& d) {
  for (Index k = d.size() - 1; k > q_; --k) {
    if (d[k] == 0.0) continue;
    const double length = std::hypot(d[k - 1], d[k]);
    rotate(basis_.row(k - 1), basis_.row(k), d[k - 1] / length, d[k] / length);
    d[k - 1] = length, d[k] = 0.0;
  }
  triangle_.col(q_).head(q_ + 1) = d.head(q_ + 1);
}

// Take a column out of the triangle and make it triangular again.
void DualMethod::drop(Index column) {
  for (Index c = column; c < q_ - 1; ++c) {
    triangle_.col(c).head(c + 2) = triangle_.col(c + 1).head(c + 2);
    normals_.row(c) = normals_.row(c + 1);
    values_[c] = values_[c + 1], sign_of_[c] = sign_of_[c + 1];
    multiplier_[c] = multiplier_[c + 1];
    active_[static_cast<size_t>(c)] = active_[static_cast<size_t>(c + 1)];
    const double length = std::hypot(triangle_(c, c), triangle_(c + 1, c));
    if (length == 0.0) continue;
    const double cosine = triangle_(c, c) / length, sine = triangle_(c + 1, c) / length;
    triangle_(c, c) = length, triangle_(c + 1, c) = 0.0;
    const Index behind = q_ - c - 2;
    rotate(triangle_.row(c).segment(c + 2, behind), triangle_.row(c + 1).segment(c + 2, behind),
           cosine, sine);
    rotate(basis_.row(c), basis_.row(c + 1), cosine, sine);
  }
  --q_;
}

// Move x by the least step after which its active rows hold.
void DualMethod::refine() {
  auto step = step_.head(q_);
  step = values_.head(q_);
  step.noalias() -= normals_.topRows(q_) * x_;
  triangle_.topLeftCorner(q_, q_).transpose().triangularView<Eigen::Lower>().solveInPlace(step);
  x_.noalias() += basis_.topRows(q_).transpose() * step;
}

}  // namespace ghc
