// What an answer must meet: boxes on accelerations and torques, general rows, rows on forces.
//
// x = offset + basis y, f = center + gain (residual - B y) + free s_f / weight,
// tau = M_a x + h_a + M_f f. Rows stand in this order: accelerations (n), torques (a), general rows
// on x (g), rows on f (r).
#pragma once

#include "matrix.hpp"

namespace ghc {

// What rows are formed of, once a level meets a bound.
struct RowTerms {
  ConstMatrix torque_matrix;  // (a, d) M_a Z
  ConstMatrix free;           // (c, q) forces that leave the base alone
};

class RowSource {
 public:
  virtual ~RowSource() = default;
  virtual RowTerms rows() = 0;  // computed at the first call of a tick
};

// The problem of one tick after the reduction by its contacts, as ReducedProblem and ForceCenter
// name it. An empty basis stands for the identity.
struct Terms {
  ConstMatrix basis;           // Z (n, d)
  ConstVector offset;          // (n,)
  ConstMatrix mass_of_joints;  // M_a (a, n)
  ConstVector bias_of_joints;  // h_a (a,)
  ConstMatrix torque_force;    // (a, c) M_f
  ConstVector center;          // (c,)
  ConstMatrix gain;            // (c, u); u = 0 on a fixed base
  ConstVector residual;        // (u,)
  ConstMatrix balance_matrix;  // (u, d) B
  ConstMatrix balance_force;   // (u, c)
  ConstMatrix general;         // (g, n)
  ConstMatrix general_force;   // (g, c), or empty
  ConstMatrix force_matrix;    // (r, c)
  ConstVector x_lower, x_upper, tau_lower, tau_upper;
  ConstVector general_lower, general_upper, force_lower, force_upper;
  RowSource* row_source;
};

class Bounds {
 public:
  // Bounds of a tick; the terms must stay where they are until the next one.
  void begin(const Terms& terms);

  // Make ready for `row`, `scale` and forces s_f.
  void prepare();

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
  Index free_forces() const { return free_.cols; }  // after `prepare`
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
  View torque_on_y_, free_;
  double unbalance_ = 0.0;
  bool prepared_ = false;
};

}  // namespace ghc
