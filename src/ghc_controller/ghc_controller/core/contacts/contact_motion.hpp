// Rows of contacts: where their forces act, and the accelerations that keep them still.
#pragma once

#include <vector>

#include "model.hpp"

namespace ghc {

using Axes = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;

// A frame as NumPy or FrameTerms hold it.
struct FrameView {
  explicit FrameView(const FrameTerms& terms)
      : rotation(terms.pose.data()),
        jacobian(terms.jacobian.data(), 6, terms.jacobian.cols()),
        velocity(terms.motion.data()),
        drift(terms.motion.data() + 6) {}
  FrameView(const double* turn, const ConstMatrix& rows, const double* speed, const double* change)
      : rotation(turn), jacobian(rows), velocity(speed), drift(change) {}

  Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation;
  ConstMatrix jacobian;           // (6, n) of its origin, world axes
  const double *velocity, *drift;  // (6,)
};

// J_f (p * a, n) of points (p, 3) in the frame and axes (a, 3) in the world, point by point:
// axis . (J_lin + J_ang x (R point)). Forces f along the axes exert J_f^T f.
void force_map(const FrameView& frame, const Axes& points, const Axes& axes, double* out);

// Accelerations (p * a,) that keep the points still along the axes, -dJ/dt v - rate * velocity.
void point_motion(const FrameView& frame, const Axes& points, const Axes& axes, double rate,
                  double* target);

// Accelerations (6,) that keep the frame still.
void frame_motion(const FrameView& frame, double rate, double* target);

// A contact that keeps its points still along the axes of its forces, or its frame as a whole.
struct ContactPart {
  Index frame;
  Axes points, axes;
  bool whole;
  Index force, motion;  // first of its rows
};

// Write the rows of a contact into J_c (q, n), the accelerations J_c x (q,), and J_f (c, n).
void write_contact(const Model& model, const ContactPart& contact, double rate, double* jacobian,
                   double* target, double* force_jacobian);

}  // namespace ghc
