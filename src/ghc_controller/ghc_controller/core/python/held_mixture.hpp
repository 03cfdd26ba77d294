// The mixture as Python has it: with the arrays of a control problem, held from tick to tick.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "mixture.hpp"

namespace ghc {

constexpr size_t kArrays = 11, kGeneral = 3, kContacts = 8;

// Arrays of a control problem, held from tick to tick.
class HeldProblem {
 public:
  // The first eleven are those of `Problem` in its order; `general` are the first three of
  // AccelerationRows and `contacts` the first eight of ContactRows, or None.
  const Problem& take(const std::array<nb::handle, kArrays>& given, nb::handle general,
                      nb::handle contacts, Index unactuated) {
    View* const views[kArrays] = {&problem_.jacobian,   &problem_.target,    &problem_.mass_matrix,
                                  &problem_.bias,       &problem_.velocity,  &problem_.x_lower,
                                  &problem_.x_upper,    &problem_.tau_lower, &problem_.tau_upper,
                                  &problem_.limit_lower, &problem_.limit_upper};
    for (size_t i = 0; i < kArrays; ++i) {
      *views[i] = arrays_[i].take(given[i], i == 0 || i == 2 ? 2 : 1);
    }
    View* const rows[kGeneral] = {&problem_.general, &problem_.general_lower,
                                  &problem_.general_upper};
    parts(general, kGeneral, rows, general_.data(), 0b001);
    problem_.general_force = general_force_.take(
        general.is_none() ? nb::none() : nb::getattr(general, "force_matrix", nb::none()), 2);
    View* const forces[kContacts] = {&problem_.contact_jacobian, &problem_.drift_target,
                                     &problem_.force_jacobian,   &problem_.force_matrix,
                                     &problem_.force_lower,      &problem_.force_upper,
                                     &problem_.force_center,     &problem_.force_factor};
    parts(contacts, kContacts, forces, contacts_.data(), 0b10001101);
    problem_.of_orders.clear();
    problem_.in_contact = !contacts.is_none();
    problem_.unactuated = unactuated;
    problem_.check();
    return problem_;
  }

  // Costs on forces of the orders of the problem that was taken: pairs of a center and a factor.
  void take_costs(const nb::tuple& costs) {
    costs_.resize(costs.size());
    for (size_t i = 0; i < costs.size(); ++i) {
      const nb::object cost = costs[i];
      if (!nb::isinstance<nb::tuple>(cost) || nb::len(cost) != 2) {
        throw nb::value_error("center and factor of each order expected");
      }
      problem_.of_orders.push_back(
          {costs_[i][0].take(cost[0], 1), costs_[i][1].take(cost[1], 2)});
    }
    problem_.check();
  }

  // The same without velocity and bounds.
  const Problem& take_motion(nb::handle J, nb::handle b, nb::handle M, nb::handle h,
                             nb::handle contacts, Index unactuated) {
    const nb::object none = nb::none();
    std::array<nb::handle, kArrays> given;
    given.fill(h);  // of the right size where nothing is bounded
    given[0] = J, given[1] = b, given[2] = M, given[3] = h;
    const nb::object joints =
        nb::borrow(h)[nb::slice(nb::int_(unactuated), nb::none(), nb::none())];
    for (size_t i = 7; i < kArrays; ++i) given[i] = joints;
    return take(given, none, contacts, unactuated);
  }

  Index rows() const { return problem_.jacobian.rows; }

 private:
  // Entries of a tuple; bit i of `matrices` is set where entry i has two axes.
  static void parts(nb::handle given, size_t count, View* const* views, HeldArray* held,
                    unsigned matrices) {
    if (given.is_none()) {
      for (size_t i = 0; i < count; ++i) *views[i] = held[i].take(nb::none(), 1);
      return;
    }
    const auto tuple = nb::cast<nb::tuple>(given);
    if (tuple.size() < count) throw nb::value_error("a tuple of more arrays expected");
    for (size_t i = 0; i < count; ++i) {
      *views[i] = held[i].take(tuple[i], (matrices >> i) & 1U ? 2 : 1);
    }
  }

