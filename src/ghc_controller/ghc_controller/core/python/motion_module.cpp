// The Python face of references, previews, force rows and states: small loops of every tick.
#include <algorithm>
#include <cmath>

#include "buffers.hpp"
#include "compare_modules.hpp"
#include "distance_row.hpp"
#include "force_rows.hpp"
#include "motions.hpp"

namespace ghc::python {
namespace {

struct OfThree : In {
  explicit OfThree(nb::handle given) : In(given, 1) { fits(entries() == 3, "(3,) expected"); }
};

struct OfState : In {
  explicit OfState(nb::handle given) : In(given, 2) {
    fits(rows() == 3 && cols() == 3, "a state (3, 3) expected");
  }
};

struct OfJerks : In {
  explicit OfJerks(nb::handle given) : In(given, 2) { fits(cols() == 3, "jerks (N, 3) expected"); }
};

struct Written : Buffer<double> {
  Written(nb::handle given, int axes) { take_writable(given, axes); }
};

nb::object evaluate(nb::handle coefficients, double s) {
  const In c(coefficients, 2);
  const NewArray out(3, c.cols());
  evaluate_polynomial(c.matrix(), s, out.matrix());
  return out.object();
}

nb::tuple turned(nb::handle start, nb::handle p, nb::handle rate, nb::handle change) {
  const In q(start, 1);
  fits(q.entries() == 4, "a quaternion (4,) expected");
  const OfThree vector(p), first(rate), second(change);
  const NewArray quaternion(4), velocity(3), acceleration(3);
  turned_motion(q.data(), vector.data(), first.data(), second.data(), quaternion.data(),
                velocity.data(), acceleration.data());
  return nb::make_tuple(quaternion.object(), velocity.object(), acceleration.object());
}

nb::object integrate(nb::handle state, nb::handle jerk, double step) {
  const OfState from(state);
  const OfJerks jerks(jerk);
  const NewArray states(jerks.rows() + 1, 3, 3);
  integrate_jerks(from.data(), jerks.matrix(), step,
                  Eigen::Map<Matrix>(states.data(), jerks.rows() + 1, 9));
  return states.object();
}

nb::object state_at(nb::handle state, nb::handle jerk, double step, double elapsed) {
  const OfState from(state);
  const OfJerks jerks(jerk);
  fits(step > 0.0 && std::isfinite(elapsed), "a step above 0 and a finite time expected");
  const NewArray out(3, 3);
  state_after(from.data(), jerks.matrix(), step, elapsed, out.data());
  return out.object();
}

nb::tuple points_at(nb::handle lower, nb::handle upper, double place, bool interpolate) {
  const In low(lower, 2), high(upper, 2);
  fits(low.cols() >= 1 && low.rows() == high.rows() && low.cols() == high.cols(),
       "points (r, N + 1) of both bounds expected");
  const NewArray least(low.rows()), most(low.rows());
  bounds_at(low.matrix(), high.matrix(), place, interpolate, least.data(), most.data());
  return nb::make_tuple(least.object(), most.object());
}

nb::tuple motion_of(nb::handle points, double place, double step) {
  const In p(points, 2);
  fits(p.cols() >= 4, "points (r, N + 1) with N of 3 or more expected");
  const NewArray rate(p.rows()), acceleration(p.rows());
  motion_of_points(p.matrix(), place, step, rate.data(), acceleration.data());
  return nb::make_tuple(rate.object(), acceleration.object());
}

void move(nb::handle rows, Index first, nb::handle goal, nb::handle rate, nb::handle lower,
          nb::handle upper, nb::handle velocity, nb::handle acceleration, nb::handle jerk, bool brake) {
  const Written states(rows, 3);
  const In to(goal, 1), by(rate, 1), low(lower, 1), high(upper, 1), fast(velocity, 1),
      strong(acceleration, 1), smooth(jerk, 1);
  const Index n = states.shape(2);
  bool equal = states.shape(1) == 3 && first >= 1 && first <= states.shape(0);
  for (const In* one : {&to, &by, &low, &high, &fast, &strong, &smooth}) {
    equal = equal && one->entries() == n;
  }
  fits(equal, "states (s, 3, n) of which the first is given, and vectors (n,) expected");
  move_joints(states.data(), states.shape(0), n, first, to.data(), by.data(),
              {low.data(), high.data(), fast.data(), strong.data(), smooth.data()}, brake);
}

double row_of_obstacle(nb::handle jacobian, nb::handle position, nb::handle velocity,
                       nb::handle drift, nb::handle normal, nb::handle state, double safe_distance,
                       double dt, nb::handle row) {
  const In J(jacobian, 2), v(velocity, 1), dJ_v(drift, 1);
  const OfThree p(position), n(normal);
  const OfState of(state);
  const Written out(row, 1);
  fits(J.rows() == 6 && v.entries() == 6 && dJ_v.entries() == 6 && out.size() == J.cols(),
       "terms of a frame and a row (n,) expected");
  return distance_row({J.matrix(), p.data(), v.data(), dJ_v.data()}, n.data(), of.data(),
                      safe_distance, dt, out.data());
}

nb::object follow_force(nb::handle under_force, nb::handle axes, double step, double share,
                        nb::handle reference, nb::handle wrench, nb::tuple gains,
                        nb::handle integral, nb::handle error, nb::handle velocity,
                        nb::handle acceleration, nb::handle stiffness, nb::handle damping) {
  Buffer<bool> chosen;
  Buffer<std::int64_t> axis;
  chosen.take(under_force, 1), axis.take(axes, 1);
  const In wanted(reference, 1), measured(wrench, 1);
  const Written sum(integral, 1), e(error, 1), v(velocity, 1), a(acceleration, 1), k(stiffness, 1),
      d(damping, 1);
  const Index m = axis.size();
  bool equal = chosen.size() == m && wanted.entries() == m && gains.size() == 4;
  for (const Written* one : {&sum, &e, &v, &a, &k, &d}) equal = equal && one->size() == m;
  for (Index i = 0; equal && i < m; ++i) {
    equal = axis.data()[i] >= 0 && axis.data()[i] < measured.entries();
  }
  fits(equal, "an entry for each of m rows, and four gains expected");
  const ForceGains given{nb::cast<double>(gains[0]), nb::cast<double>(gains[1]),
                         nb::cast<double>(gains[2]), nb::cast<double>(gains[3])};
  const HybridRows rows{e.data(), v.data(), a.data(), k.data(), d.data()};
  const NewArray exerted(m);
  for (Index i = 0; i < m; ++i) {
    exerted.data()[i] =
        chosen.data()[i] ? force_row(i, wanted.data()[i], measured.data()[axis.data()[i]], share,
                                     step, given, sum.data()[i], rows)
                         : 0.0;
  }
  return exerted.object();
}

nb::tuple in_order(nb::handle values, nb::handle index) {
  const In given(values, 1);
  Buffer<std::int64_t> places;
  places.take(index, 1);
  const NewArray ordered(places.size());
  bool finite = true;
  for (Index k = 0; k < places.size(); ++k) {
    const std::int64_t place = places.data()[k];
    fits(place >= 0 && place < given.entries(), "indices of the values expected");
    ordered.data()[k] = given.data()[place];
    finite = finite && std::isfinite(ordered.data()[k]);
  }
  return nb::make_tuple(ordered.object(), finite);
}

nb::tuple force_limits(nb::handle lower, nb::handle upper, nb::handle places) {
  const In low(lower, 1), high(upper, 1);
  Buffer<std::int64_t> of;
  of.take(places, 1);
  fits(low.entries() == high.entries(), "as many lower as upper bounds expected");
  const NewArray least(of.size()), most(of.size());
  for (Index k = 0; k < of.size(); ++k) {
    const std::int64_t place = of.data()[k];
    fits(place >= 0 && place < low.entries(), "places of contacts expected");
    most.data()[k] = std::max(high.data()[place], 0.0);
    least.data()[k] = std::min(low.data()[place], most.data()[k]);
  }
  return nb::make_tuple(least.object(), most.object());
}

}  // namespace

void bind_motions(nb::module_& m) {
  m.def("evaluate", &evaluate);
  m.def("turned_motion", &turned);
  m.def("integrate", &integrate);
  m.def("state_at", &state_at);
  m.def("bounds_at", &points_at);
  m.def("motion_of", &motion_of);
  m.def("move_joints", &move);
  m.def("distance_row", &row_of_obstacle);
  m.def("follow_force", &follow_force);
  m.def("in_order", &in_order);
  m.def("force_limits", &force_limits);
}

}  // namespace ghc::python
