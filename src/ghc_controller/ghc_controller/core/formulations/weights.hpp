// Weights of tasks by priority, and the least-squares system that they make.
#pragma once

#include "matrix.hpp"
#include "projectors.hpp"

namespace ghc {

// gamma_i (k,) = (1 - alpha_ii) r^(s_i), s_i = sum_j alpha_ji over active j != i.
//
// r is `ratio`, or less where many tasks are in: no gamma_i exceeds `spread`. Continuous in alpha,
// since the largest s_i is.
void priority_weights(const ConstMatrix& alpha, double ratio, double spread,
                      Eigen::Ref<Vector> weights);

// H (d, d) = sum_i gamma_i J_i^T J_i + damping I and right (d,) = sum_i gamma_i J_i^T b_i.
void weighted_system(const TaskRows& tasks, const ConstVector& target, const Vector& weights,
                     double damping, Eigen::Ref<Matrix> hessian, Eigen::Ref<Vector> right);

}  // namespace ghc
