// Bounds on the acceleration of one joint near a limit.
//
// A joint at distance d [rad] from a limit, approaching it with speed v [rad/s]; accelerations
// [rad/s^2] count towards the limit. Derivations: docs/limits.md.
#pragma once

namespace ghc {

// Of a joint whose acceleration a falls from the next tick on with the jerk -j [rad/s^3] until it
// is -A, and stays there: travel until the speed is 0 [rad]; 0 where it never moves towards the
// limit.
double stopping_distance(double v, double a, double jerk, double brake);

// Largest a whose fall to 0 with -j gains no more than `margin` >= 0 [rad/s].
double velocity_bound(double margin, double jerk, double dt);

// Largest a <= cap of this period after which the joint can still stop before its limit. Without
// one it brakes, by at most A, as a stop 1e-5 rad beyond the limit needs. Beyond that the way back
// keeps within what -j can stop.
double position_bound(double distance, double v, double jerk, double brake, double dt, double cap);

// Largest acceleration, constant over dt, after which braking with A stops before the limit
// (JointPositionLimit has the inequality).
double viable_acceleration(double distance, double v, double brake, double dt);

// Acceleration of a critically damped approach with `rate` [1/s] to a limit that moves with rate w
// and acceleration a. Braking is never forbidden: to a stop, or to the rate of a limit that comes
// closer.
double moving_approach(double distance, double v, double w, double a, double brake, double rate,
                       double dt);

}  // namespace ghc
