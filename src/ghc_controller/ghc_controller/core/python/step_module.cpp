// One tick of a controller whose parts are all of the core, from a state to a torque.
#include <chrono>
#include <utility>

#include "held_anchor.hpp"
#include "held_boxes.hpp"
#include "held_gate.hpp"
#include "held_mixture.hpp"
#include "held_stack.hpp"
#include "jerk_plan.hpp"
#include "solve_module.hpp"

namespace ghc::python {
namespace {

using Time = std::chrono::steady_clock::time_point;

constexpr double kCounted = 1e-6;  // [Nm] as COUNTED_EXCESS of safety/torque_gate.py

Time now() { return std::chrono::steady_clock::now(); }

double seconds(Time from, Time to) {
  return std::chrono::duration<double>(to - from).count();
}

// A NamedTuple with every field given.
template <typename... Fields>
nb::object named_tuple(nb::handle type, const Fields&... fields) {
  auto* kind = reinterpret_cast<PyTypeObject*>(type.ptr());
  nb::object made = nb::steal(kind->tp_alloc(kind, sizeof...(fields)));
  if (!made.is_valid()) throw nb::python_error();
  Py_ssize_t i = 0;
  const auto put = [&made, &i](nb::object field) {
    PyTuple_SET_ITEM(made.ptr(), i++, field.release().ptr());
  };
  (put(nb::cast(fields)), ...);
  return made;
}

// The parts, in the order in which they work; each writes arrays that the next one reads.
class HeldStep {
 public:
  HeldStep(nb::object stack, nb::object acceleration, nb::object torque, nb::object jerk,
           nb::object gate, nb::object mixture, nb::object anchor, nb::tuple answer)
      : kept_{nb::cast<HeldStack&>(stack).model(), stack, acceleration, torque, jerk, gate,
              mixture, anchor},
        model_(nb::cast<Model&>(kept_[0])),
        stack_(nb::cast<HeldStack&>(stack)),
        acceleration_(nb::cast<HeldBoxes&>(acceleration)),
        torque_(nb::cast<HeldBoxes&>(torque)),
        jerk_(jerk.is_none() ? nullptr : nb::cast<JerkPlan*>(jerk)),
        gate_(nb::cast<HeldGate&>(gate)),
        mixture_(nb::cast<HeldMixture&>(mixture)),
        anchor_(nb::cast<HeldAnchor&>(anchor)),
        answer_(std::move(answer)) {
    expect(answer_.size() == 5 && nb::isinstance<nb::type_object>(answer_[0]) &&
               nb::isinstance<nb::type_object>(answer_[1]),
           "StepResult, Solution, their status and no force expected");
    const Tree& tree = model_.tree;
    const Index n = tree.nv(), u = tree.floating() ? 6 : 0;
    expect(acceleration_.entries() == n && torque_.entries() == n - u &&
               gate_.joints() == n - u && acceleration_.complete() && torque_.complete() &&
               (!jerk_ || (jerk_->carried.cols() == n && jerk_->jerk.size() == n - u)),
           "parts of one model, all of the core, expected");
    problem_.jacobian = stack_.jacobian(), problem_.target = stack_.target();
    problem_.mass_matrix = {tree.mass_matrix.data(), n, n};
    problem_.bias = {tree.bias.data(), n, 1}, problem_.velocity = {tree.v.data(), n, 1};
    problem_.x_lower = acceleration_.merged(0), problem_.x_upper = acceleration_.merged(1);
    problem_.tau_lower = torque_.merged(0), problem_.tau_upper = torque_.merged(1);
    problem_.limit_lower = torque_.merged(2), problem_.limit_upper = torque_.merged(3);
    problem_.unactuated = u;
    problem_.check();
  }

  // See native.pyi.
  nb::tuple run(nb::handle q, nb::handle v, nb::handle before, double time, double dt,
                nb::tuple orders, nb::tuple shares, bool bounded, Index of_qp, Index of_step,
                nb::object clock, double end) {
    const Tree& tree = model_.tree;
    Buffer<double> position, velocity, anchor;
    position.take(q, 1), velocity.take(v, 1), anchor.take(before, 1);
    expect(position.size() == tree.nq() && velocity.size() == tree.nv() &&
               anchor.size() == gate_.joints(),
           "q (nq,), v (n,) and a torque (a,) expected");
    orders_ = std::move(orders), shares_ = std::move(shares), dt_ = dt;
    clock_ = std::move(clock);
    effort_ = {bounded, of_qp, of_step,
               {clock_.is_none() ? nullptr : nb::cast<Clock*>(clock_), end}};
    return loose(make(position.data(), velocity.data(), anchor.data(), time, now()));
  }

