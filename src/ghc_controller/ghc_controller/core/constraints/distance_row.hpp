// Distance to a moving obstacle as one row on joint accelerations (constraints/obstacle.py).
#pragma once

#include "matrix.hpp"

namespace ghc {

// Terms of a protected frame, world axes: J (6, n), position (3,), velocity and drift (6,).
struct ProtectedFrame {
  ConstMatrix jacobian;
  const double *position, *velocity, *drift;
};

// Write n . J to row (n,) and return its lower bound.
//
// normal (3,) from the obstacle to the frame; state (3, 3) of the obstacle: position, velocity,
// acceleration; the distance (thesis, eq. 4.1 to 4.3) is kept `dt` [s] ahead.
inline double distance_row(const ProtectedFrame& frame, const double* normal, const double* state,
                           double safe_distance, double dt, double* row) {
  Eigen::Map<RowVector> out(row, frame.jacobian.cols());
  out.setZero();
  double gap = safe_distance, approach = 0.0, drifting = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    out += normal[axis] * frame.jacobian.row(axis);
    gap -= normal[axis] * (frame.position[axis] - state[axis]);
    approach += normal[axis] * (frame.velocity[axis] - state[3 + axis]);
    drifting += normal[axis] * (state[6 + axis] - frame.drift[axis]);
  }
  return 2.0 / (dt * dt) * (gap - approach * dt) + drifting;
}

}  // namespace ghc