  Problem problem_;
  std::array<HeldArray, kArrays> arrays_;
  std::array<HeldArray, kGeneral> general_;
  HeldArray general_force_;
  std::array<HeldArray, kContacts> contacts_;
  std::vector<std::array<HeldArray, 2>> costs_;
};

inline nb::object or_none(const View& view, bool given, bool matrix) {
  if (!given) return nb::none();
  return matrix ? new_matrix(view) : new_vector(view);
}

// Arrays of ReducedProblem and ForceCenter.
inline nb::tuple reduced_arrays(Reduction& r) {
  const auto jacobian = r.jacobian();
  const auto target = r.target();
  const RowTerms rows = r.rows();
  const bool moved = r.basis.data != nullptr || r.offset.data != nullptr;
  const Index a = r.bias_of_joints.size(), u = r.balance_target.size(), c = r.center.size();
  Vector torque_offset = r.bias_of_joints.vector();
  if (moved) torque_offset += r.mass_of_joints.matrix() * r.offset.vector();
  return nb::make_tuple(
      new_matrix({jacobian.data(), jacobian.rows(), jacobian.cols()}),
      new_vector({target.data(), target.size(), 1}), or_none(r.basis, moved, true),
      or_none(r.offset, moved, false), new_matrix({rows.torque_matrix.data(), a, jacobian.cols()}),
      new_vector(torque_offset), new_matrix({r.torque_force.data, a, c}),
      new_matrix({r.balance_matrix.data, u, jacobian.cols()}),
      new_matrix({r.balance_force.data, u, c}), new_vector(r.balance_target),
      new_vector(r.center), new_matrix({r.gain.data, c, r.residual.size()}),
      new_matrix({rows.free.data(), c, rows.free.cols()}), new_vector(r.residual));
}

inline nb::tuple answer_of(const Cascade& order) {
  if (order.answered() == 0) {
    return nb::make_tuple(0, order.pivots(), order.qps(), 0.0, nb::none(), nb::none(), nb::none());
  }
  return nb::make_tuple(order.answered(), order.pivots(), order.qps(), order.violation(),
                        new_vector(order.acceleration()), new_vector(order.force()),
                        new_vector(order.torque()));
}

// `Mixture` of native.pyi.
class HeldMixture {
 public:
  HeldMixture(double regularization, double null_damping, double velocity_damping)
      : mixture_({regularization, null_damping, velocity_damping}) {}

  // See native.pyi.
  nb::tuple solve(nb::tuple orders, nb::tuple shares, nb::handle J, nb::handle b, nb::handle M,
                  nb::handle h, nb::handle v, nb::handle x_lower, nb::handle x_upper,
                  nb::handle tau_lower, nb::handle tau_upper, nb::handle limit_lower,
                  nb::handle limit_upper, nb::handle general, nb::handle contacts,
                  Index unactuated, bool bounded, Index of_qp, Index of_step, Clock* clock,
                  double end, nb::tuple costs) {
    mixture_.forget();
    orders_.clear();
    const Problem& problem =
        held_.take({J, b, M, h, v, x_lower, x_upper, tau_lower, tau_upper, limit_lower,
                    limit_upper},
                   general, contacts, unactuated);
    take_orders(orders, shares, held_.rows());
    if (costs.size() != 0) {
      if (costs.size() != orders_.size() || !problem.in_contact) {
        throw nb::value_error("in contact a cost on forces of each order expected");
      }
      held_.take_costs(costs);
    }
    const Index done = answer_all(problem, {bounded, of_qp, of_step, {clock, end}});
    if (done < static_cast<Index>(orders_.size())) {
      return nb::make_tuple(done, 0, 0, nb::tuple());
    }
    Index pivots = 0, qps = 0;
    for (const Cascade* order : orders_) pivots += order->pivots(), qps += order->qps();
    const nb::tuple blend = nb::make_tuple(
        new_vector(mixture_.acceleration()), new_vector(mixture_.force()),
        new_vector(mixture_.torque()), mixture_.violation(), mixture_.pivots(),
        mixture_.qp_solved(), mixture_.within_rate(mixture_.torque()));
    return nb::make_tuple(done, pivots, qps, blend);
  }

