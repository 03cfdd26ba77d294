// Frames of the links of a tree: pose, Jacobian, velocity and drift of each one in use.
#pragma once

#include <deque>
#include <vector>

#include "tree.hpp"

namespace ghc {

// All of a frame's origin, in the axes it is seen in, linear part first: velocity = J v, classical
// acceleration = J dv + drift.
struct FrameTerms {
  explicit FrameTerms(Index n) : jacobian(Matrix::Zero(6, n)) {
    pose.setZero();
    motion.setZero();
  }

  auto rotation() const { return pose.topRows<3>(); }
  Vector3 position() const { return pose.row(3).transpose(); }

  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> pose;    // rotation, then position [m]
  Eigen::Matrix<double, 2, 6, Eigen::RowMajor> motion;  // velocity, then drift
  Matrix jacobian;                                      // (6, n)
};

// A frame on a link, as seen from the world.
struct Frame {
  Index joint;  // that carries it; -1: the world
  Matrix3 offset_rotation;
  Vector3 offset;             // [m] in the frame of the joint
  std::vector<Index> moving;  // columns of v that move it
  FrameTerms terms;
};

class Frames {
 public:
  explicit Frames(const Tree& tree) : tree_(tree) {}

  // Number of a new frame at a place in the frame of a joint; current after `update`.
  Index add(Index joint, const Matrix3& rotation, const Vector3& position);

  // Every frame from the tree's last update.
  void update();

  const FrameTerms& operator[](Index number) const { return frames_[number].terms; }
  Index count() const { return static_cast<Index>(frames_.size()); }

 private:
  void update(Frame& frame) const;

  const Tree& tree_;
  std::deque<Frame> frames_;  // stay where they are in memory
};

// Terms of a frame B as seen from a frame A, in the axes of A. With r = p_B - p_A and
// u = v_B - v_A - w_A x r, turned by R_A^T: velocity = (u, w_B - w_A), drift = (a_B - a_A - b_A x r
// - w_A x (w_A x r) - 2 w_A x u, b_B - b_A - w_A x (w_B - w_A)), (a, b) the drift of a frame.
void see_from(const FrameTerms& base, const FrameTerms& frame, FrameTerms& seen);

}  // namespace ghc
