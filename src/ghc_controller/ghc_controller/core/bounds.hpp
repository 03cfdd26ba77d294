// What an answer must meet: boxes on accelerations and torques, general rows, rows on forces.
//
// x = offset + basis y, f = center + gain (residual - B y) + free s_f / weight,
// tau = M' y + h' + M_f f. Rows stand in this order: accelerations (n), torques (a), general rows
// on x (g), rows on f (r).
#pragma once

#include "matrix.hpp"

namespace ghc {

// The problem of one tick after the reduction by its contacts, as ReducedProblem and ForceCenter
// name it. An empty basis stands for the identity.
struct Terms {
  ConstMatrix basis;           // (n, d)
  ConstVector offset;          // (n,)
  ConstMatrix torque_matrix;   // (a, d) M'
  ConstVector torque_offset;   // (a,) h'
  ConstMatrix torque_force;    // (a, c) M_f
  ConstVector center;          // (c,)
  ConstMatrix gain;            // (c, u); u = 0 on a fixed base
  ConstMatrix free;            // (c, q) forces that leave the base alone
  ConstVector residual;        // (u,)
  ConstMatrix balance_matrix;  // (u, d) B
  ConstMatrix balance_force;   // (u, c)
  ConstMatrix general;         // (g, n)
  ConstMatrix force_matrix;    // (r, c)
  ConstVector x_lower, x_upper, tau_lower, tau_upper;
  ConstVector general_lower, general_upper, force_lower, force_upper;
};

class Bounds {
 public:
  // Bounds of a tick; the terms must stay where they are until the next one.
  void begin(const Terms& terms);

  // x, f, tau and the value of every row at y (d,) and s_f (q,), which may be empty for zero.
  void evaluate(const Eigen::Ref<const Vector>& y, const Eigen::Ref<const Vector>& free_force,
                double weight);

  // Whether the last point evaluated meets every bound and balances the base.
  bool inside() const;
  bool balanced() const { return unbalance_ <= kBalanced; }

  // Largest violation of the bounds as they are now, or as they were given; NaN stays NaN.
  double violation() const;
  double violation_of_given() const;

  // Widen the bounds to contain the last point evaluated: the level below can then keep it.
  void widen();

  // Row i on y (d,) with the forces that follow from y, and on s_f (q,).
  void row(Index i, double weight, Eigen::Ref<RowVector> on_y, Eigen::Ref<RowVector> on_free);

  Index count() const { return lower_.size(); }
  Index free_forces() const { return terms_->free.cols(); }
  double lower(Index i) const { return lower_[i]; }
  double upper(Index i) const { return upper_[i]; }
  const Vector& values() const { return values_; }
  const Vector& scale() const { return scale_; }  // (count,) lengths of the rows on x, y or f
  const Vector& x() const { return x_; }
  const Vector& torque() const { return torque_; }
  const Vector& force() const { return force_; }

 private:
  static constexpr double kBalanced = 1e-6;  // [N], [Nm] left of the equations of motion
  static constexpr double kKept = 2e-8;      // [rad/s^2], [Nm], [N] by which an answer is contained

  void add_force_row(const Eigen::Ref<const RowVector>& on_force, double weight,
                     Eigen::Ref<RowVector> on_y, Eigen::Ref<RowVector> on_free);

  const Terms* terms_ = nullptr;
  Vector lower_, upper_, given_lower_, given_upper_, values_, scale_;
  Vector x_, torque_, force_, left_;
  RowVector carried_;
  double unbalance_ = 0.0;
};

}  // namespace ghc
