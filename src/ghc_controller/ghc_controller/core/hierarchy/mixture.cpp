#include "mixture.hpp"

#include <algorithm>

namespace ghc {
namespace {

constexpr double kOverRate = 1e-6;  // [Nm] by which a torque may miss the rate limit

}  // namespace

bool Mixture::begin(const Problem& problem) {
  problem_ = problem;
  ready_ = problem.finite();
  if (!ready_) return false;
  reduction_.keep_contacts(problem_);
  reduction_.balance();
  expanded_ = kOfAll;
  brake_ = -damping_.velocity * problem_.velocity.vector();
  reduction_.coordinates(brake_, y_);
  return true;
}

Index Mixture::solve(const std::vector<Cascade*>& orders, const Budget& budget) {
  const bool limited = problem_.limits_rate();
  Index parts = static_cast<Index>(orders.size()) + (limited ? 1 : 0), left = budget.whole;
  Index done = 0;
  for (size_t place = 0; place < orders.size(); ++place) {
    Cascade* const order = orders[place];
    if (!order) break;
    const Index kept = left < 0 ? 0 : left * (parts - 1) / parts;
    const Index of_order = left < 0 ? budget.of_qp : left - kept;
    const Deadline deadline = budget.deadline.first_of(parts);
    const Index answered =
        solve_order(*order, place, {budget.bounded, budget.of_qp, of_order, deadline});
    if (answered < order->levels()) break;
    if (left >= 0) left -= order->pivots();
    --parts, ++done;
  }
  return done;
}

void Mixture::expand(size_t place) {
  if (place >= problem_.of_orders.size()) place = kOfAll;
  if (place == expanded_) return;
  const ForceExpansion of_all{problem_.force_center, problem_.force_factor};
  reduction_.expand(problem_, place == kOfAll ? of_all : problem_.of_orders[place]);
  reduction_.coordinates(brake_, y_);
  expanded_ = place;
}

Index Mixture::solve_order(Cascade& order, size_t place, const Effort& effort) {
  expand(place);
  return order.solve(reduction_.jacobian(), reduction_.target(), y_, reduction_.terms(problem_),
                     damping_, effort);
}

void Mixture::blend(const std::vector<Cascade*>& orders, const std::vector<double>& shares) {
  Index last = static_cast<Index>(orders.size()) - 1;
  while (last > 0 && !(shares[last] > 0.0)) --last;
  const Cascade& base = *orders[last];
  x_ = base.acceleration(), torque_ = base.torque(), force_ = base.force();
  violation_ = base.violation(), pivots_ = base.pivots(), qp_solved_ = base.qps() > 0;
  for (Index c = 0; c < last; ++c) {
    if (!(shares[c] > 0.0)) continue;
    const Cascade& order = *orders[c];
    // By differences: what all orders share comes out unchanged.
    x_ += shares[c] * (order.acceleration() - base.acceleration());
    torque_ += shares[c] * (order.torque() - base.torque());
    force_ += shares[c] * (order.force() - base.force());
    violation_ = std::max(violation_, order.violation());
    pivots_ += order.pivots();
    qp_solved_ = qp_solved_ || order.qps() > 0;
  }
}

bool Mixture::within_rate(const Vector& torque) const {
  const auto lower = problem_.tau_lower.vector(), upper = problem_.tau_upper.vector();
  for (Index i = 0; i < torque.size(); ++i) {  // false for NaN
    if (!(lower[i] - torque[i] <= kOverRate && torque[i] - upper[i] <= kOverRate)) return false;
  }
  return true;
}

}  // namespace ghc