  // See native.pyi.
  nb::object again(double time, nb::handle q, nb::handle v, nb::tuple shares, double allowed) {
    const Time begin = now();
    const Tree& tree = model_.tree;
    const double *position = memory_of(q, tree.nq()), *velocity = memory_of(v, tree.nv());
    if (!position || !velocity || !anchor_.follows(time) || orders_.size() == 0) {
      return nb::none();
    }
    const double* before = anchor_.at(time, gate_.joints());
    if (!before) return nb::none();
    shares_ = std::move(shares);
    Deadline& deadline = effort_.deadline;
    if (deadline.clock) deadline.end = deadline.clock->now() + allowed;
    const Found found = make(position, velocity, before, time, begin);
    if (!found.complete || !found.within || found.gave_way || !(found.excess <= kCounted)) {
      return loose(found);
    }
    anchor_.keep(found.sent, gate_.joints(), time);
    const nb::tuple none;
    return named_tuple(answer_[0], time, found.gated, nb::object(answer_[2]), solution(found), none,
                       none, found.terms, found.solve, seconds(begin, now()));
  }

  Index qps() const { return qps_; }
  double end() const { return effort_.deadline.end; }

 private:
  struct Found {
    Index done = 0, pivots = 0;
    bool complete = false, gave_way = false, within = false;
    double excess = 0.0, terms = 0.0, solve = 0.0;
    nb::object x, torque, gated;  // (n,), (a,) of the blend, and (a,) of the gate
    const double* sent = nullptr;  // memory of the last one
  };

  Found make(const double* q, const double* v, const double* before, double time, Time begin) {
    const Index n = model_.tree.nv(), a = gate_.joints();
    Found found;
    mixture_.take(orders_, shares_, problem_.jacobian.rows);
    model_.update(q, v);
    stack_.stack.measure();
    stack_.stack.track();
    found.gave_way = bound(before, time, dt_);
    const Time terms = now();
    found.terms = seconds(begin, terms);
    found.done = mixture_.answer_all(problem_, effort_);
    found.complete = found.done == static_cast<Index>(mixture_.orders().size());
    if (!found.complete) return found;
    const Mixture& answer = mixture_.mixture();
    const NewArray x(n), torque(a), gated(a);
    x.vector() = answer.acceleration(), torque.vector() = answer.torque();
    found.excess = gate_.follow({torque.data(), a}, before, gated.data());
    found.x = x.object(), found.torque = torque.object(), found.gated = gated.object();
    found.sent = gated.data();
    qps_ = 0;
    for (const Cascade* order : mixture_.orders()) {
      found.pivots += order->pivots(), qps_ += order->qps();
    }
    found.within = answer.within_rate(answer.torque());
    found.solve = seconds(terms, now());
    return found;
  }

  // What Python makes the rest of a step of.
  nb::tuple loose(const Found& found) {
    return nb::make_tuple(found.done, found.pivots, qps_, found.gave_way, found.within,
                          found.excess, found.terms, found.solve,
                          found.complete ? found.gated : nb::none(),
                          found.complete ? solution(found) : nb::none());
  }

  nb::object solution(const Found& found) {
    const Mixture& answer = mixture_.mixture();
    const nb::object none = nb::none();
    return named_tuple(answer_[1], found.x, nb::object(answer_[4]), found.torque,
                       nb::object(answer_[3]), answer.qp_solved(), answer.violation(), 0.0,
                       answer.pivots(), none, none, none, false, 0.0, 0, answer.violation(),
                       no_reason_, nb::object(nothing_));
  }

  // The boxes at the last update of the model; whether one of them gave way.
  bool bound(const double* before, double time, double dt) {
    const Tree& tree = model_.tree;
    const Index n = tree.nv(), u = problem_.unactuated;
    if (jerk_) {
      jerk_->update(problem_.mass_matrix.matrix(), problem_.bias.vector(),
                    problem_.velocity.vector(), {nullptr, 0, 0}, time, dt);
    }
    const Tick tick{tree.q.data() + tree.nq() - (n - u), tree.v.data() + u,
                    tree.gravity_torque.data() + u, before,
                    jerk_ ? jerk_->jerk.data() : nullptr, dt};
    const bool of_acceleration = acceleration_.update_at(tick);
    return torque_.update_at(tick) || of_acceleration;
  }

  nb::object kept_[8];
  Model& model_;
  HeldStack& stack_;
  HeldBoxes &acceleration_, &torque_;
  JerkPlan* jerk_;
  HeldGate& gate_;
  HeldMixture& mixture_;
  HeldAnchor& anchor_;
  nb::tuple answer_;  // StepResult, Solution, their status where solved, and no force
  nb::object no_reason_ = nb::str("");
  nb::object nothing_ = nb::tuple();
  Problem problem_;
  nb::tuple orders_, shares_;  // and the rest: of the last `run`
  nb::object clock_;
  Budget effort_{};
  double dt_ = 0.0;
  Index qps_ = 0;
};

}  // namespace
}  // namespace ghc::python

namespace ghc {

void bind_step(nb::module_& m) {
  using python::HeldStep;
  nb::class_<HeldStep>(m, "Step")
      .def(nb::init<nb::object, nb::object, nb::object, nb::object, nb::object, nb::object,
                    nb::object, nb::tuple>(),
           nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg(), nb::arg(),
           nb::arg())
      .def("run", &HeldStep::run, nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(),
           nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg())
      .def("again", &HeldStep::again)
      .def_prop_ro("qps", &HeldStep::qps)
      .def_prop_ro("end", &HeldStep::end);
}

}  // namespace ghc
