// Cost on the forces of one contact: small forces, used in proportion to what each contact carries.
//
// base |f|^2 + share (|u - r F|^2 / F_0 + 2 r^T u - |r|^2 F) + task (F - reference)^2, halved, with
// the letters of ForceCost (contacts/force_cost.py): F = e^T f, u = f - e F / p, r and F_0 of the
// forces of the step before.
#pragma once

#include "matrix.hpp"

namespace ghc {

struct ForceWeights {
  double base, share;
  double least;            // [N] F_0 is at least this
  double task, reference;  // of a force task [-], [N]
};

// Forces of least cost, center (c,), and F F^T = H^-1: entries of `factor` are `stride` apart from
// row to row. normal (c,) is e, last (c,) [N] are the forces of the step before.
void force_cost(const ForceWeights& weights, const ConstVector& normal, const ConstVector& last,
                double* center, double* factor, Index stride);

}  // namespace ghc
