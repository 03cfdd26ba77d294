// The Python face of what generators plan (ghc_mpc_constraints).
#include "bounded_plans.hpp"
#include "buffers.hpp"
#include "compare_modules.hpp"

namespace ghc::python {
namespace {

nb::tuple bounded_motion(double step, nb::handle state, nb::handle raw, nb::handle weights,
                         nb::handle limit, double jerk_weight) {
  const In start(state, 1), wanted(raw, 1), of_points(weights, 1), most(limit, 1);
  const Index steps = wanted.entries();
  fits(start.entries() == 3 && of_points.entries() == steps && most.entries() == steps,
       "a state (3,), and raw points, weights and limits (N,) expected");
  MotionPlan plan(step, of_points.vector(), jerk_weight);
  const NewArray jerk(steps);
  const bool solved = plan.solve(start.data(), wanted.vector(), most.vector(), jerk.vector());
  return nb::make_tuple(jerk.object(), solved);
}

nb::tuple force_bounds(nb::handle inverses, nb::handle pulls, double lower_now, double upper_now,
                       nb::handle raw_lower, nb::handle raw_upper) {
  const In both(inverses, 3), pull(pulls, 1), low(raw_lower, 1), high(raw_upper, 1);
  const Index steps = high.entries();
  fits(steps > 0 && both.shape(0) == 2 && both.shape(1) == steps && both.shape(2) == steps &&
           pull.entries() == 2 && low.entries() == steps,
       "inverses (2, N, N), pulls (2,) and raw bounds (N,) expected");
  const NewArray out(2, steps);
  const bool solved = plan_force_bounds(
      {both.data(), steps, steps}, {both.data() + steps * steps, steps, steps}, pull.data(),
      lower_now, upper_now, low.vector(), high.vector(), out.matrix());
  return nb::make_tuple(out.object(), solved);
}

}  // namespace

void bind_plans(nb::module_& m) {
  m.def("bounded_motion", &bounded_motion);
  m.def("force_bounds", &force_bounds);
}

}  // namespace ghc::python
