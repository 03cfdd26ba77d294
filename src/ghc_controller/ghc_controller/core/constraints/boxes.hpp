// Boxes of joint limits on accelerations and torques, and their merge.
#pragma once

#include <cstdint>

#include "matrix.hpp"

namespace ghc {

// What a box may depend on.
struct Tick {
  const double *q, *v;             // (a,) of the actuated joints
  const double* gravity;           // (a,) torque that holds them still
  const double* previous_torque;   // (a,) over the last period; null at the start
  const double* jerk;              // (a,) within the torque rate limit; null without one
  double dt;                       // [s] control period
};

// A lower and an upper bound of each of a joints. The numbers that a box is given are read anew at
// every write: they may change, and must outlive it.
class JointBox {
 public:
  explicit JointBox(Index joints) : joints_(joints) {}
  virtual ~JointBox() = default;
  virtual void write(const Tick& tick, double* lower, double* upper) const = 0;
  Index joints() const { return joints_; }

 private:
  Index joints_;
};

// -limit <= tau - center <= limit about zero or about what holds the robot still; or a range.
class TorqueBox : public JointBox {
 public:
  TorqueBox(const ConstVector& limit, bool around_gravity);
  void set_range(Vector lower, Vector upper);  // instead; empty: no longer
  void write(const Tick& tick, double* lower, double* upper) const override;

 private:
  ConstVector limit_;
  Vector lower_, upper_;
  bool around_gravity_;
};

// previous -+ rate dt.
class RateBox : public JointBox {
 public:
  explicit RateBox(const ConstVector& rate);
  void write(const Tick& tick, double* lower, double* upper) const override;

 private:
  ConstVector rate_;
};

// (-limit - v) / h <= dv <= (limit - v) / h; with a planned jerk dv can also fall to 0 in time.
class VelocityBox : public JointBox {
 public:
  VelocityBox(const ConstVector& limit, double horizon_in_s);
  void write(const Tick& tick, double* lower, double* upper) const override;

  double horizon;  // [s]

 private:
  ConstVector limit_;
};

// Limits of positions and how they move, as MovingLimits (previews/limits_in_force.py).
struct MovingLimits {
  Vector lower, upper;          // (a,)
  Matrix rates, accelerations;  // (2, a) of lower and upper
};

// Joints that can stop before their limits (JointPositionLimit).
class PositionBox : public JointBox {
 public:
  PositionBox(const ConstVector& brake, double approach_rate);
  void set_limits(MovingLimits limits);
  void write(const Tick& tick, double* lower, double* upper) const override;

 private:
  void narrow(const Tick& tick, Index i, double& lower, double& upper) const;

  ConstVector brake_;
  double rate_;
  MovingLimits limits_;
};

// Which boxes bind: numbers of the box behind each bound, -1 without one.
constexpr std::int64_t kNoSource = -1;

// Intersect c boxes over r entries, hardest first: lowers, uppers (c, r). Where the next box misses
// what is left it gives way: the merged box becomes the point nearest to it, and the distance is
// its slack (c, r). merged (4, r): lower, upper, and the same of the hard boxes alone. True when
// any box gave way.
bool merge_boxes(const ConstMatrix& lowers, const ConstMatrix& uppers, Index hard, double* merged,
                 std::int64_t* sources, double* slack);

}  // namespace ghc
