// The jerk with which position and velocity limits plan, from the torque rate limit (docs/limits.md).
//
// n velocity coordinates, a joints, u = n - a coordinates of a floating base, q contact rows.
#pragma once

#include "matrix.hpp"

namespace ghc {

// G (a, n) = [B^T, 1], where the base follows the joints by x_b = B x_j. B minimizes
// x^T (M + s J^T J) x of each joint's motion: rows J (q, n) of contacts that are on keep their
// points, as far as one joint alone can; without them the base is free. The torques of a
// generalized force w (n,) that the base does not take up by itself are G w.
void base_follows(const ConstMatrix& mass, const ConstMatrix& contacts, Matrix& carried);

class JerkPlan {
 public:
  // r (a,) [Nm/s], read anew at every update: it may change, and must outlive the plan.
  explicit JerkPlan(const ConstVector& rate);

  // The jerk at a state: M (n, n), h (n,), v (n,), motion rows of the contacts that are on (q, n),
  // the time of the state and the control period [s].
  void update(const ConstMatrix& mass, const ConstVector& bias, const ConstVector& velocity,
              const ConstMatrix& contacts, double time, double dt);

  void reset();

  double share = 0.0;  // kappa of the last update
  Vector jerk, drift;  // (a,) [rad/s^3], [Nm/s]
  Matrix carried;      // (a, n) G

 private:
  void measure(const ConstMatrix& mass, const ConstVector& bias, const ConstVector& velocity,
               double time, double dt);
  void share_rate(const ConstMatrix& mass);

  ConstVector rate_;
  bool seen_ = false;  // the state before:
  double time_ = 0.0;
  Vector velocity_, bias_, change_;
  Matrix mass_, moved_, inertia_;
};

}  // namespace ghc
