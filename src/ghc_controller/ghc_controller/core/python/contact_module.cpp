// The Python face of the contacts' rows.
#include <algorithm>
#include <utility>
#include <vector>

#include "build_modules.hpp"
#include "contact_motion.hpp"
#include "views.hpp"

namespace ghc::python {
namespace {

Axes axes_of(const In2& a) { return {a.data(), static_cast<Index>(a.shape(0)), 3}; }

FrameView frame_of(const In2& rotation, const In2& jacobian, const In1& velocity,
                   const In1& drift) {
  expect(rotation.size() == 9 && jacobian.shape(0) == 6 && velocity.size() == 6 &&
             drift.size() == 6,
         "terms of a frame expected");
  return {rotation.data(),
          ConstMatrix(jacobian.data(), 6, static_cast<Index>(jacobian.shape(1))),
          velocity.data(), drift.data()};
}

void write_force_map(const In2& rotation, const In2& jacobian, const In2& points, const In2& axes,
                     const InOut2& out) {
  expect(rotation.size() == 9 && jacobian.shape(0) == 6 && points.shape(1) == 3 &&
             axes.shape(1) == 3 && out.shape(0) == points.shape(0) * axes.shape(0) &&
             out.shape(1) == jacobian.shape(1),
         "a row for each point (p, 3) and axis (a, 3) expected");
  const FrameView frame(rotation.data(),
                        ConstMatrix(jacobian.data(), 6, static_cast<Index>(jacobian.shape(1))),
                        nullptr, nullptr);
  force_map(frame, axes_of(points), axes_of(axes), out.data());
}

void write_point_motion(const In2& rotation, const In2& jacobian, const In1& velocity,
                        const In1& drift, const In2& points, const In2& axes, double rate,
                        const InOut1& target) {
  expect(points.shape(1) == 3 && axes.shape(1) == 3 &&
             target.size() == points.shape(0) * axes.shape(0),
         "an entry for each point (p, 3) and axis (a, 3) expected");
  point_motion(frame_of(rotation, jacobian, velocity, drift), axes_of(points), axes_of(axes), rate,
               target.data());
}

// Contacts that are on, with the arrays that they are made of.
class HeldContacts {
 public:
  explicit HeldContacts(double rate) : rate_(rate) {}

  void add(Index frame, In2 points, In2 axes, bool whole, Index force, Index motion) {
    expect(points.shape(1) == 3 && axes.shape(1) == 3 && frame >= 0 && force >= 0 && motion >= 0,
           "points (p, 3), axes (a, 3) and first rows expected");
    const ContactPart part{frame, axes_of(points), axes_of(axes), whole, force, motion};
    const Index forces = part.points.rows() * part.axes.rows();
    frames_ = std::max(frames_, frame + 1);
    force_end_ = std::max(force_end_, force + forces);
    motion_end_ = std::max(motion_end_, motion + (whole ? 6 : forces));
    kept_.push_back(std::move(points));
    kept_.push_back(std::move(axes));
    parts_.push_back(part);
  }

  void write(const Model& model, const InOut2& jacobian, const InOut1& target,
             const InOut2& force_jacobian) const {
    const auto n = static_cast<size_t>(model.tree.nv());
    expect(frames_ <= model.frames.count() && jacobian.shape(1) == n &&
               force_jacobian.shape(1) == n && jacobian.shape(0) == target.size() &&
               motion_end_ <= static_cast<Index>(target.size()) &&
               force_end_ <= static_cast<Index>(force_jacobian.shape(0)),
           "a Jacobian (q, n), a target (q,) and a force map (c, n) expected");
    for (const ContactPart& part : parts_) {
      write_contact(model, part, rate_, jacobian.data(), target.data(), force_jacobian.data());
    }
  }

 private:
  double rate_;
  Index frames_ = 0, force_end_ = 0, motion_end_ = 0;
  std::vector<In2> kept_;
  std::vector<ContactPart> parts_;
};

}  // namespace

void bind_contacts(nb::module_& m) {
  const auto in = nb::arg();
  const auto out = nb::arg().noconvert();  // kept, or written in place: never a copy
  nb::class_<HeldContacts>(m, "ContactMotion")
      .def(nb::init<double>())
      .def("add", &HeldContacts::add, in, out, out, in, in, in)
      .def("write", &HeldContacts::write, in, out, out, out);
  m.def("write_force_map", &write_force_map, in, in, in, in, out);
  m.def("write_point_motion", &write_point_motion, in, in, in, in, in, in, in, out);
}

}  // namespace ghc::python
