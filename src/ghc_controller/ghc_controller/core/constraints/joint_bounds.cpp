#include "joint_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ghc {
namespace {

constexpr double kSearched = 1e4;  // [rad/s^2] search interval of a bound from above
constexpr int kHalvings = 27;     // of it, to 1e-4 rad/s^2
constexpr double kLate = 1e-5;    // [rad] beyond a limit in which a joint may stop, periods late
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// Deceleration of a joint that moves with v >= 0 and cannot stop in time.
double stops_late(double distance, double v, double brake, double dt) {
  const double most = std::max(-brake, -v / dt), room = distance + kLate;
  return room > 0.0 ? std::max(most, -v * v / (2.0 * room)) : most;
}

// Whether a joint that moves with a for one period can then stop within `distance`.
bool can_stop(double a, double distance, double v, double jerk, double brake, double dt) {
  const double after = v + a * dt;
  return after * dt + stopping_distance(after, a, jerk, brake) <= distance;
}

}  // namespace

double stopping_distance(double v, double a, double jerk, double brake) {
  const double peak = a * a + 2.0 * jerk * v;  // square of the a at which v = 0, without -A
  if (v <= 0.0 && (a <= 0.0 || peak <= 0.0)) return 0.0;
  if (a <= -brake) return v * v / (2.0 * brake);
  double time = (a + brake) / jerk;
  double rest = v + a * time - 0.5 * jerk * time * time;  // speed when a reaches -A
  if (rest <= 0.0) {
    time = (a + std::sqrt(std::max(peak, 0.0))) / jerk;
    rest = 0.0;
  }
  const double travel = v * time + 0.5 * a * time * time - jerk * time * time * time / 6.0;
  return std::max(travel + rest * rest / (2.0 * brake), 0.0);
}

double velocity_bound(double margin, double jerk, double dt) {
  const double delay = 1.5 * dt;  // a acts for one period before it falls, in steps of j dt
  return jerk * (std::sqrt(delay * delay + 2.0 * margin / jerk) - delay);
}

double position_bound(double distance, double v, double jerk, double brake, double dt,
                      double cap) {
  if (distance == kNoLimit) return cap;
  if (distance < 0.0 && v < 0.0) return std::min(cap, velocity_bound(-v, jerk, dt));
  if (distance < std::max(v, 0.0) * dt) return std::min(cap, stops_late(distance, v, brake, dt));
  if (can_stop(cap, distance, v, jerk, brake, dt)) return cap;
  double low = -brake, high = std::min(cap, kSearched);
  if (!can_stop(low, distance, v, jerk, brake, dt)) {
    return std::min(cap, v > 0.0 ? stops_late(distance, v, brake, dt) : -brake);
  }
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double a = 0.5 * (low + high);
    (can_stop(a, distance, v, jerk, brake, dt) ? low : high) = a;
  }
  return low;
}

double viable_acceleration(double distance, double v, double brake, double dt) {
  if (distance == kNoLimit) return kNoLimit;
  const double stop = -v / dt;
  // (v + x dt)^2 / (2 brake) + v dt + c x dt^2 - distance = a x^2 + b x + constant
  const double a = dt * dt / (2.0 * brake);
  const double constant = v * v / (2.0 * brake) + v * dt - distance;
  double best = -kNoLimit;
  for (const double c : {1.0, 0.5}) {
    const double b = v * dt / brake + c * dt * dt;
    const double discriminant = b * b - 4.0 * a * constant;
    if (discriminant >= 0.0) {
      best = (-b + std::sqrt(discriminant)) / (2.0 * a);
      if (best >= 0.0) break;
    }
  }
  if (best < stop) {  // it cannot only slow down: it must turn back, or stay inside while stopping
    best = std::min(stop, 2.0 * (distance - v * dt) / (dt * dt));
  }
  return std::max({best, stop, -brake});
}

double moving_approach(double distance, double v, double w, double a, double brake, double rate,
                       double dt) {
  const auto braking = [brake, dt](double speed) {
    return std::min(std::max(-speed / dt, -brake), brake);
  };
  const double relative = v - w;
  const double approach = a + rate * rate * distance - 2.0 * rate * relative;
  return std::max(approach, std::min(braking(v), a + braking(relative)));
}

}  // namespace ghc
