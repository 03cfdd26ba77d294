#include "bounds.hpp"

#include <algorithm>

#include "few_rows.hpp"

namespace ghc {
namespace {

double outside(const Vector& values, const Vector& lower, const Vector& upper) {
  if (values.size() == 0) return 0.0;
  constexpr auto kNan = Eigen::PropagateNaN;  // never inside, whether of a value or of a bound
  const double worst = (lower - values)
                           .cwiseMax<kNan>(values - upper)
                           .maxCoeff<kNan>();
  return worst <= 0.0 ? 0.0 : worst;
}

}  // namespace

void Bounds::begin(const Terms& terms) {
  terms_ = &terms;
  const Index n = terms.x_lower.size(), a = terms.tau_lower.size();
  const Index g = terms.general_lower.size(), r = terms.force_lower.size();
  const Index count = n + a + g + r;
  for (Vector* bound : {&lower_, &upper_, &values_, &scale_}) bound->resize(count);
  lower_ << terms.x_lower, terms.tau_lower, terms.general_lower, terms.force_lower;
  upper_ << terms.x_upper, terms.tau_upper, terms.general_upper, terms.force_upper;
  given_lower_ = lower_, given_upper_ = upper_;
  prepared_ = false;
  x_.resize(n), torque_.resize(a), force_.resize(terms.center.size());
  left_.resize(terms.residual.size()), carried_.resize(left_.size());
}

void Bounds::prepare() {
  if (prepared_) return;
  prepared_ = true;
  const Terms& t = *terms_;
  const RowTerms rows = t.row_source->rows();
  torque_on_y_ = {rows.torque_matrix.data(), rows.torque_matrix.rows(), rows.torque_matrix.cols()};
  free_ = {rows.free.data(), rows.free.rows(), rows.free.cols()};
  const Index n = x_.size(), a = torque_.size();
  const Index g = t.general_lower.size(), r = t.force_lower.size();
  scale_.head(n).setOnes();
  for (Index i = 0; i < a; ++i) scale_[n + i] = rows.torque_matrix.row(i).norm();
  for (Index i = 0; i < g; ++i) scale_[n + a + i] = t.general.row(i).norm();
  for (Index i = 0; i < r; ++i) scale_[n + a + g + i] = t.force_matrix.row(i).norm();
  scale_ = scale_.cwiseMax(1e-9);
}

void Bounds::evaluate(const Eigen::Ref<const Vector>& y,
                      const Eigen::Ref<const Vector>& free_force, double weight) {
  const Terms& t = *terms_;
  const Index n = x_.size(), a = torque_.size(), g = t.general_lower.size();
  if (t.basis.rows()) {
    x_ = t.offset;
    x_.noalias() += t.basis * y;
  } else {
    x_ = y;
  }
  force_ = t.center;
  unbalance_ = 0.0;
  if (left_.size()) {
    left_ = t.residual;
    left_.noalias() -= t.balance_matrix * y;
    force_.noalias() += t.gain * left_;
    left_.noalias() -= t.balance_force * (force_ - t.center);
    unbalance_ = left_.cwiseAbs().maxCoeff();
  }
  if (free_force.size()) force_.noalias() += free_.matrix() * free_force / weight;
  times(t.mass_of_joints, x_, torque_);
  torque_ += t.bias_of_joints;
  if (force_.size()) torque_.noalias() += t.torque_force * force_;
  values_.head(n) = x_;
  values_.segment(n, a) = torque_;
  if (g) values_.segment(n + a, g).noalias() = t.general * x_;
  if (t.general_force.size()) values_.segment(n + a, g).noalias() += t.general_force * force_;
  const Index r = t.force_lower.size();
  if (r) values_.tail(r).noalias() = t.force_matrix * force_;
}

bool Bounds::inside() const {
  return balanced() && violation() <= 0.0;
}

double Bounds::violation() const { return outside(values_, lower_, upper_); }

double Bounds::violation_of_given() const {
  return std::max(outside(values_, given_lower_, given_upper_), unbalance_);
}

void Bounds::widen() {
  lower_ = lower_.cwiseMin((values_.array() - kKept).matrix());
  upper_ = upper_.cwiseMax((values_.array() + kKept).matrix());
}

void Bounds::row(Index i, double weight, Eigen::Ref<RowVector> on_y,
                 Eigen::Ref<RowVector> on_free) {
  const Terms& t = *terms_;
  const Index n = x_.size(), a = torque_.size(), g = t.general_lower.size();
  on_free.setZero();
  if (i < n) {
    if (t.basis.rows()) {
      on_y = t.basis.row(i);
    } else {
      on_y.setZero();
      on_y[i] = 1.0;
    }
  } else if (i < n + a) {
    on_y = torque_on_y_.matrix().row(i - n);
    if (force_.size()) add_force_row(t.torque_force.row(i - n), weight, on_y, on_free);
  } else if (i < n + a + g) {
    if (t.basis.rows()) {
      on_y.noalias() = t.general.row(i - n - a) * t.basis;
    } else {
      on_y = t.general.row(i - n - a);
    }
    if (t.general_force.size()) add_force_row(t.general_force.row(i - n - a), weight, on_y, on_free);
  } else {
    on_y.setZero();
    add_force_row(t.force_matrix.row(i - n - a - g), weight, on_y, on_free);
  }
}

void Bounds::add_force_row(const Eigen::Ref<const RowVector>& on_force, double weight,
                           Eigen::Ref<RowVector> on_y, Eigen::Ref<RowVector> on_free) {
  const Terms& t = *terms_;
  if (on_free.size()) on_free.noalias() = on_force * free_.matrix() / weight;
  if (left_.size()) {
    carried_.noalias() = on_force * t.gain;
    on_y.noalias() -= carried_ * t.balance_matrix;
  }
}

}  // namespace ghc