  // Orders and shares of the next `answer_all`; a tuple that was taken before costs nothing.
  void take(const nb::tuple& orders, const nb::tuple& shares, Index rows) {
    if (orders.ptr() == kept_.ptr() && rows == rows_ && shares.size() == shares_.size() &&
        !orders_.empty()) {
      for (size_t i = 0; i < shares_.size(); ++i) shares_[i] = nb::cast<double>(shares[i]);
      begun_.assign(orders_.size(), 0);
      return;
    }
    take_orders(orders, shares, rows);
  }

  // Answer a problem by the orders taken, and blend; how many orders have an answer, -1 where the
  // problem is not finite.
  Index answer_all(const Problem& problem, const Budget& budget) {
    if (!mixture_.begin(problem)) return -1;
    const size_t answered = static_cast<size_t>(mixture_.solve(orders_, budget));
    for (size_t i = 0; i < orders_.size() && i <= answered; ++i) {
      begun_[i] = orders_[i] != nullptr;
    }
    if (answered == orders_.size()) mixture_.blend(orders_, shares_);
    return static_cast<Index>(answered);
  }

  const Mixture& mixture() const { return mixture_; }
  const std::vector<Cascade*>& orders() const { return orders_; }

  void retune(double regularization, double null_damping, double velocity_damping) {
    mixture_.retune({regularization, null_damping, velocity_damping});
  }

  // See native.pyi.
  nb::tuple answer(size_t index, bool bounded, Index of_qp, Index of_order, Clock* clock,
                   double end) {
    if (index >= orders_.size() || !orders_[index] || !mixture_.ready()) {
      throw nb::index_error("an order of the last problem expected");
    }
    if (!begun_[index]) {
      mixture_.solve_order(*orders_[index], index, {bounded, of_qp, of_order, {clock, end}});
    }
    begun_[index] = true;
    return answer_of(*orders_[index]);
  }

  // See native.pyi.
  nb::tuple forces() const {
    const bool all = std::find(begun_.begin(), begun_.end(), 0) == begun_.end();
    if (!mixture_.ready() || !all) throw nb::index_error("an answer of each order expected");
    nb::list found;
    for (const Cascade* order : orders_) found.append(new_vector(order->force()));
    return nb::tuple(found);
  }

  // See native.pyi.
  nb::tuple reduced(std::optional<size_t> index) {
    if (!mixture_.ready()) throw nb::value_error("a problem that is finite expected before");
    mixture_.expand(index.value_or(Mixture::kOfAll));
    return reduced_arrays(mixture_.reduction());
  }

 private:
  void take_orders(const nb::tuple& orders, const nb::tuple& shares, Index rows) {
    if (orders.size() == 0 || shares.size() != orders.size()) {
      throw nb::value_error("an order or more, and as many shares expected");
    }
    orders_.clear(), shares_.clear();
    kept_ = orders, rows_ = rows;
    for (nb::handle order : orders) {
      auto* one = order.is_none() ? nullptr : nb::cast<Cascade*>(order);
      if (one && !one->fits(rows)) {
        orders_.clear();
        throw nb::value_error("a Jacobian with every row of the order expected");
      }
      orders_.push_back(one);
    }
    for (nb::handle share : shares) shares_.push_back(nb::cast<double>(share));
    begun_.assign(orders_.size(), 0);
  }

  Mixture mixture_;
  HeldProblem held_;
  nb::tuple kept_;
  Index rows_ = 0;
  std::vector<Cascade*> orders_;
  std::vector<double> shares_;
  std::vector<char> begun_;  // whether an order was solved, or begun
};

}  // namespace ghc
