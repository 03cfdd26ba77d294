#include "cascade.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "few_rows.hpp"

namespace ghc {
namespace {

constexpr double kUpperForceWeight = 1e-4;  // [-] root of the weight on forces above the last level
constexpr double kViolation = 1e-6;         // [rad/s^2], [Nm], [N] of an accepted answer
constexpr double kLittle = 1e-9;            // [rad/s^2] by which a level may move and be no level

// Whether any number of a row is not zero.
bool any(const double* row, Index size) {
  std::uint64_t found = 0;
  for (Index c = 0; c < size; ++c) {
    std::uint64_t bits;
    std::memcpy(&bits, row + c, sizeof bits);
    found |= bits << 1;  // without the sign of a zero
  }
  return found != 0;
}

// What Eigen's isIdentity(0.0) says, in an eighth of its time.
bool is_identity(const Eigen::Ref<const Matrix>& square) {
  const Index d = square.cols();
  for (Index r = 0; r < d; ++r) {
    if (square(r, r) != 1.0) return false;
  }
  for (Index r = 0; r < d; ++r) {
    const double* row = square.row(r).data();
    if (any(row, r) || any(row + r + 1, d - r - 1)) return false;
  }
  return true;
}

}  // namespace

Cascade::Cascade(std::vector<std::int64_t> rows, std::vector<std::int64_t> ends)
    : rows_(std::move(rows)),
      ends_(std::move(ends)),
      memory_(ends_.size()),
      level_(ends_.size()) {
  const bool ascend = std::is_sorted(ends_.begin(), ends_.end());
  if (ends_.empty() || !ascend || ends_.front() < 0 ||
      ends_.back() != static_cast<std::int64_t>(rows_.size())) {
    throw std::invalid_argument("ends of the levels expected, ascending up to the last row");
  }
}

bool Cascade::fits(Index m) const {
  return std::all_of(rows_.begin(), rows_.end(),
                     [m](std::int64_t row) { return 0 <= row && row < m; });
}

Index Cascade::solve(const ConstMatrix& jacobian, const ConstVector& target, const Vector& y,
                     const Terms& terms, const Damping& damping, const Effort& effort) {
  const Index m = static_cast<Index>(rows_.size()), d = jacobian.cols();
  const Index levels = static_cast<Index>(ends_.size());
  jacobian_.resize(m, d), target_.resize(m);
  for (Index r = 0; r < m; ++r) {
    jacobian_.row(r) = jacobian.row(rows_[r]);
    target_[r] = target[rows_[r]];
  }
  above_.reset(d, m);
  bounds_.begin(terms);
  bound_rows_.reset(bounds_.count(), d);
  y_ = y;
  violation_ = 0.0, pivots_ = 0, qps_ = 0, answered_ = 0;
  for (Index l = 0; l < levels; ++l, ++answered_) {
    if (l && effort.deadline.over()) return l;
    if (l && close(l, damping, effort)) return levels;
    Level& level = level_[l];
    const Index begin = l ? ends_[l - 1] : 0, size = ends_[l] - begin;
    const auto rows = jacobian_.middleRows(begin, size);
    const auto target_of_level = target_.segment(begin, size);
    const bool by_identity = size == d && above_.used() < d && is_identity(rows);
    if (by_identity) {
      level.solve_identity(target_of_level, y_, above_, damping.regularization);
    } else {
      level.solve(rows, target_of_level, y_, above_, damping.regularization);
    }
    bounds_.evaluate(level.optimum(), none_, 1.0);
    if (bounds_.inside()) {
      y_ = level.optimum();
      if (qps_) violation_ = bounds_.violation_of_given();
    } else {
      const Index left = std::min(effort.of_qp, effort.of_order - pivots_);
      if (!effort.bounded || !bounds_.balanced() || left <= 0) return l;
      const double weight = l + 1 == levels ? 1.0 : kUpperForceWeight;
      const bool solved =
          active_set_.solve(level, above_, bounds_, bound_rows_, weight, memory_[l], left);
      pivots_ += active_set_.pivots();
      const double violation = solved ? bounds_.violation_of_given() : kViolation;
      if (!solved || !(violation <= kViolation)) return l;
      y_ = active_set_.optimum();
      violation_ = violation;
      ++qps_;
      bounds_.widen();
    }
    take_point();
    if (l + 1 == levels) continue;
    if (by_identity) above_.project_rows(rows, projected_);
    above_.append(rows, by_identity ? projected_ : level.rows(), damping.null_space);
  }
  return levels;
}

bool Cascade::close(Index first, const Damping& damping, const Effort& effort) {
  const double open = above_.trace();
  const Index levels = static_cast<Index>(ends_.size()), d = jacobian_.cols();
  if (!(open * open < kLittle)) return false;
  closed_ = y_;
  across_.resize(d);
  for (Index l = first; l < levels; ++l) {
    if (l > first && effort.deadline.over()) return false;
    const Index begin = ends_[l - 1], size = ends_[l] - begin;
    const auto rows = jacobian_.middleRows(begin, size);
    residual_.resize(size);
    times(rows, closed_, residual_);
    residual_ = target_.segment(begin, size) - residual_;
    const double jacobian = rows.squaredNorm(), residual = residual_.squaredNorm();
    const double w = level_damping(size, jacobian, 0.0, residual, damping.regularization);
    if (!(open * open * std::sqrt(jacobian * residual) <= kLittle * w)) return false;
    pull_.setZero(d);
    add_rows(rows, residual_, 1.0 / w, pull_);
    above_.project(pull_.transpose(), across_.transpose());
    above_.project(across_.transpose(), pull_.transpose());
    closed_ += pull_;
  }
  bounds_.evaluate(closed_, none_, 1.0);
  if (!bounds_.inside()) return false;
  y_ = closed_, answered_ = levels;
  if (qps_) violation_ = bounds_.violation_of_given();
  take_point();
  return true;
}

void Cascade::take_point() {
  x_ = bounds_.x(), torque_ = bounds_.torque(), force_ = bounds_.force();
}

}  // namespace ghc
