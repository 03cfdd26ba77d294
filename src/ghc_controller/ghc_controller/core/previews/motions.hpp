// Motions over a horizon: polynomials of references, triple integrators, points of previews.
#pragma once

#include "matrix.hpp"

namespace ghc {

// Value, first and second derivative at s of polynomials sum_k c_k s^k, c (6, m); writes (3, m).
void evaluate_polynomial(const ConstMatrix& coefficients, double s, Eigen::Ref<Matrix> out);

// Quaternion (x, y, z, w), angular velocity and acceleration in world axes (3,) of start exp(p(t))
// at p, its rate and its change (3,); numerics/rotation.py has the formulas.
void turned_motion(const double* start, const double* p, const double* rate, const double* change,
                   double* quaternion, double* velocity, double* acceleration);

// States (N + 1, 9) of three triple integrators under jerks (N, 3) held over steps [s]; a state is
// position, velocity and acceleration, each (3,).
void integrate_jerks(const double* state, const ConstMatrix& jerk, double step,
                     Eigen::Ref<Matrix> states);

// The state (9,) `elapsed` [s] after the first one; after the last step it rests.
void state_after(const double* state, const ConstMatrix& jerk, double step, double elapsed,
                 double* out);

// Bounds (r,) at a place [points from the first] of points (r, N + 1): straight lines between
// points, or each point until the next one.
void bounds_at(const ConstMatrix& lower, const ConstMatrix& upper, double place, bool interpolate,
               double* low, double* high);

// Rate and acceleration (r,) at a place [points from the first] of points (r, N + 1), N >= 4.
//
// Exact for points of a chain of three integrators whose jerk is the same over some steps;
// neither jumps inside a preview.
void motion_of_points(const ConstMatrix& points, double place, double step, double* rate,
                      double* acceleration);

struct MotionLimits {
  const double *lower, *upper, *velocity, *acceleration, *jerk;  // (n,)
};

// Fill states (s, 3, n) of joints from `first` on, each 1 ms after the one before.
//
// v_d = rate + k_1 e, near the goal linear, else as braking with a share of the limit allows;
// a = k_2 (v_d - v). A velocity v' is allowed if braking from it ends before the position limit:
// q + v h / 2 + v' h + v'^2 / 2 A <= upper, which braking by A h per step preserves. That comes
// before the jerk limit.
//
// d = max(abs(e), 0.1 s abs(rate - v)): a change by at most jerk max(1, (0.01 / d)^2) h per step,
// with e and v as they will be once a has gone down to that of braking; rate min(1, (0.06 / d)^2).
void move_joints(double* rows, Index count, Index n, Index first, const double* goal,
                 const double* rate, const MotionLimits& limits, bool brake);

}  // namespace ghc
