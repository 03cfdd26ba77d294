#include "known_set.hpp"

#include <algorithm>
#include <cmath>

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
  bool first = true;
  for (Index changes = 0;;) {
    if (!factor()) return false;
    multiplier_.head(order_.size()).setZero();
    for (size_t k = 0; k < order_.size(); ++k) {
      const ActiveRow& active = slots_[order_[k]].active;
      const double bound =
          active.side > 0 ? task.bounds.lower(active.row) : task.bounds.upper(active.row);
      right_[k] = active.side * (bound - task.base[active.row]) / slots_[order_[k]].length;
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
  seen_size_ = task.level.seen();
  const Index slots = rows + kChanges + 1;
  reserve(rows_, slots, d_ + free_);
  reserve(seen_, slots, seen_size_), reserve(through_, slots, seen_size_);
  reserve(gram_, slots, slots), reserve(lower_, slots, slots);
  for (Vector* v : {&right_, &multiplier_}) {
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
  const Index slot = form(active.row);
  if (slot < 0 || !(slots_[slot].length > kNoLength)) return false;
  slots_[slot].active.side = active.side;
  is_active_[active.row] = 1;
  order_.insert(std::upper_bound(order_.begin(), order_.end(), active.row,
                                 [this](Index row, Index other) {
                                   return row < slots_[other].active.row;
                                 }),
                slot);
  return true;
}

Index KnownSet::form(Index row) {
  const Index count = static_cast<Index>(slots_.size());
  for (Index k = 0; k < count; ++k) {
    if (slots_[k].active.row == row) return k;
  }
  if (count == gram_.rows()) return -1;
  Level& level = task_->level;
  auto on_y = rows_.row(count).head(d_);
  auto on_free = rows_.row(count).segment(d_, free_);
  on_y = task_->rows.take(row, task_->force_weight, task_->bounds, task_->above, on_free);
  auto seen = seen_.row(count).head(seen_size_), through = through_.row(count).head(seen_size_);
  level.see(on_y, task_->above, seen, through);
  slots_.push_back({{row, 1}, 0.0});
  for (Index k = 0; k <= count; ++k) {
    const bool after = slots_[k].active.row <= row;  // the same of both, whichever came first
    const double met = level.through(after ? seen_.row(k).data() : seen.data(),
                                     after ? through.data() : through_.row(k).data(),
                                     on_y.dot(rows_.row(k).head(d_)));
    gram_(k, count) = gram_(count, k) =
        free_ ? met + on_free.dot(rows_.row(k).segment(d_, free_)) : met;
  }
  slots_[count].length = std::sqrt(std::max(gram_(count, count), 0.0));
  return count;
}

bool KnownSet::factor() {
  const Index q = static_cast<Index>(order_.size());
  for (Index r = 0; r < q; ++r) {
    const Slot& of_row = slots_[order_[r]];
    double left = 1.0;
    for (Index c = 0; c < r; ++c) {
      const Slot& of_col = slots_[order_[c]];
      double entry = of_row.active.side * of_col.active.side * gram_(order_[r], order_[c]) /
                     (of_row.length * of_col.length);
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
    pull_ += (multiplier_[k] * slot.active.side / slot.length) *
             ConstVector(rows_.row(order_[k]).data(), d_ + free_);
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
    right_[k] = active.side * left / slot.length;
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
