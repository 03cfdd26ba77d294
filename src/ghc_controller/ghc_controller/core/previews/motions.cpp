#include "motions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rotation.hpp"

namespace ghc {
namespace {

constexpr double kSmallTurn = 1e-4;   // [rad] below it a series replaces the quotient
constexpr double kSeriesTurn = 0.02;  // [rad] the same for quotients of cancelling terms
constexpr double kWholeStep = 1e-6;   // [-] of a step, by which a time may fall short of a point
constexpr double kMotionStep = 1e-3;  // [s] h
constexpr double kBandwidth = 30.0;   // [1/s] of both poles
constexpr double kProfile = 0.6;      // [-] of the acceleration limit that an approach plans with
constexpr double kAhead = 0.1;        // [s] in which a goal of another velocity counts as farther
constexpr double kNear = 0.01;        // [rad] of a goal, within which the jerk limit grows
constexpr double kFollowed = 0.06;    // [rad] of a goal, within which its velocity counts in full
constexpr double kSmallest = 1e-6;    // [rad] the least distance that counts

using ConstVector3 = Eigen::Map<const Vector3>;

// a, b of J_r = I - a [p] + b [p]^2, and their derivatives by t divided by t.
struct RightJacobian {
  double a, b, a_slope, b_slope;

  explicit RightJacobian(double t) {
    if (t < kSeriesTurn) {  // to t^4, error below 1e-13
      const double s = t * t;
      a = 0.5 - s / 24.0 + s * s / 720.0;
      b = 1.0 / 6.0 - s / 120.0 + s * s / 5040.0;
      a_slope = -1.0 / 12.0 + s / 180.0, b_slope = -1.0 / 60.0 + s / 1260.0;
      return;
    }
    const double sine = std::sin(t), cosine = std::cos(t);
    a = (1.0 - cosine) / (t * t);
    b = (t - sine) / (t * t * t);
    a_slope = (sine - 2.0 * a * t) / (t * t * t);
    b_slope = (1.0 - cosine - 3.0 * b * t * t) / (t * t * t * t);
  }
};

void advance(double* state, const double* jerk, double step) {
  for (int axis = 0; axis < 3; ++axis) {
    const double v = state[3 + axis], a = state[6 + axis], u = jerk[axis];
    state[axis] += step * (v + step * (a / 2.0 + step * u / 6.0));
    state[3 + axis] += step * (a + step * u / 2.0);
    state[6 + axis] += step * u;
  }
}

double rate_at_end(double p0, double p1, double p2, double p3, double step) {
  return (-11.0 * p0 + 18.0 * p1 - 9.0 * p2 + 2.0 * p3) / (6.0 * step);
}

double rate_beside_end(double p0, double p1, double p2, double p3, double step) {
  return (-2.0 * p0 - 3.0 * p1 + 6.0 * p2 - p3) / (6.0 * step);
}

// Of third order, from five points, or from four at the ends.
double rate_of(const double* p, Index j, Index last, double step) {
  if (j == 0) return rate_at_end(p[0], p[1], p[2], p[3], step);
  if (j == 1) return rate_beside_end(p[0], p[1], p[2], p[3], step);
  if (j == last) return -rate_at_end(p[j], p[j - 1], p[j - 2], p[j - 3], step);
  if (j == last - 1) return -rate_beside_end(p[j + 1], p[j], p[j - 1], p[j - 2], step);
  return (8.0 * (p[j + 1] - p[j - 1]) - (p[j + 2] - p[j - 2])) / (12.0 * step);
}

double curvature_inside(const double* p, Index j, double step) {
  return (p[j + 1] - 2.0 * p[j] + p[j - 1]) / (step * step);
}

double curvature_of(const double* p, Index j, Index last, double step) {
  if (j == 0) return 2.0 * curvature_inside(p, 1, step) - curvature_inside(p, 2, step);
  if (j == last) {
    return 2.0 * curvature_inside(p, last - 1, step) - curvature_inside(p, last - 2, step);
  }
  return curvature_inside(p, j, step);
}

// Points from the first, held inside; NaN is the first one.
double inside(double place, Index last) {
  return place > 0.0 ? std::min(place, static_cast<double>(last)) : 0.0;
}

double squared(double value) { return value * value; }

double clamped(double value, double least, double most) {
  return std::min(std::max(value, least), most);
}

// Towards a goal, in the direction in which it lies, else away from it.
double speed_at(double distance, double planned) {
  constexpr double k1 = 0.5 * kBandwidth;
  const double size = std::abs(distance);
  const double speed = size < planned / (k1 * k1)
                           ? k1 * size
                           : std::sqrt(2.0 * planned * (size - 0.5 * planned / (k1 * k1)));
  return distance > 0.0 ? speed : -speed;
}

struct JointState {
  double e, v, a, rate;  // distance of the goal, velocity, acceleration, velocity of the goal
};

// Acceleration of a joint; limits of velocity, acceleration and jerk.
double approach(const JointState& now, double fastest, double A, double jerk) {
  constexpr double h = kMotionStep, k2 = 2.0 * kBandwidth;
  const double v = now.v, a = now.a, planned = kProfile * A, size = std::abs(now.e);
  const double apart = std::max({size, kAhead * std::abs(now.rate - v), kSmallest});
  const double J = jerk * std::max(1.0, squared(kNear / apart));
  const double rate = now.rate * std::min(1.0, squared(kFollowed / apart));
  // Distance and speed once the acceleration has gone down to that of braking, as J allows.
  const double side = now.e > 0.0 ? 1.0 : -1.0;
  double distance = size, speed = side * (v - rate);
  const double lasts = (side * a + planned) / J;
  if (lasts > h) {
    distance -= lasts * (speed + lasts * (0.5 * side * a - lasts * J / 6.0));
    speed += lasts * (side * a - 0.5 * lasts * J);
  }
  const double wanted = clamped(rate + side * speed_at(distance, planned), -fastest, fastest);
  double x = clamped(k2 * (wanted - (rate + side * speed)), -A, A);
  const double up = std::sqrt(2.0 * J * std::max(0.0, fastest - v));  // stops at the limit
  const double down = std::sqrt(2.0 * J * std::max(0.0, fastest + v));
  x = clamped(clamped(x, -down, up), a - J * h, a + J * h);
  return clamped(x, -(fastest + v) / h, (fastest - v) / h);
}

}  // namespace

void evaluate_polynomial(const ConstMatrix& coefficients, double s, Eigen::Ref<Matrix> out) {
  out.setZero();
  for (Index j = 0; j < coefficients.cols(); ++j) {
    double value = 0.0, rate = 0.0, change = 0.0;
    for (Index k = coefficients.rows() - 1; k >= 0; --k) {  // Horner, of both derivatives too
      change = change * s + 2.0 * rate;
      rate = rate * s + value;
      value = value * s + coefficients(k, j);
    }
    out(0, j) = value, out(1, j) = rate, out(2, j) = change;
  }
}

void turned_motion(const double* start, const double* p_given, const double* rate_given,
                   const double* change_given, double* quaternion, double* velocity,
                   double* acceleration) {
  const ConstVector3 p(p_given), rate(rate_given), change(change_given);
  const double t = p.norm();
  const double scale = t < kSmallTurn ? 0.5 - t * t / 48.0 : std::sin(0.5 * t) / t;
  const Vector3 axis = scale * p;
  const Eigen::Quaterniond turn(std::cos(0.5 * t), axis[0], axis[1], axis[2]);
  const Eigen::Quaterniond q = Eigen::Quaterniond(start[3], start[0], start[1], start[2]) * turn;
  const RightJacobian J(t);
  const Vector3 p_rate = p.cross(rate), p_p_rate = p.cross(p_rate), p_change = p.cross(change);
  const Vector3 omega = rate - J.a * p_rate + J.b * p_p_rate;
  const Vector3 alpha = change - J.a * p_change + J.b * p.cross(p_change) +
                        p.dot(rate) * (J.b_slope * p_p_rate - J.a_slope * p_rate) +
                        J.b * rate.cross(p_rate);
  const Matrix3 rotation = q.toRotationMatrix();
  Eigen::Map<Eigen::Vector4d>{quaternion} = q.coeffs();
  Eigen::Map<Vector3>{velocity} = rotation * omega;
  Eigen::Map<Vector3>{acceleration} = rotation * alpha;
}

void integrate_jerks(const double* state, const ConstMatrix& jerk, double step,
                     Eigen::Ref<Matrix> states) {
  std::copy_n(state, 9, states.data());
  for (Index j = 0; j < jerk.rows(); ++j) {
    double* next = states.data() + 9 * (j + 1);
    std::copy_n(next - 9, 9, next);
    advance(next, jerk.data() + 3 * j, step);
  }
}

void state_after(const double* state, const ConstMatrix& jerk, double step, double elapsed,
                 double* out) {
  std::copy_n(state, 9, out);
  const double steps = std::floor(elapsed / step + kWholeStep);
  const bool within = steps < static_cast<double>(jerk.rows());
  const Index whole = within ? static_cast<Index>(std::max(steps, 0.0)) : jerk.rows();
  for (Index j = 0; j < whole; ++j) advance(out, jerk.data() + 3 * j, step);
  if (within) {
    advance(out, jerk.data() + 3 * whole,
            std::max(elapsed - static_cast<double>(whole) * step, 0.0));
  } else {
    std::fill_n(out + 3, 6, 0.0);
  }
}

void bounds_at(const ConstMatrix& lower, const ConstMatrix& upper, double place, bool interpolate,
               double* low, double* high) {
  const Index last = lower.cols() - 1;
  place = inside(interpolate ? place : std::floor(place + kWholeStep), last);
  const Index left = std::min(static_cast<Index>(place), std::max(last - 1, Index{0}));
  const Index right = std::min(left + 1, last);
  const double share = place - static_cast<double>(left);
  for (Index k = 0; k < lower.rows(); ++k) {
    low[k] = (1.0 - share) * lower(k, left) + share * lower(k, right);
    high[k] = (1.0 - share) * upper(k, left) + share * upper(k, right);
  }
}

void motion_of_points(const ConstMatrix& points, double place, double step, double* rate,
                      double* acceleration) {
  const Index last = points.cols() - 1;
  place = inside(place, last);
  const Index left = std::min(static_cast<Index>(place), last - 1);
  const double share = place - static_cast<double>(left), rest = 1.0 - share;
  for (Index k = 0; k < points.rows(); ++k) {
    const double* p = points.data() + k * points.cols();
    const double now = curvature_of(p, left, last, step);
    const double then = curvature_of(p, left + 1, last, step);
    acceleration[k] = rest * now + share * then;
    const double ahead = share * step * (now + 0.5 * share * (then - now));
    const double back = rest * step * (then - 0.5 * rest * (then - now));
    // From both points, so that nothing jumps where the next step begins.
    rate[k] = rest * (rate_of(p, left, last, step) + ahead) +
              share * (rate_of(p, left + 1, last, step) - back);
  }
}

void move_joints(double* rows, Index count, Index n, Index first, const double* goal,
                 const double* rate, const MotionLimits& limits, bool brake) {
  constexpr double h = kMotionStep;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (Index k = first; k < count; ++k) {
    const double* before = rows + 3 * n * (k - 1);
    double* next = rows + 3 * n * k;
    for (Index i = 0; i < n; ++i) {
      const double q = before[i], v = before[n + i], A = limits.acceleration[i];
      double change = -v;
      if (!brake) {
        const double e = goal[i] - static_cast<double>(count - 1 - k) * h * rate[i] - q - h * v;
        const JointState now = {e, v, before[2 * n + i], rate[i]};
        change = h * approach(now, limits.velocity[i], A, limits.jerk[i]);
      }
      double after = v + clamped(change, -A * h, A * h);
      double room = 2.0 * A * (limits.upper[i] - q - 0.5 * v * h);
      const double most = room > 0.0 ? std::sqrt(A * A * h * h + room) - A * h : -infinity;
      room = 2.0 * A * (q + 0.5 * v * h - limits.lower[i]);
      const double least = room > 0.0 ? A * h - std::sqrt(A * A * h * h + room) : infinity;
      if (after > most && after > 0.0) after = std::max(most, 0.0);
      if (after < least && after < 0.0) after = std::min(least, 0.0);
      after = clamped(after, v - A * h, v + A * h);
      next[i] = q + 0.5 * h * (v + after);
      next[n + i] = after;
      next[2 * n + i] = (after - v) / h;
    }
  }
}

}  // namespace ghc
