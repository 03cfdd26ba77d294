// The Python face of the model: a tree of joints with its frames.
#include "build_modules.hpp"

#include <nanobind/stl/vector.h>

#include "views.hpp"
#include "model.hpp"

namespace ghc::python {
namespace {

using namespace nb::literals;

Matrix3 matrix3(const double* rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows);
}

Vector3 vector3(const double* values) { return Eigen::Map<const Vector3>(values); }

// One row of `table` a joint: rotation and position in the parent, turn, slide, mass, center,
// inertia: 9 + 3 + 2 + 1 + 3 + 9 numbers.
constexpr size_t kColumns = 27;

void make(Model* self, const std::vector<std::int64_t>& parents, const In2& table, bool floating,
          const In1& gravity, const In1& armature) {
  const size_t count = parents.size();
  expect(count > 0 && table.shape(0) == count && table.shape(1) == kColumns,
         "a table of (joints, 27) numbers expected");
  expect(gravity.size() == 3 && armature.size() == count + (floating ? 5 : 0),
         "gravity (3,) and armature (n,) expected");
  std::vector<Joint> joints;
  for (size_t j = 0; j < count; ++j) {
    const double* row = table.data() + j * kColumns;
    const auto parent = static_cast<Index>(parents[j]);
    expect(parent >= -1 && parent < static_cast<Index>(j), "parents before their children expected");
    expect(!floating || (j == 0) == (parent < 0), "one root, the floating base, expected");
    joints.push_back({parent, matrix3(row), vector3(row + 9), row[12], row[13], row[14],
                      vector3(row + 15), matrix3(row + 18)});
  }
  new (self) Model(std::move(joints), floating, vector3(gravity.data()),
                   ConstVector(armature.data(), static_cast<Index>(armature.size())));
}

}  // namespace

void bind_model(nb::module_& m) {
  nb::class_<Model>(m, "Model")
      .def("__init__", &make, "parents"_a, "table"_a, "floating"_a, "gravity"_a, "armature"_a)
      .def("update",
           [](Model& self, const In1& q, const In1& v) {
             expect(static_cast<Index>(q.size()) == self.tree.nq() &&
                        static_cast<Index>(v.size()) == self.tree.nv(),
                    "q (nq,) and v (n,) expected");
             self.update(q.data(), v.data());
           })
      .def("add_frame",
           [](Model& self, Index joint, const In2& rotation, const In1& position) {
             expect(joint >= -1 && joint < self.tree.joints() && rotation.size() == 9 &&
                        position.size() == 3,
                    "a joint, a rotation (3, 3) and a position (3,) expected");
             return self.frames.add(joint, matrix3(rotation.data()), vector3(position.data()));
           })
      .def("update_frames", [](Model& self) { self.frames.update(); })
      .def("frame", [](nb::handle self, Index number) {
             const auto& frames = nb::cast<const Model&>(self).frames;
             expect(number >= 0 && number < frames.count(), "a number of add_frame expected");
             return frame_views(frames[number], self);
           })
      .def("axes",
           [](nb::handle self, nb::ndarray<double, nb::shape<3, -1>, nb::c_contig> out) {
             const Tree& tree = nb::cast<const Model&>(self).tree;
             expect(static_cast<Index>(out.shape(1)) == tree.nv(), "(3, n) expected");
             for (Index c = 0; c < tree.nv(); ++c) {
               for (Index i = 0; i < 3; ++i) out(i, c) = tree.axis(c).angular[i];
             }
           }, nb::arg("out").noconvert())
      .def_prop_ro("mass", [](const Model& self) { return self.tree.mass(); })
      .def_prop_ro("q", [](nb::handle self) { return view(nb::cast<const Model&>(self).tree.q, self); })
      .def_prop_ro("v", [](nb::handle self) { return view(nb::cast<const Model&>(self).tree.v, self); })
      .def_prop_ro("mass_matrix",
                   [](nb::handle self) {
                     return view(nb::cast<const Model&>(self).tree.mass_matrix, self);
                   })
      .def_prop_ro("bias",
                   [](nb::handle self) { return view(nb::cast<const Model&>(self).tree.bias, self); })
      .def_prop_ro("gravity_torque",
                   [](nb::handle self) {
                     return view(nb::cast<const Model&>(self).tree.gravity_torque, self);
                   })
      .def_prop_ro("center",
                   [](nb::handle self) { return view(nb::cast<const Model&>(self).tree.center, self); })
      .def_prop_ro("center_jacobian", [](nb::handle self) {
        return view(nb::cast<const Model&>(self).tree.center_jacobian, self);
      });
}

}  // namespace ghc::python
