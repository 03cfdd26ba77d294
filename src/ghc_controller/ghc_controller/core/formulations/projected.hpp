// Targets, metrics and systems of the formulations that project: `ghc` and `balanced`.
//
// J_i, b_i rows of task i; P_i its generalized projector; w the regularization; k tasks, m rows,
// d (reduced) accelerations. Projectors are (k, d, d).
#pragma once

#include "matrix.hpp"
#include "projectors.hpp"

namespace ghc {

// x0 (d,) = sum_i (J_i P_i)^T (J_i J_i^T + w I)^-1 b_i, b (m,).
void ghc_target(const TaskRows& tasks, const ConstVector& target, const double* projectors,
                double w, Eigen::Ref<Vector> x0);

// Cholesky factor L (d, d) of G = sum P_i P_i - (J_i P_i)^T (J_i J_i^T + w I)^-1 (J_i P_i).
// Exact projectors: P_i P_i = P_i where row i of alpha is strict.
void ghc_factor(const TaskRows& tasks, const double* projectors, double w, bool exact,
                Matrix& factor);

// A (d, d) = sum P_i J_i^T J_i + w I over the tasks that are in.
void balanced_system(const TaskRows& tasks, const double* projectors, double w,
                     Eigen::Ref<Matrix> system);

// x* (d,) of A x* = sum P_i J_i^T b_i; returns a bound on sigma_min(A).
//
// A is not symmetric: intransitive priority networks can bring it near singularity. Below `guard`
// (on 1 / |A^-1|_F <= sigma_min) a damping enters that grows from zero, so that x* stays bounded.
double balanced_target(const TaskRows& tasks, const ConstVector& target, const double* projectors,
                       double w, double guard, Eigen::Ref<Vector> x);

}  // namespace ghc
