#include "boxes.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "joint_bounds.hpp"

namespace ghc {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

void around(const double* center, const ConstVector& half_width, double scale, double* lower,
            double* upper) {
  for (Index i = 0; i < half_width.size(); ++i) {
    const double middle = center ? center[i] : 0.0;
    lower[i] = middle - scale * half_width[i];
    upper[i] = middle + scale * half_width[i];
  }
}

}  // namespace

TorqueBox::TorqueBox(const ConstVector& limit, bool around_gravity)
    : JointBox(limit.size()), limit_(limit), around_gravity_(around_gravity) {}

void TorqueBox::set_range(Vector lower, Vector upper) {
  const bool fits = lower.size() == upper.size() && (lower.size() == joints() || !lower.size());
  if (!fits) throw std::invalid_argument("a range (a,) or none expected");
  lower_ = std::move(lower), upper_ = std::move(upper);
}

void TorqueBox::write(const Tick& tick, double* lower, double* upper) const {
  if (lower_.size()) {
    std::copy_n(lower_.data(), joints(), lower);
    std::copy_n(upper_.data(), joints(), upper);
    return;
  }
  around(around_gravity_ ? tick.gravity : nullptr, limit_, 1.0, lower, upper);
}

RateBox::RateBox(const ConstVector& rate) : JointBox(rate.size()), rate_(rate) {}

void RateBox::write(const Tick& tick, double* lower, double* upper) const {
  if (tick.previous_torque) {
    around(tick.previous_torque, rate_, tick.dt, lower, upper);
    return;
  }
  std::fill_n(lower, joints(), -kInf);
  std::fill_n(upper, joints(), kInf);
}

VelocityBox::VelocityBox(const ConstVector& limit, double horizon_in_s)
    : JointBox(limit.size()), horizon(horizon_in_s), limit_(limit) {}

void VelocityBox::write(const Tick& tick, double* lower, double* upper) const {
  const double span = std::max(horizon, tick.dt);
  for (Index i = 0; i < joints(); ++i) {
    const double to_upper = limit_[i] - tick.v[i], to_lower = limit_[i] + tick.v[i];
    lower[i] = -to_lower / span;
    upper[i] = to_upper / span;
    if (!tick.jerk) continue;
    const double jerk = tick.jerk[i];
    if (to_upper > 0.0) upper[i] = std::min(upper[i], velocity_bound(to_upper, jerk, tick.dt));
    if (to_lower > 0.0) lower[i] = std::max(lower[i], -velocity_bound(to_lower, jerk, tick.dt));
  }
}

PositionBox::PositionBox(const ConstVector& brake, double approach_rate)
    : JointBox(brake.size()), brake_(brake), rate_(approach_rate) {
  const Vector none = Vector::Constant(joints(), kInf);
  set_limits({-none, none, Matrix::Zero(2, joints()), Matrix::Zero(2, joints())});
}

void PositionBox::set_limits(MovingLimits limits) {
  const Index a = joints();
  if (limits.lower.size() != a || limits.upper.size() != a || limits.rates.rows() != 2 ||
      limits.rates.cols() != a || limits.accelerations.rows() != 2 ||
      limits.accelerations.cols() != a) {
    throw std::invalid_argument("limits (a,) with rates and accelerations (2, a) expected");
  }
  limits_ = std::move(limits);
}

void PositionBox::write(const Tick& tick, double* lower, double* upper) const {
  const Matrix &w = limits_.rates, &a = limits_.accelerations;
  for (Index i = 0; i < joints(); ++i) {
    const double to_upper = limits_.upper[i] - tick.q[i], to_lower = tick.q[i] - limits_.lower[i];
    const double v = tick.v[i], brake = brake_[i];
    upper[i] = moving_approach(to_upper, v, w(1, i), a(1, i), brake, rate_, tick.dt);
    if (w(1, i) == 0.0 && a(1, i) == 0.0) {
      upper[i] = std::min(upper[i], viable_acceleration(to_upper, v, brake, tick.dt));
    }
    lower[i] = -moving_approach(to_lower, -v, -w(0, i), -a(0, i), brake, rate_, tick.dt);
    if (w(0, i) == 0.0 && a(0, i) == 0.0) {
      lower[i] = std::max(lower[i], -viable_acceleration(to_lower, -v, brake, tick.dt));
    }
    if (lower[i] > upper[i]) lower[i] = upper[i] = 0.5 * (lower[i] + upper[i]);  // limits move
    if (tick.jerk) narrow(tick, i, lower[i], upper[i]);
  }
}

// Never to none: between limits too close for both, the one ahead counts.
void PositionBox::narrow(const Tick& tick, Index i, double& lower, double& upper) const {
  const double q = tick.q[i], v = tick.v[i], jerk = tick.jerk[i], brake = brake_[i];
  if (limits_.rates(1, i) == 0.0 && limits_.accelerations(1, i) == 0.0) {
    upper = position_bound(limits_.upper[i] - q, v, jerk, brake, tick.dt, upper);
  }
  if (limits_.rates(0, i) == 0.0 && limits_.accelerations(0, i) == 0.0) {
    lower = -position_bound(q - limits_.lower[i], -v, jerk, brake, tick.dt, -lower);
  }
  if (lower > upper) (v > 0.0 ? lower : upper) = v > 0.0 ? upper : lower;
}

bool merge_boxes(const ConstMatrix& lowers, const ConstMatrix& uppers, Index hard, double* merged,
                 std::int64_t* sources, double* slack) {
  const Index count = lowers.rows(), entries = lowers.cols();
  bool gave_way = false;
  for (Index entry = 0; entry < entries; ++entry) {
    double low = -kInf, high = kInf;
    std::int64_t low_source = kNoSource, high_source = kNoSource;
    double hard_low = low, hard_high = high;
    for (Index c = 0; c < count; ++c) {
      const double lower = lowers(c, entry), upper = uppers(c, entry);
      double& given = slack[c * entries + entry];
      given = 0.0;
      if (lower > high) {
        given = lower - high, low = high, low_source = c, gave_way = true;
      } else if (upper < low) {
        given = low - upper, high = low, high_source = c, gave_way = true;
      } else {
        if (lower > low) low = lower, low_source = c;
        if (upper < high) high = upper, high_source = c;
      }
      if (c < hard) hard_low = low, hard_high = high;
    }
    merged[entry] = low, merged[entries + entry] = high;
    merged[2 * entries + entry] = hard_low, merged[3 * entries + entry] = hard_high;
    sources[entry] = low_source, sources[entries + entry] = high_source;
  }
  return gave_way;
}

}  // namespace ghc
