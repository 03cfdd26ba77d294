// Last stage of a torque: finite, within the rate limit, and inside the torque limits.
#pragma once

#include "matrix.hpp"

namespace ghc {

struct Excess {
  double limit = 0.0, rate = 0.0;  // [Nm] largest one of what was asked for
  double broken = 0.0;             // [Nm] over the rate of what is left: the limits win
};

// Clip a torque (a,) to its change from `previous` (a,) per control period, then to the limits;
// without `previous` to the limits alone. `limit` and `step` are inf where there is none.
Excess clip_torque(const ConstVector& torque, const double* previous, const ConstVector& limit,
                   const ConstVector& step, double* out);

bool all_finite(const ConstVector& values);

}  // namespace ghc
