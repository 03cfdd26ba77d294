// Generalized projectors of the GHC paper (algorithms 1 and 2).
#pragma once

#include <cstdint>

#include "matrix.hpp"

namespace ghc {

// Rows of k tasks, and their priorities.
struct TaskRows {
  ConstMatrix jacobian;        // (m, d), eq. 10
  const std::int64_t* starts;  // (k + 1,) first row of each task; the last one ends the rows
  ConstMatrix alpha;           // (k, k)

  Index count() const { return alpha.rows(); }
  auto rows(Index i) const { return jacobian.middleRows(starts[i], starts[i + 1] - starts[i]); }
};

struct ProjectorRule {
  double rank_tolerance;  // [-] of a row's norm: what is left of it counts as a direction
  double damping;         // e of damped layers, 0: exact
};

// P_i = I - B^T A^{r,s} B (eq. 11); writes `out` (k, d, d).
//
// Without damping B comes from two-pass Gram-Schmidt. With damping e > 0 it is L^-1 J of
// L L^T = J J^T + e^2 I over the rows in their order (of rows longer than 1, e in proportion):
// the first l tasks then give J_l^T (J_l J_l^T + e^2 I)^-1 J_l, which is continuous in q through
// rank changes.
//
// Tasks with alpha = 0 come last and enter with coefficient 0: they are not looked at. The basis
// of one task is continued for the next one as far as their tasks agree. A posture of all joints
// completes the exact basis: its directions are all that is left, which needs no Gram-Schmidt.
void write_projectors(const TaskRows& tasks, const ProjectorRule& rule, double* out);

}  // namespace ghc
