// The control problem in accelerations y that keep every contact and that forces can balance.
//
// x = offset + basis y removes what would break a contact (thesis, eq. 5.1), so that a task of
// high priority is never asked to move one. Of a floating base, forces of least cost carry the
// accelerations: f*(y) = f_0 + gain (residual - B y), and free s_f leaves the base alone.
#pragma once

#include "bounds.hpp"
#include "matrix.hpp"
#include "null_motion.hpp"
#include "problem.hpp"

namespace ghc {

class Reduction : public RowSource {
 public:
  // Remove what would break a contact. The arrays of the problem must stay where they are.
  void keep_contacts(const Problem& problem);

  // After it: forces that balance the base. In flight, or with contacts too few to carry every
  // direction, N^T M_u y = N^T rhs with N the left null space of the balance force is level 0:
  // what remains of y are motions that conserve momentum along N.
  void balance();

  // After it: the forces that balance the base at another cost on them.
  void expand(const Problem& problem, const ForceExpansion& cost);

  ConstMatrix jacobian() const { return jacobian_.matrix(); }  // (m, d)
  ConstVector target() const { return target_.vector(); }      // (m,)

  // Terms of the core, with the torque limits as the bounds on torques.
  Terms terms(const Problem& problem);

  // M_a Z and the free forces, which are formed where a level meets a bound.
  RowTerms rows() override;

  // y (d,) of accelerations x (n,) of which the basis keeps what the contacts allow.
  void coordinates(const Eigen::Ref<const Vector>& x, Vector& y) const;

  View basis, offset;                               // (n, d), (n,); empty: identity and zero
  View mass_of_joints, bias_of_joints;              // (a, n), (a,)
  View torque_force;                                // (a, c)
  View balance_matrix, balance_force, balance_target;  // (u, d), (u, c), (u,)
  View center, gain, residual;                      // (c,), (c, u), (u,)

 private:
  void drop_uncarried(const Eigen::Ref<const Matrix>& uncarried,
                      const Eigen::Ref<const Matrix>& carried);

  View jacobian_, target_, factor_;
  NullMotion motion_, forces_, momentum_;
  Matrix rows_, force_, basis_, torque_matrix_, balance_matrix_, balance_force_;
  Matrix whitened_, gram_, inverse_, gain_, free_;
  Vector goals_, offset_, balance_target_, residual_, none_;
  bool formed_ = false, free_formed_ = false, free_by_reflections_ = false;
  bool fixed_base_ = true, dropped_ = false;
};

}  // namespace ghc
