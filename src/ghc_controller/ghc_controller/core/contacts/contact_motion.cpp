#include "contact_motion.hpp"

#include <algorithm>

namespace ghc {

void force_map(const FrameView& frame, const Axes& points, const Axes& axes, double* out) {
  const Index n = frame.jacobian.cols();
  for (Index p = 0; p < points.rows(); ++p) {
    const Vector3 arm = frame.rotation * points.row(p).transpose();
    for (Index k = 0; k < axes.rows(); ++k, out += n) {
      const Vector3 axis = axes.row(k).transpose();
      Eigen::Matrix<double, 1, 6> wrench;  // axis . (w x arm) = w . (arm x axis)
      wrench << axis.transpose(), arm.cross(axis).transpose();
      Eigen::Map<RowVector>(out, n).noalias() = wrench * frame.jacobian;
    }
  }
}

void point_motion(const FrameView& frame, const Axes& points, const Axes& axes, double rate,
                  double* target) {
  const Eigen::Map<const Vector3> v(frame.velocity), w(frame.velocity + 3);
  const Eigen::Map<const Vector3> a(frame.drift), b(frame.drift + 3);
  for (Index p = 0; p < points.rows(); ++p) {
    // A point at arm r has the velocity v + w x r and the drift a + b x r + w x (w x r).
    const Vector3 arm = frame.rotation * points.row(p).transpose();
    const Vector3 turn = w.cross(arm);
    const Vector3 still = a + b.cross(arm) + w.cross(turn) + rate * (v + turn);
    for (Index k = 0; k < axes.rows(); ++k) *target++ = -axes.row(k).dot(still);
  }
}

void frame_motion(const FrameView& frame, double rate, double* target) {
  for (Index r = 0; r < 6; ++r) target[r] = -frame.drift[r] - rate * frame.velocity[r];
}

void write_contact(const Model& model, const ContactPart& contact, double rate, double* jacobian,
                   double* target, double* force_jacobian) {
  const Index n = model.tree.nv();
  const FrameView frame(model.frames[contact.frame]);
  double* const forces = force_jacobian + contact.force * n;
  double* const rows = jacobian + contact.motion * n;
  force_map(frame, contact.points, contact.axes, forces);
  if (contact.whole) {
    std::copy_n(frame.jacobian.data(), 6 * n, rows);
    frame_motion(frame, rate, target + contact.motion);
  } else {
    std::copy_n(forces, contact.points.rows() * contact.axes.rows() * n, rows);
    point_motion(frame, contact.points, contact.axes, rate, target + contact.motion);
  }
}

}  // namespace ghc
