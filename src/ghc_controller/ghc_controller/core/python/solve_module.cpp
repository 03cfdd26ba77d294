#include "solve_module.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include "force_cost.hpp"
#include "held_anchor.hpp"
#include "held_gate.hpp"
#include "held_mixture.hpp"

namespace ghc {
namespace {

using namespace nb::literals;

// One contact after the other, each (normal, last forces, task weight, task force).
void force_costs(double base, double share, double least, nb::list contacts, const Output& center,
                 const Output& factor) {
  const Index c = static_cast<Index>(center.size());
  if (center.ndim() != 1 || factor.ndim() != 2 || static_cast<Index>(factor.shape(0)) != c ||
      static_cast<Index>(factor.shape(1)) != c) {
    throw nb::value_error("center (c,) and factor (c, c) expected");
  }
  Index begin = 0;
  for (nb::handle one : contacts) {
    const auto contact = nb::cast<nb::tuple>(one);
    if (contact.size() != 4) throw nb::value_error("four entries of a contact expected");
    HeldArray held_normal, held_last;
    const View normal = held_normal.take(contact[0], 1), last = held_last.take(contact[1], 1);
    if (normal.size() != last.size() || begin + normal.size() > c) {
      throw nb::value_error("normal and forces of every contact expected");
    }
    const ForceWeights weights{base, share, least, nb::cast<double>(contact[2]),
                               nb::cast<double>(contact[3])};
    force_cost(weights, normal.vector(), last.vector(), center.data() + begin,
               factor.data() + begin * (c + 1), c);
    begin += normal.size();
  }
}

}  // namespace

void bind_solve(nb::module_& m) {
  nb::class_<HeldGate>(m, "Gate")
      .def(nb::init<nb::handle, nb::handle>())
      .def("clip", &HeldGate::clip, "torque"_a, "previous"_a.none(), "out"_a.noconvert());
  m.def("force_costs", &force_costs, "base"_a, "share"_a, "least"_a, "contacts"_a,
        "center"_a.noconvert(), "factor"_a.noconvert());
  nb::class_<Clock>(m, "Clock")
      .def(nb::init<double>(), "step"_a = 0.0)
      .def("now", &Clock::now);
  nb::class_<python::HeldAnchor>(m, "Anchor")
      .def(nb::init<double>())
      .def("note", &python::HeldAnchor::note)
      .def("forget", &python::HeldAnchor::forget)
      .def_prop_ro("is_given", &python::HeldAnchor::is_given)
      .def_prop_ro("time", &python::HeldAnchor::time)
      .def_prop_ro("sent", &python::HeldAnchor::sent)
      .def_prop_rw("before", &python::HeldAnchor::before, &python::HeldAnchor::set_before,
                   nb::for_setter(nb::arg("value").none()));
  nb::class_<Cascade>(m, "Cascade")
      .def(nb::init<std::vector<std::int64_t>, std::vector<std::int64_t>>())
      .def("forget", &Cascade::forget);
  nb::class_<HeldMixture>(m, "Mixture")
      .def(nb::init<double, double, double>())
      .def("solve", &HeldMixture::solve, "orders"_a, "shares"_a, "jacobian"_a, "target"_a,
           "mass_matrix"_a, "bias"_a, "velocity"_a, "x_lower"_a, "x_upper"_a, "tau_lower"_a,
           "tau_upper"_a, "limit_lower"_a, "limit_upper"_a, "rows"_a.none(), "contacts"_a.none(),
           "unactuated"_a, "bounded"_a, "of_qp"_a, "of_step"_a,
           "clock"_a = nb::none(), "end"_a = 0.0, "costs"_a = nb::tuple())
      .def("retune", &HeldMixture::retune)
      .def("answer", &HeldMixture::answer, "index"_a, "bounded"_a, "of_qp"_a, "of_order"_a,
           "clock"_a = nb::none(), "end"_a = 0.0)
      .def("forces", &HeldMixture::forces)
      .def("reduced", &HeldMixture::reduced, "index"_a = nb::none());
  m.def("reduced", [](nb::handle J, nb::handle b, nb::handle M, nb::handle h, nb::handle contacts,
                      Index unactuated, bool balance) {
    HeldProblem held;
    Reduction reduction;
    const Problem& problem = held.take_motion(J, b, M, h, contacts, unactuated);
    reduction.keep_contacts(problem);
    if (balance) reduction.balance();
    return reduced_arrays(reduction);
  }, "jacobian"_a, "target"_a, "mass_matrix"_a, "bias"_a, "contacts"_a.none(), "unactuated"_a,
     "balance"_a);
  m.def("null_motion", [](nb::handle rows, nb::handle target) {
    HeldArray matrix, vector;
    const View R = matrix.take(rows, 2), goal = vector.take(target, 1);
    if (goal.size() != R.rows) throw nb::value_error("rows (q, n) and targets (q,) expected");
    NullMotion motion;
    const bool independent = motion.solve(R.matrix(), goal.vector());
    return nb::make_tuple(independent, new_vector(motion.least()), new_matrix(motion.basis()));
  });
}

}  // namespace ghc
