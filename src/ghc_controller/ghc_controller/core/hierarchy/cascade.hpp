// The levels of one order, one after the other (docs/architecture.md, "cascade").
#pragma once

#include <cstdint>
#include <vector>

#include "active_set.hpp"
#include "bounds.hpp"
#include "deadline.hpp"
#include "level.hpp"
#include "null_space.hpp"

namespace ghc {

struct Damping {
  double regularization;  // [-] w of every level
  double null_space;      // [-] e
  double velocity;        // [1/s] kd: accelerations are damped towards -kd v
};

struct Effort {
  bool bounded;    // false: levels that meet a bound are left to the caller
  Index of_qp;     // pivots of one level
  Index of_order;  // pivots of all levels
  Deadline deadline;  // no level but the first begins after it
};

// Workspace of one order, kept from tick to tick, and the active sets of its levels.
class Cascade {
 public:
  // rows (m,) of the augmented Jacobian in the order of the levels; level l ends at ends[l].
  // Throws std::invalid_argument where the ends do not divide the rows.
  Cascade(std::vector<std::int64_t> rows, std::vector<std::int64_t> ends);

  // Answer the levels from y (d,) on; returns how many have one. What comes after is the caller's.
  Index solve(const ConstMatrix& jacobian, const ConstVector& target, const Vector& y,
              const Terms& terms, const Damping& damping, const Effort& effort);

  // Of the last level that has an answer:
  const Vector& acceleration() const { return x_; }  // (n,)
  const Vector& torque() const { return torque_; }   // (a,)
  const Vector& force() const { return force_; }     // (c,)
  double violation() const { return violation_; }    // of the bounds as they were given
  Index pivots() const { return pivots_; }           // of all levels
  Index qps() const { return qps_; }                 // levels that met a bound
  Index answered() const { return answered_; }       // levels that have an answer

  Index levels() const { return static_cast<Index>(ends_.size()); }

  // Whether a Jacobian of m rows has all that the order names.
  bool fits(Index m) const;

  // The next answer is that of a new workspace, to the last digit.
  void forget() { for (auto& set : memory_) set.clear(); }

 private:
  // Answer what is left from a level on, where the levels above leave next to nothing: P of norm
  // t, so that a level moves accelerations by P P J^T r / w but for a part of t^2 |J|^2 / w, and by
  // t^2 |J| |r| / w at most. False: nothing was done, as that is too much or meets a bound.
  bool close(Index first, const Damping& damping, const Effort& effort);
  void take_point();  // accelerations, torques and forces of the point at which the bounds stand

  std::vector<std::int64_t> rows_, ends_;
  std::vector<std::vector<ActiveRow>> memory_;  // active set of each level
  Matrix jacobian_, projected_;
  Vector target_, y_, x_, torque_, force_;
  Vector closed_, residual_, pull_, across_;  // of `close`
  const Vector none_;  // no free forces
  NullSpace above_;
  std::vector<Level> level_;  // one each, so that no tick allocates
  Bounds bounds_;
  ProjectedRows bound_rows_;
  ActiveSet active_set_;
  double violation_ = 0.0;
  Index pivots_ = 0, qps_ = 0, answered_ = 0;
};

}  // namespace ghc
