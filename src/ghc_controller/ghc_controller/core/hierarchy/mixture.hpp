// One tick of the cascade: every order of a mixture answered, and the answers blended.
//
// Orders share what does not depend on priorities: the reduction by contacts and the bounds, and
// the forces that carry the base unless each order has its own cost on them. Convex bounds hold for sum_c rho_c answer_c, which is linear in
// the shares rho_c (docs/architecture.md, "cascade").
#pragma once

#include <vector>

#include "cascade.hpp"
#include "problem.hpp"
#include "reduction.hpp"

namespace ghc {

// How many pivots a tick may take; `whole` < 0 outside of one: then each order has those of a QP.
struct Budget {
  bool bounded;  // false: levels that meet a bound are left to the caller
  Index of_qp;
  Index whole;
  Deadline deadline;  // of the tick
};

class Mixture {
 public:
  explicit Mixture(const Damping& damping) : damping_(damping) {}

  void retune(const Damping& damping) { damping_ = damping; }

  // Take a problem, whose arrays stay where they are until the next one. False: not finite.
  bool begin(const Problem& problem);

  // Forget the problem: its arrays may go.
  void forget() { ready_ = false; }
  bool ready() const { return ready_; }  // whether there is a problem, which is finite

  // Answer the orders one after the other, until one is null or has levels without an answer;
  // returns how many have one for every level. The pivots and the time that are left are shared
  // alike among the orders to come, and the torque rate limit, where there is one.
  Index solve(const std::vector<Cascade*>& orders, const Budget& budget);

  // Answer the order at a place; returns how many of its levels have an answer.
  Index solve_order(Cascade& order, size_t place, const Effort& effort);

  // Reduce the problem at the cost on forces of the order at a place, or at that of all.
  void expand(size_t place);
  static constexpr size_t kOfAll = static_cast<size_t>(-1);

  // sum_c rho_c answer_c over the orders with a share above 0, all of which have an answer.
  void blend(const std::vector<Cascade*>& orders, const std::vector<double>& shares);

  // Of the blend:
  const Vector& acceleration() const { return x_; }
  const Vector& torque() const { return torque_; }
  const Vector& force() const { return force_; }
  double violation() const { return violation_; }
  Index pivots() const { return pivots_; }
  bool qp_solved() const { return qp_solved_; }

  // Whether a torque (a,) meets the torque limits and the torque rate.
  bool within_rate(const Vector& torque) const;

  const Problem& problem() const { return problem_; }
  Reduction& reduction() { return reduction_; }

 private:
  Damping damping_;
  Problem problem_;
  Reduction reduction_;
  Vector brake_, y_, x_, torque_, force_;
  double violation_ = 0.0;
  Index pivots_ = 0;
  size_t expanded_ = kOfAll;  // place of the order whose cost on forces the reduction has
  bool qp_solved_ = false, ready_ = false;
};

}  // namespace ghc
