// Rows of the bounds in the null space of the levels above, kept while a tick goes down its levels.
//
// V only grows from level to level, so a row P that a level above has formed goes on from there,
// and comes out as if it were formed anew.
#pragma once

#include <vector>

#include "bounds.hpp"
#include "null_space.hpp"

namespace ghc {

class ProjectedRows {
 public:
  // Forget all rows: of `count` bounds in d coordinates.
  void reset(Index count, Index d) {
    begun_.assign(count, -1);
    given_.resize(count, d), projected_.resize(count, d);
  }

  // Row i on y, projected (d,), and as it is on s_f (q,) at a weight.
  auto take(Index i, double weight, Bounds& bounds, const NullSpace& above,
            Eigen::Ref<RowVector> on_free) {
    if (begun_[i] < 0 || on_free.size()) bounds.row(i, weight, given_.row(i), on_free);
    if (begun_[i] < 0) projected_.row(i) = given_.row(i), begun_[i] = 0;
    above.project_on(given_.row(i), begun_[i], projected_.row(i));
    begun_[i] = above.used();
    return projected_.row(i);
  }

 private:
  Matrix given_, projected_;
  std::vector<Index> begun_;  // rows of V that are taken off already, -1: none was formed
};

}  // namespace ghc
