// The Python face of the tasks: measures of the standard kinds, and the stack of all rows.
#include <nanobind/stl/vector.h>

#include "build_modules.hpp"
#include "held_stack.hpp"

namespace ghc::python {
namespace {

using namespace nb::literals;

std::vector<Index> indices(const std::vector<std::int64_t>& given) {
  return {given.begin(), given.end()};
}

Vector copied(const In1& values) {
  return ConstVector(values.data(), static_cast<Index>(values.size()));
}

void write_rows(Measure& measure, const Model& model, const In1& reference, const InOut1& error,
                const InOut1& drift, const InOut1& velocity, const InOut1& acceleration,
                const InOut2& jacobian) {
  const auto m = static_cast<size_t>(measure.rows());
  measure.check(model);
  expect(measure.reference_size() == 0 ||
             static_cast<Index>(reference.size()) == measure.reference_size(),
         "a reference as the kind of task counts it expected");
  expect(error.size() == m && drift.size() == m && velocity.size() == m &&
             acceleration.size() == m && jacobian.shape(0) == m &&
             static_cast<Index>(jacobian.shape(1)) == model.tree.nv(),
         "vectors (m,) and a Jacobian (m, n) expected");
  measure.write(model, reference.data(),
                {error.data(), drift.data(), velocity.data(), acceleration.data(),
                 jacobian.data()});
}

// A frame as seen from another one.
struct SeenFrame {
  FrameTerms terms;

  void update(const Model& model, Index base, Index frame) {
    const Index count = model.frames.count();
    expect(base >= 0 && base < count && frame >= 0 && frame < count &&
               terms.jacobian.cols() == model.tree.nv(),
           "two frames of the model expected");
    see_from(model.frames[base], model.frames[frame], terms);
  }
};

}  // namespace

void bind_tasks(nb::module_& m) {
  const auto out = nb::arg().noconvert();  // written in place: never a copy
  nb::class_<Measure>(m, "Measure")
      .def("write", &write_rows, nb::arg(), nb::arg(), out, out, out, out, out)
      .def_prop_ro("reference_size", &Measure::reference_size);
  nb::class_<FrameMeasure, Measure>(m, "FrameMeasure")
      .def("__init__",
           [](FrameMeasure* self, const std::vector<std::int64_t>& rows, Index frame, Index base) {
             new (self) FrameMeasure(indices(rows), frame, base);
           });
  nb::class_<CenterMeasure, Measure>(m, "CenterMeasure")
      .def("__init__", [](CenterMeasure* self, const std::vector<std::int64_t>& axes) {
        new (self) CenterMeasure(indices(axes));
      });
  nb::class_<JointMeasure, Measure>(m, "JointMeasure")
      .def("__init__", [](JointMeasure* self, const std::vector<std::int64_t>& joints) {
        new (self) JointMeasure(indices(joints));
      });
  nb::class_<EdgeMeasure, Measure>(m, "EdgeMeasure")
      .def("__init__", [](EdgeMeasure* self, const In1& lower, const In1& upper) {
        new (self) EdgeMeasure(copied(lower), copied(upper));
      });
  nb::class_<HeldStack>(m, "TaskStack")
      .def(nb::init<nb::object, nb::list, std::vector<std::int64_t>, InOut2, InOut2, InOut1>(),
           nb::arg(), nb::arg(), nb::arg(), out, out, out)
      .def("measure", [](HeldStack& self) { self.stack.measure(); })
      .def("measure_and_track", [](HeldStack& self) {
        self.stack.measure();
        self.stack.track();
      });
  m.def("track", [](const In2& jacobian, const In1& velocity, const InOut2& vectors) {
    const auto rows = static_cast<Index>(jacobian.shape(0));
    const auto n = static_cast<Index>(jacobian.shape(1));
    expect(static_cast<Index>(velocity.size()) == n && vectors.shape(0) == 7 &&
               static_cast<Index>(vectors.shape(1)) == rows,
           "a Jacobian (m, n), a velocity (n,) and vectors (7, m) expected");
    ghc::track(ConstMatrix(jacobian.data(), rows, n), velocity.data(),
               Eigen::Map<Matrix>(vectors.data(), 7, rows));
  }, nb::arg(), nb::arg(), out);
  nb::class_<SeenFrame>(m, "SeenFrame")
      .def("__init__", [](SeenFrame* self, Index n) { new (self) SeenFrame{FrameTerms(n)}; })
      .def("update", &SeenFrame::update)
      .def("arrays", [](nb::handle self) {
        const FrameTerms& terms = nb::cast<const SeenFrame&>(self).terms;
        return frame_views(terms, self);
      });
}

}  // namespace ghc::python
