// The Python face of the joint limits: their boxes, the merge, and the jerk they plan with.
#include <nanobind/stl/vector.h>

#include "build_modules.hpp"
#include "held_boxes.hpp"
#include "jerk_plan.hpp"
#include "joint_bounds.hpp"

namespace ghc::python {
namespace {

using namespace nb::literals;

void write_box(const JointBox& box, const Model& model, const In1& previous, double dt,
               const In1& jerk, const InOut1& lower, const InOut1& upper) {
  const Index skipped = static_cast<Index>(lower.size()) - box.joints();
  expect(skipped >= 0 && lower.size() == upper.size(), "bounds of each joint expected");
  box.write(tick_of(model, previous, dt, jerk, box.joints()), lower.data() + skipped,
            upper.data() + skipped);
}

void plan(JerkPlan& self, const In2& mass, const In1& bias, const In1& velocity,
          const In2& contacts, double time, double dt) {
  const auto n = static_cast<size_t>(self.carried.cols());
  expect(mass.shape(0) == n && mass.shape(1) == n && bias.size() == n && velocity.size() == n &&
             (!contacts.is_valid() || contacts.shape(1) == n),
         "M (n, n), h (n,), v (n,) and contacts (q, n) expected");
  self.update(matrix(mass), vector(bias), vector(velocity), matrix(contacts), time, dt);
}

}  // namespace

void bind_boxes(nb::module_& m) {
  const auto out = nb::arg().noconvert();  // kept, or written in place: never a copy
  const auto in = nb::arg();
  const auto none = nb::arg().none();
  nb::class_<JointBox>(m, "JointBox")
      .def("write", &write_box, in, none, in, none, out, out);
  nb::class_<TorqueBox, JointBox>(m, "TorqueBox")
      .def("__init__",
           [](TorqueBox* self, const In1& limit, bool around_gravity) {
             new (self) TorqueBox(vector(limit), around_gravity);
           },
           out, in, nb::keep_alive<1, 2>())
      .def("set_range", [](TorqueBox& self, const In1& lower, const In1& upper) {
        self.set_range(vector(lower), vector(upper));
      });
  nb::class_<RateBox, JointBox>(m, "RateBox")
      .def("__init__", [](RateBox* self, const In1& rate) { new (self) RateBox(vector(rate)); },
           out, nb::keep_alive<1, 2>());
  nb::class_<VelocityBox, JointBox>(m, "VelocityBox")
      .def("__init__", [](VelocityBox* self, const In1& limit, double horizon) {
        new (self) VelocityBox(vector(limit), horizon);
      }, out, in, nb::keep_alive<1, 2>())
      .def_rw("horizon", &VelocityBox::horizon);
  nb::class_<PositionBox, JointBox>(m, "PositionBox")
      .def("__init__",
           [](PositionBox* self, const In1& brake, double rate) {
             new (self) PositionBox(vector(brake), rate);
           },
           out, in, nb::keep_alive<1, 2>())
      .def("set_limits", [](PositionBox& self, const In1& lower, const In1& upper,
                            const In2& rates, const In2& accelerations) {
        self.set_limits({vector(lower), vector(upper), matrix(rates), matrix(accelerations)});
      });
  nb::class_<HeldBoxes>(m, "BoxMerge")
      .def(nb::init<nb::list, Index, InOut2, InOut2, InOut2, Sources, InOut2>(), in, in, out, out,
           out, out, out)
      .def("update", &HeldBoxes::update, in, none, in, none);
  nb::class_<JerkPlan>(m, "JerkPlan")
      .def("__init__",
           [](JerkPlan* self, const In1& rate, Index n) {
             expect(n >= static_cast<Index>(rate.size()), "n of at least the joints expected");
             new (self) JerkPlan(vector(rate));
             self->carried = Matrix::Zero(static_cast<Index>(rate.size()), n);
           },
           out, in, nb::keep_alive<1, 2>())
      .def("update", &plan, in, in, in, none, in, in)
      .def("reset", &JerkPlan::reset)
      .def_prop_ro("share", [](const JerkPlan& self) { return self.share; })
      .def_prop_ro("jerk",
                   [](nb::handle self) { return view(nb::cast<const JerkPlan&>(self).jerk, self); })
      .def_prop_ro("drift",
                   [](nb::handle self) { return view(nb::cast<const JerkPlan&>(self).drift, self); })
      .def_prop_ro("carried", [](nb::handle self) {
        return view(nb::cast<const JerkPlan&>(self).carried, self);
      });
  m.def("stopping_distance", &stopping_distance);
  m.def("velocity_bound", &velocity_bound);
  m.def("position_bound", &position_bound);
  m.def("viable_acceleration", &viable_acceleration);
  m.def("moving_approach", &moving_approach);
}

}  // namespace ghc::python
