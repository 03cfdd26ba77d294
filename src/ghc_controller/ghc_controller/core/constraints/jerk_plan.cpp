#include "jerk_plan.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace ghc {
namespace {

constexpr double kDriftMemory = 0.05;     // [s] time constant with which a measured drift fades
constexpr double kLongest = 1.5;     // [-] control periods between two states that are compared
constexpr double kContactStiffness = 1e4;   // [-] of a contact, over the largest inertia of the base
constexpr double kLeastLeft = 0.1;   // [-] of the rate that is planned with, however fast the
                                     // dynamics change

}  // namespace

void base_follows(const ConstMatrix& mass, const ConstMatrix& contacts, Matrix& carried) {
  const Index a = carried.rows(), u = mass.rows() - a;
  carried.rightCols(a).setIdentity();
  if (u == 0) return;
  Matrix base = mass.topRows(u);
  if (contacts.rows()) {
    const double stiffness = kContactStiffness * mass.diagonal().head(u).maxCoeff();
    base.noalias() += stiffness * contacts.leftCols(u).transpose() * contacts;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(base.leftCols(u));
  carried.leftCols(u) = -factor.solve(base.rightCols(a)).transpose();
}

JerkPlan::JerkPlan(const ConstVector& rate) : rate_(rate) {
  jerk = drift = Vector::Zero(rate_.size());
}

void JerkPlan::reset() {
  seen_ = false;
  drift.setZero();
}

void JerkPlan::update(const ConstMatrix& mass, const ConstVector& bias,
                      const ConstVector& velocity, const ConstMatrix& contacts, double time,
                      double dt) {
  base_follows(mass, contacts, carried);
  measure(mass, bias, velocity, time, dt);
  share_rate(mass);
}

// Drift of the torques at constant acceleration, G (dM/dt x + dh/dt), between the last two states.
void JerkPlan::measure(const ConstMatrix& mass, const ConstVector& bias,
                       const ConstVector& velocity, double time, double dt) {
  drift *= std::exp(-dt / kDriftMemory);
  const double period = time - time_;
  if (seen_ && period > 0.0 && period < kLongest * dt) {
    velocity_ = (velocity - velocity_) / period;  // acceleration
    mass_ = mass - mass_;
    change_ = bias - bias_;
    change_.noalias() += mass_ * velocity_;
    const Vector now = (carried * change_).cwiseAbs() / period;
    if (now.allFinite()) drift = drift.cwiseMax(now);
  }
  seen_ = true, time_ = time, velocity_ = velocity, bias_ = bias, mass_ = mass;
}

// jerk_k = kappa r_k / T_kk with the largest kappa for which |T| jerk <= r - |drift|; T = G M G^T
// is the inertia of the joints with the base following.
void JerkPlan::share_rate(const ConstMatrix& mass) {
  const Index a = rate_.size(), u = mass.rows() - a;
  if (u) {
    moved_.noalias() = carried * mass;
    inertia_.noalias() = moved_ * carried.transpose();
  } else {
    inertia_ = mass;
  }
  jerk = rate_.cwiseQuotient(inertia_.diagonal());
  share = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < a; ++i) {
    const double left = std::max(rate_[i] - drift[i], kLeastLeft * rate_[i]);
    share = std::min(share, left / inertia_.row(i).cwiseAbs().dot(jerk));
  }
  jerk *= share;
}

}  // namespace ghc
