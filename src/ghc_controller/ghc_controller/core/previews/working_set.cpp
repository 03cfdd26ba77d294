#include "working_set.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace ghc {
namespace {

constexpr double kFeasibility = 1e-9;  // [-] accepted violation, relative to the largest bound
constexpr double kNoCurvature = 1e-12;  // [-] of its own: what is left of a dependent row

}  // namespace

WorkingSet::WorkingSet(const Vector& y, const Vector& bound) : y_(y), bound_(bound) {
  double largest = 1.0;
  for (Index i = 0; i < bound.size(); ++i) {
    if (std::isfinite(bound[i])) largest = std::max(largest, std::abs(bound[i]));
  }
  tolerance_ = kFeasibility * largest;
}

Index WorkingSet::most_violated(const Vector& y, double share) const {
  double worst = share * tolerance_;
  Index row = -1;
  for (Index i = 0; i < y.size(); ++i) {
    const double excess = y[i] - bound_[i];
    if (excess > worst) worst = excess, row = i;
  }
  return row;
}

bool WorkingSet::take_in(Index row, const Vector& column) {
  const double curvature = column[row];
  double own = 0.0;
  while (true) {
    const Index count = this->count();
    gram_.resize(count, count), across_.resize(count);
    for (Index a = 0; a < count; ++a) {
      across_[a] = column[rows_[static_cast<size_t>(a)]];
      for (Index b = 0; b < count; ++b) {
        gram_(a, b) = columns_[static_cast<size_t>(a)][rows_[static_cast<size_t>(b)]];
      }
    }
    share_ = across_;
    if (count) share_ = gram_.partialPivLu().solve(across_);
    const double left = curvature - share_.dot(across_);
    const bool independent = left > kNoCurvature * curvature;
    double step = std::numeric_limits<double>::infinity();
    Index blocking = -1;
    if (independent) step = (y_[row] - bound_[row]) / left;
    for (Index a = 0; a < count; ++a) {
      const double multiplier = multipliers_[static_cast<size_t>(a)];
      if (share_[a] > 0.0 && multiplier < step * share_[a]) {
        step = multiplier / share_[a], blocking = a;
      }
    }
    if (!std::isfinite(step)) return false;
    for (Index a = 0; a < count; ++a) multipliers_[static_cast<size_t>(a)] -= step * share_[a];
    own += step;
    if (independent) {
      change_ = column;
      for (Index a = 0; a < count; ++a) change_ -= share_[a] * columns_[static_cast<size_t>(a)];
      y_ -= step * change_;
    }
    if (blocking < 0) break;
    rows_.erase(rows_.begin() + blocking);
    multipliers_.erase(multipliers_.begin() + blocking);
    columns_.erase(columns_.begin() + blocking);
  }
  rows_.push_back(row);
  multipliers_.push_back(own);
  columns_.push_back(column);
  return true;
}

}  // namespace ghc
