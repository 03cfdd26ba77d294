#include "known_set.hpp"

#include <algorithm>
#include <cmath>

#include "row_kernels.hpp"

namespace ghc {
namespace {

constexpr Index kChanges = 8;       // rows that may enter
constexpr double kApart = 1e-8;     // [-] square of what is left of a row on the others
constexpr double kAtBound = 1e-11;  // [-] over its length: an active row is at its bound
constexpr double kNear = 1e-9;      // [-] alike, after a refinement

void reserve(Matrix& matrix, Index rows, Index cols) {
  if (matrix.rows() < rows || matrix.cols() < cols) {
    matrix.resize(std::max(matrix.rows(), rows), std::max(matrix.cols(), cols));
  }
}

}  // namespace

bool KnownSet::solve(const Task& task, std::vector<ActiveRow>& set, Index limit, Vector& y) {
  if (static_cast<Index>(set.size()) > task.bounds.count()) return false;
  begin(task, static_cast<Index>(set.size()));
  for (const ActiveRow& active : set) add(active);
  complete();
  bool first = true;
  for (Index changes = 0;;) {
    if (!factor()) return false;
    multiplier_.head(order_.size()).setZero();
    for (size_t k = 0; k < order_.size(); ++k) {
      const ActiveRow& active = slots_[order_[k]].active;
      const double bound =
          active.side > 0 ? task.bounds.lower(active.row) : task.bounds.upper(active.row);
      right_[k] = active.side * (bound - task.base[active.row]) * slots_[order_[k]].inverse;
    }
    divide();
    if (drop_wrong()) {
      if (!first) ++pivots_;
      continue;
    }
    move(y);
    if (!refine(y)) return false;
    const ActiveRow worst = most_violated(task.bounds, is_active_);
    if (worst.side == 0) break;
    first = false;
    if (pivots_ >= limit || changes++ == kChanges || !add(worst)) return false;
    complete();
    ++pivots_;
  }
  if (!(task.bounds.violation() <= kFeasible)) return false;
  set.clear();
  for (const Index slot : order_) set.push_back(slots_[slot].active);
  return true;
}

void KnownSet::begin(const Task& task, Index rows) {
  task_ = &task;
  d_ = task.level.optimum().size(), free_ = task.bounds.free_forces();
  seen_size_ = task.level.seen_rows(), completed_ = 0;
  const Index slots = rows + kChanges + 1;
  reserve(rows_, slots, d_ + free_);
  reserve(seen_, slots, seen_size_), reserve(through_, slots, seen_size_);
  reserve(gram_, slots, slots), reserve(lower_, slots, slots);
  for (Vector* v : {&right_, &multiplier_, &direct_, &met_, &across_}) {
    if (v->size() < slots) v->resize(slots);
  }
  pull_.resize(d_ + free_);
  slots_.clear(), order_.clear();
  is_active_.assign(task.bounds.count(), 0);
  pivots_ = 1;
}

bool KnownSet::add(const ActiveRow& active) {
  if (active.row >= task_->bounds.count() || is_active_[active.row]) return false;
  const double bound =
      active.side > 0 ? task_->bounds.lower(active.row) : task_->bounds.upper(active.row);
  if (!std::isfinite(bound)) return false;
  const Index slot = take(active.row);
  if (slot < 0) return false;
  slots_[slot].active.side = active.side;
  is_active_[active.row] = 1;
  order_.insert(std::upper_bound(order_.begin(), order_.end(), active.row,
                                 [this](Index row, Index other) {
                                   return row < slots_[other].active.row;
                                 }),
                slot);
  return true;
}

Index KnownSet::take(Index row) {
  const Index count = static_cast<Index>(slots_.size());
  for (Index k = 0; k < count; ++k) {
    if (slots_[k].active.row == row) return k;
  }
  if (count == gram_.rows()) return -1;
  auto on_free = rows_.row(count).segment(d_, free_);
  rows_.row(count).head(d_) =
      task_->rows.take(row, task_->force_weight, task_->bounds, task_->above, on_free);
  slots_.push_back({{row, 1}, 0.0, 0.0});
  return count;
}

void KnownSet::complete() {
  const Index count = static_cast<Index>(slots_.size()), first = completed_;
  if (count == first) return;
  completed_ = count;
  Level& level = task_->level;
  level.see(rows_.row(first).data(), rows_.cols(), count - first, task_->above);
  seen_.block(first, 0, count - first, seen_size_) = level.seen().transpose();
  through_.block(first, 0, count - first, seen_size_) = level.through().transpose();
  for (Index n = first; n < count; ++n) {
    const Index row = slots_[n].active.row;
    const double *of_n = rows_.row(n).data(), *seen = seen_.row(n).data();
    dot_rows(rows_.data(), rows_.cols(), n + 1, of_n, d_, direct_.data());
    dot_rows(seen_.data(), seen_.cols(), n + 1, through_.row(n).data(), seen_size_, met_.data());
    // The same product of both, whichever came first.
    const bool in_order = std::none_of(slots_.begin(), slots_.begin() + n, [row](const Slot& slot) {
      return slot.active.row > row;
    });
    if (!in_order) {
      dot_rows(through_.data(), through_.cols(), n + 1, seen, seen_size_, across_.data());
    }
    for (Index k = 0; k <= n; ++k) {
      const double met = slots_[k].active.row <= row ? met_[k] : across_[k];
      double entry = level.product(direct_[k], met);
      if (free_) {
        entry += rows_.row(n).segment(d_, free_).dot(rows_.row(k).segment(d_, free_));
      }
      gram_(k, n) = gram_(n, k) = entry;
    }
    Slot& slot = slots_[n];
    slot.length = std::sqrt(std::max(gram_(n, n), 0.0));
    slot.inverse = slot.length > kNoLength ? 1.0 / slot.length : 0.0;
  }
  order_.erase(std::remove_if(order_.begin(), order_.end(),
                              [this](Index k) {
                                if (slots_[k].length > kNoLength) return false;
                                is_active_[slots_[k].active.row] = 0;
                                return true;
                              }),
               order_.end());
}

bool KnownSet::factor() {
  const Index q = static_cast<Index>(order_.size());
  for (Index r = 0; r < q; ++r) {
    const Slot& of_row = slots_[order_[r]];
    double left = 1.0;
    for (Index c = 0; c < r; ++c) {
      const Slot& of_col = slots_[order_[c]];
      double entry = of_row.active.side * of_col.active.side * gram_(order_[r], order_[c]) *
                     (of_row.inverse * of_col.inverse);
      for (Index k = 0; k < c; ++k) entry -= lower_(r, k) * lower_(c, k);
      entry *= lower_(c, c);  // holds its inverse
      lower_(r, c) = entry;
      left -= entry * entry;
    }
    if (!(left > kApart)) return false;
    lower_(r, r) = 1.0 / std::sqrt(left);
  }
  return true;
}

void KnownSet::divide() {
  const Index q = static_cast<Index>(order_.size());
  for (Index r = 0; r < q; ++r) {
    double met = right_[r];
    for (Index c = 0; c < r; ++c) met -= lower_(r, c) * right_[c];
    right_[r] = met * lower_(r, r);
  }
  for (Index r = q - 1; r >= 0; --r) {
    right_[r] *= lower_(r, r);
    for (Index c = 0; c < r; ++c) right_[c] -= lower_(r, c) * right_[r];
  }
  multiplier_.head(q) += right_.head(q);
}

bool KnownSet::drop_wrong() {
  const Index q = static_cast<Index>(order_.size());
  if (q == 0) return false;
  const double least = -kWrongSign * multiplier_.head(q).maxCoeff();
  Index kept = 0;
  for (Index k = 0; k < q; ++k) {
    if (multiplier_[k] < least || !(least <= 0.0)) {
      is_active_[slots_[order_[k]].active.row] = 0;
    } else {
      order_[kept++] = order_[k];
    }
  }
  order_.resize(kept);
  return kept < q;
}

void KnownSet::move(Vector& y) {
  pull_.setZero();
  for (size_t k = 0; k < order_.size(); ++k) {
    const Slot& slot = slots_[order_[k]];
    const double weight = multiplier_[k] * slot.active.side * slot.inverse;
    add_weighted(rows_.row(order_[k]).data(), 0, 1, &weight, 1.0, d_ + free_, pull_.data());
  }
  task_->level.step_of_pull(pull_.head(d_), task_->above, step_);
  y = task_->level.optimum() + step_;
  task_->bounds.evaluate(y, pull_.tail(free_), task_->force_weight);
}

double KnownSet::miss() {
  double worst = 0.0;
  for (size_t k = 0; k < order_.size(); ++k) {
    const Slot& slot = slots_[order_[k]];
    const ActiveRow& active = slot.active;
    const double bound = active.side > 0 ? task_->bounds.lower(active.row)
                                         : task_->bounds.upper(active.row);
    const double left = bound - task_->bounds.values()[active.row];
    right_[k] = active.side * left * slot.inverse;
    const double size = std::abs(left) / task_->bounds.scale()[active.row];
    if (!(size <= worst)) worst = size;  // NaN stays
  }
  return worst;
}

bool KnownSet::refine(Vector& y) {
  if (miss() <= kAtBound) return true;
  divide();
  move(y);
  if (!(miss() <= kNear)) return false;
  const auto multiplier = multiplier_.head(order_.size());
  return multiplier.minCoeff() >= -kWrongSign * multiplier.maxCoeff();
}

}  // namespace ghc
