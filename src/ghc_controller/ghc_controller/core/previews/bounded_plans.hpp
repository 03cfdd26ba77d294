// The QPs of previews (thesis, eq. 4.14, 4.15 and 5.6 to 5.8), solved by their structure.
#pragma once

#include <vector>

#include "matrix.hpp"

namespace ghc {

// Motion of a virtual obstacle along one axis over a horizon.
//
//   min  sum_j d_j (x_j - raw_j)^2 + gamma jerk_j^2      s.t.  x_j <= limit_j
//   with x_{j+1} from the triple integrator of eq. 4.11
//
// D changes the Hessian at each tick, so no inverse can be kept. Instead a Riccati recursion along
// the chain solves the problem for any linear term in O(N).
class MotionPlan {
 public:
  MotionPlan(double step, const ConstVector& weights, double jerk_weight);

  // Jerks (N,) from start (3,): position, velocity, acceleration. False: no optimum was found.
  bool solve(const double* start, const ConstVector& raw, const ConstVector& limit,
             Eigen::Ref<Vector> jerk);

 private:
  // Feedback on position, velocity and acceleration, and 1 / curvature.
  struct Gain {
    double position, velocity, acceleration, inverse;
  };

  void factor(double jerk_weight);

  // Optimal motion from `start` for the cost -linear^T x.
  void respond(const double* start, const Vector& linear, Vector& positions, Vector& jerk) const;

  double step_, b0_, b1_, half_;
  Vector weights_;
  std::vector<Gain> gains_;
};

// Both force bounds of one contact over a horizon.
//
//   min  sum_j (upper_j - Fmax_j)^2 + alpha rate_upper_j^2
//            + (lower_j - Fmin_j)^2 + beta rate_lower_j^2
//   s.t. Fmin_j <= lower_j <= upper_j <= Fmax_j,      rate_j = (bound_{j+1} - bound_j) / T
//
// inverses: (N, N) of the two Hessians, of the upper and of the lower bound; pulls: weights of the
// rates over T^2. Writes the upper bound above the lower one, (2, N). False: no optimum was found.
bool plan_force_bounds(const ConstMatrix& inverse_upper, const ConstMatrix& inverse_lower,
                       const double* pulls, double lower_now, double upper_now,
                       const ConstVector& raw_lower, const ConstVector& raw_upper,
                       Eigen::Ref<Matrix> out);

}  // namespace ghc
