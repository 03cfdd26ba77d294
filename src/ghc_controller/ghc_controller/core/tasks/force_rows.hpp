// Rows of a position task that follow a force (tasks/force_control.py).
#pragma once

#include <algorithm>
#include <cmath>

#include "matrix.hpp"

namespace ghc {

struct ForceGains {
  double proportional, integral, damping, threshold;
};

// One of the vectors (m,) of TaskRows each.
struct HybridRows {
  double *error, *velocity, *acceleration, *stiffness, *damping;
};

// Make row i a row at rest with the force error `reference + measured` [N], both along its axis,
// and return w_d. The integral [N s] is advanced by `step` [s]; `share` of the reference is
// commanded by now.
inline double force_row(Index i, double reference, double measured, double share, double step,
                        const ForceGains& gains, double& integral, const HybridRows& rows) {
  rows.error[i] = reference + measured;
  rows.velocity[i] = rows.acceleration[i] = rows.stiffness[i] = 0.0;
  rows.damping[i] = gains.damping;
  const double error = share * reference + measured;
  double wanted = share * reference + share * gains.proportional * error;
  if (gains.integral > 0.0) {
    const double largest = std::max(std::abs(reference), gains.threshold) / gains.integral;
    integral = std::min(std::max(integral + share * step * error, -largest), largest);
    wanted += gains.integral * integral;
  }
  return wanted;
}

}  // namespace ghc
