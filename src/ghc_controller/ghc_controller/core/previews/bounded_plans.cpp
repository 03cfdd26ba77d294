#include "bounded_plans.hpp"

#include "working_set.hpp"

namespace ghc {
namespace {

constexpr double kAcceptedShare = 10.0;  // of the feasibility, of a motion that is computed anew

}  // namespace

MotionPlan::MotionPlan(double step, const ConstVector& weights, double jerk_weight)
    : step_(step),
      b0_(step * step * step / 6.0),
      b1_(step * step / 2.0),
      half_(step * step / 2.0),
      weights_(weights),
      gains_(static_cast<size_t>(weights.size())) {
  factor(jerk_weight);
}

void MotionPlan::factor(double jerk_weight) {
  const double T = step_, b0 = b0_, b1 = b1_, b2 = step_, half = half_;
  double v00 = 0, v01 = 0, v02 = 0, v11 = 0, v12 = 0, v22 = 0;  // the value, symmetric
  for (size_t j = gains_.size(); j-- > 0;) {
    v00 += weights_[static_cast<Index>(j)];
    const double w0 = v00 * b0 + v01 * b1 + v02 * b2;
    const double w1 = v01 * b0 + v11 * b1 + v12 * b2;
    const double w2 = v02 * b0 + v12 * b1 + v22 * b2;
    const double inverse = 1.0 / (jerk_weight + b0 * w0 + b1 * w1 + b2 * w2);
    const double c0 = w0, c1 = w0 * T + w1, c2 = w0 * half + w1 * T + w2;  // B^T V A
    gains_[j] = {c0 * inverse, c1 * inverse, c2 * inverse, inverse};
    // V <- A^T V A - c c^T / curvature
    const double a01 = v00 * T + v01, a02 = v00 * half + v01 * T + v02;
    const double a11 = v01 * T + v11, a12 = v01 * half + v11 * T + v12;
    const double a22 = v02 * half + v12 * T + v22;
    const double n11 = T * a01 + a11, n12 = T * a02 + a12, n22 = half * a02 + T * a12 + a22;
    v00 -= c0 * c0 * inverse;
    v01 = a01 - c0 * c1 * inverse;
    v02 = a02 - c0 * c2 * inverse;
    v11 = n11 - c1 * c1 * inverse;
    v12 = n12 - c1 * c2 * inverse;
    v22 = n22 - c2 * c2 * inverse;
  }
}

void MotionPlan::respond(const double* start, const Vector& linear, Vector& positions,
                         Vector& jerk) const {
  double p0 = 0, p1 = 0, p2 = 0;  // the costate
  for (Index j = linear.size() - 1; j >= 0; --j) {
    const Gain& gain = gains_[static_cast<size_t>(j)];
    p0 += linear[j];
    const double forward = b0_ * p0 + b1_ * p1 + step_ * p2;
    jerk[j] = forward * gain.inverse;
    const double q0 = p0, q1 = p0 * step_ + p1, q2 = p0 * half_ + p1 * step_ + p2;  // A^T p
    p0 = q0 - gain.position * forward;
    p1 = q1 - gain.velocity * forward;
    p2 = q2 - gain.acceleration * forward;
  }
  double x0 = start[0], x1 = start[1], x2 = start[2];
  for (Index j = 0; j < linear.size(); ++j) {
    const Gain& gain = gains_[static_cast<size_t>(j)];
    const double u =
        jerk[j] - (gain.position * x0 + gain.velocity * x1 + gain.acceleration * x2);
    jerk[j] = u;
    x0 += step_ * x1 + half_ * x2 + b0_ * u;
    x1 += step_ * x2 + b1_ * u;
    x2 += step_ * u;
    positions[j] = x0;
  }
}

bool MotionPlan::solve(const double* start, const ConstVector& raw, const ConstVector& limit,
                       Eigen::Ref<Vector> out) {
  const Index steps = raw.size();
  const double rest[3] = {0.0, 0.0, 0.0};
  Vector positions(steps), jerk(steps), linear = weights_.cwiseProduct(raw);
  respond(start, linear, positions, jerk);
  out = jerk;
  WorkingSet active(positions, limit);
  Vector unit, column(steps), unused(steps);
  for (int change = 0; change < WorkingSet::kMaxChanges; ++change) {
    const Index row = active.most_violated();
    if (row < 0) break;
    if (active.full()) return false;
    unit = Vector::Unit(steps, row);
    respond(rest, unit, column, unused);
    if (!active.take_in(row, column)) return false;
  }
  if (active.count() == 0) return active.most_violated() < 0;
  for (Index k = 0; k < active.count(); ++k) linear[active.row(k)] -= active.multiplier(k);
  respond(start, linear, positions, jerk);
  out = jerk;
  return active.most_violated(positions, kAcceptedShare) < 0;
}

bool plan_force_bounds(const ConstMatrix& inverse_upper, const ConstMatrix& inverse_lower,
                       const double* pulls, double lower_now, double upper_now,
                       const ConstVector& raw_lower, const ConstVector& raw_upper,
                       Eigen::Ref<Matrix> out) {
  const Index steps = raw_upper.size();
  Vector upper = raw_upper, lower = raw_lower;
  upper[0] += pulls[0] * upper_now;
  lower[0] += pulls[1] * lower_now;
  out.row(0).noalias() = (inverse_upper * upper).transpose();
  out.row(1).noalias() = (inverse_lower * lower).transpose();
  Vector y(3 * steps), bound(3 * steps);  // rows: upper, -lower, lower - upper
  y << out.row(0).transpose(), -out.row(1).transpose(), (out.row(1) - out.row(0)).transpose();
  bound << raw_upper, -raw_lower, Vector::Zero(steps);
  WorkingSet active(y, bound);
  Vector column(3 * steps);
  for (int change = 0; change < WorkingSet::kMaxChanges; ++change) {
    const Index row = active.most_violated();
    if (row < 0) {
      out.row(0) = active.y().head(steps).transpose();
      out.row(1) = -active.y().segment(steps, steps).transpose();
      return true;
    }
    if (active.full()) return false;
    // C H^-1 C^T of the row: what one unit of it moves both bounds by.
    const Index kind = row / steps, point = row % steps;
    const double on_upper = kind == 0 ? 1.0 : kind == 1 ? 0.0 : -1.0;
    const double on_lower = kind == 0 ? 0.0 : kind == 1 ? -1.0 : 1.0;
    upper = on_upper * inverse_upper.col(point), lower = on_lower * inverse_lower.col(point);
    column << upper, -lower, lower - upper;
    if (!active.take_in(row, column)) return false;
  }
  return false;
}

}  // namespace ghc
