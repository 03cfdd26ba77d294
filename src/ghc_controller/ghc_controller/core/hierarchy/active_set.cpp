#include "active_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "few_rows.hpp"

namespace ghc {
namespace {

constexpr double kDependent = 1e-11;  // [-] length of what is left of a row on the active ones
constexpr double kCancelled = 0.1;    // [-] square of what a pass leaves, below it another follows
constexpr double kStationary = 1e-7;  // [-] of s - N^T lambda, over 1 + |s|
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

bool ActiveSet::solve(Level& level, const NullSpace& above, Bounds& bounds, ProjectedRows& rows,
                      double force_weight, std::vector<ActiveRow>& memory, Index limit) {
  bounds.prepare();
  base_ = bounds.values();  // stands at the optimum without bounds
  const KnownSet::Task task{level, above, bounds, rows, force_weight, base_};
  if (known_.solve(task, memory, limit, y_)) {
    pivots_ = known_.pivots();
    return true;
  }
  begin(level, above, bounds, rows, force_weight);
  start_from(memory);
  // Mostly the set of the tick before is that of this one: then one evaluation shows it.
  bool final = size_ == static_cast<Index>(memory.size());
  memory.clear();
  while (true) {
    if (final && !refine()) return false;
    evaluate();
    const ActiveRow worst = most_violated(*bounds_, is_active_);
    if (worst.side != 0) {
      if (!enter(worst, limit)) return false;
      answer(), final = false;
    } else if (!final) {
      std::vector<ActiveRow> found = in_order();
      if (known_.solve(task, found, 1, y_)) {
        memory = found;
        return true;
      }
      factor(found), final = true;
    } else {
      break;
    }
  }
  if (!(bounds.violation() <= kFeasible)) return false;
  memory = active_;
  return true;
}

std::vector<ActiveRow> ActiveSet::in_order() const {
  std::vector<ActiveRow> rows = active_;
  std::sort(rows.begin(), rows.end(),
            [](const ActiveRow& a, const ActiveRow& b) { return a.row < b.row; });
  return rows;
}

void ActiveSet::factor(const std::vector<ActiveRow>& rows) {
  active_.clear();
  std::fill(is_active_.begin(), is_active_.end(), 0);
  size_ = 0;
  for (const ActiveRow& active : rows) {
    if (active.row >= bounds_->count() || size_ == normals_.rows() || !form(active)) continue;
    split_candidate();
    if (std::sqrt(free_) > kDependent) append(active);
  }
  answer();
}

void ActiveSet::begin(Level& level, const NullSpace& above, Bounds& bounds, ProjectedRows& rows,
                      double force_weight) {
  level_ = &level, above_ = &above, bounds_ = &bounds, rows_ = &rows, weight_ = force_weight;
  level.prepare(above);
  d_ = level.optimum().size();
  const Index p = d_ + bounds.free_forces();
  for (Matrix* matrix : {&normals_, &basis_, &triangle_}) matrix->resize(p, p);
  for (Vector* v : {&right_, &multiplier_, &share_, &direction_, &s_}) v->resize(p);
  candidate_.resize(p), rest_.resize(p), y_.resize(d_);
  formed_.resize(bounds.count(), p), length_.setConstant(bounds.count(), -1.0);
  is_active_.assign(bounds.count(), 0);
  size_ = 0, pivots_ = 1;
}

void ActiveSet::start_from(const std::vector<ActiveRow>& memory) {
  factor(memory);
  for (Index dropped = size_; dropped > 0;) {
    dropped = 0;
    for (Index k = size_ - 1; k >= 0; --k) {
      if (multiplier_[k] < 0.0) drop(k), ++dropped;
    }
    if (dropped) answer();
  }
}

bool ActiveSet::form(const ActiveRow& active) {
  const double bound = active.side > 0 ? bounds_->lower(active.row) : bounds_->upper(active.row);
  if (!std::isfinite(bound)) return false;
  double& length = length_[active.row];
  if (length < 0.0) {  // once a level, however often the row comes and goes
    const Index q = candidate_.size() - d_;
    candidate_.head(d_) =
        rows_->take(active.row, weight_, *bounds_, *above_, candidate_.tail(q));
    level_->whiten(candidate_.head(d_));
    length = candidate_.norm();
    formed_.row(active.row) = candidate_;
  }
  if (!(length > kNoLength)) return false;
  candidate_ = formed_.row(active.row) * (active.side / length);
  candidate_right_ = active.side * (bound - base_[active.row]) / length;
  return true;
}

void ActiveSet::split_candidate() {
  rest_ = candidate_;
  share_.head(size_).setZero();
  if (size_ == 0) {
    free_ = rest_.squaredNorm();
    return;
  }
  const auto basis = basis_.topRows(size_);
  double before = 1.0;
  for (int pass = 0; pass < 2; ++pass) {
    times(basis, rest_, direction_);
    add_rows(basis, direction_, -1.0, rest_);
    share_.head(size_) += direction_.head(size_);
    free_ = rest_.squaredNorm();
    if (free_ > kCancelled * before) break;  // else rounding is no small part of the rest
    before = free_;
  }
}

void ActiveSet::append(const ActiveRow& active) {
  const double length = std::sqrt(free_);
  normals_.row(size_) = candidate_;
  right_[size_] = candidate_right_;
  basis_.row(size_) = rest_ * (1.0 / length);
  triangle_.col(size_).head(size_) = share_.head(size_);
  triangle_(size_, size_) = length;
  active_.push_back(active);
  is_active_[active.row] = 1;
  ++size_;
}

void ActiveSet::drop(Index k) {
  is_active_[active_[k].row] = 0;
  active_.erase(active_.begin() + k);
  --size_;
  for (Index c = k; c < size_; ++c) {
    normals_.row(c) = normals_.row(c + 1);
    right_[c] = right_[c + 1];
    multiplier_[c] = multiplier_[c + 1];
    triangle_.col(c).head(c + 2) = triangle_.col(c + 1).head(c + 2);
  }
  for (Index c = k; c < size_; ++c) {  // R is triangular again, Q follows
    const double length = std::hypot(triangle_(c, c), triangle_(c + 1, c));
    const double cosine = triangle_(c, c) / length, sine = triangle_(c + 1, c) / length;
    triangle_(c, c) = length, triangle_(c + 1, c) = 0.0;
    const auto rotate = [cosine, sine](double& upper, double& under) {
      const double kept = upper;
      upper = cosine * kept + sine * under;
      under = cosine * under - sine * kept;
    };
    for (Index i = c + 1; i < size_; ++i) rotate(triangle_(c, i), triangle_(c + 1, i));
    for (Index i = 0; i < basis_.cols(); ++i) rotate(basis_(c, i), basis_(c + 1, i));
  }
}

void ActiveSet::answer() {
  multiplier_.head(size_) = right_.head(size_);
  divide_by_upper_transposed(triangle_, size_, multiplier_);
  s_.setZero();
  add_rows(basis_.topRows(size_), multiplier_, 1.0, s_);
  divide_by_upper(triangle_, size_, multiplier_);
}

bool ActiveSet::enter(ActiveRow active, Index limit) {
  if (!form(active)) return false;
  double violation = candidate_right_ - candidate_.dot(s_);
  while (pivots_ < limit) {
    ++pivots_;
    split_candidate();
    direction_.head(size_) = share_.head(size_);
    divide_by_upper(triangle_, size_, direction_);
    const bool dependent = size_ == normals_.rows() || !(std::sqrt(free_) > kDependent);
    Index blocking = -1;
    double dual_step = kInfinity;
    for (Index k = 0; k < size_; ++k) {
      if (direction_[k] > 0.0 && multiplier_[k] < dual_step * direction_[k]) {
        blocking = k, dual_step = std::max(multiplier_[k], 0.0) / direction_[k];
      }
    }
    if (dependent && blocking < 0) return false;  // the rows conflict
    const double primal_step = dependent ? kInfinity : std::max(violation, 0.0) / free_;
    if (blocking < 0 && !(primal_step <= dual_step)) return false;  // not a number
    const double step = std::min(dual_step, primal_step);
    multiplier_.head(size_) -= step * direction_.head(size_);
    if (primal_step <= dual_step) {
      append(active);
      return true;
    }
    if (!dependent) violation -= step * free_;
    drop(blocking);
  }
  return false;
}

bool ActiveSet::refine() {
  if (size_ == 0) return true;
  Vector& missing = share_;
  times(normals_.topRows(size_), s_, missing);
  missing.head(size_) = right_.head(size_) - missing.head(size_);
  divide_by_upper_transposed(triangle_, size_, missing);
  add_rows(basis_.topRows(size_), missing, 1.0, s_);
  divide_by_upper(triangle_, size_, missing);
  auto multiplier = multiplier_.head(size_);
  multiplier += missing.head(size_);
  rest_ = s_.transpose();
  add_rows(normals_.topRows(size_), multiplier_, -1.0, rest_);
  return multiplier.minCoeff() >= -kWrongSign * multiplier.maxCoeff() &&
         rest_.norm() <= kStationary * (1.0 + s_.norm());
}

void ActiveSet::evaluate() {
  level_->step(s_.head(d_), *above_, y_);
  y_ += level_->optimum();
  bounds_->evaluate(y_, s_.tail(s_.size() - d_), weight_);
}

}  // namespace ghc
