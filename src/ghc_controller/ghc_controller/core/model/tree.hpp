// Kinematics and dynamics of a tree of joints at one state, in world axes.
//
// One pass outwards (placements, velocities, accelerations at dv = 0) and one inwards (composite
// inertias and forces) give M and h of M dv + h = tau: the composite-rigid-body and the recursive
// Newton-Euler algorithm of R. Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 5, 6.
// Spatial vectors are taken about one point o for all bodies, so that nothing is transformed from
// link to link. o is the origin of a floating base: no digits are lost far from the world's.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "matrix.hpp"

namespace ghc {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

// A spatial vector about o: of a velocity (v_o, w) or a force (f, torque about o).
struct Spatial {
  Vector3 linear, angular;

  double dot(const Spatial& other) const {
    return linear.dot(other.linear) + angular.dot(other.angular);
  }
  void operator+=(const Spatial& other) {
    linear += other.linear;
    angular += other.angular;
  }
};

// Mass, first moment and second moments of a body about o.
struct Inertia {
  double mass;
  Vector3 moment;    // mass times the center of mass
  Matrix3 rotation;  // symmetric

  Spatial operator*(const Spatial& motion) const {
    return {mass * motion.linear + motion.angular.cross(moment),
            moment.cross(motion.linear) + rotation * motion.angular};
  }
};

// What of a joint and its link does not move. Its axis is z of its own frame.
struct Joint {
  Index parent;       // -1: the world
  Matrix3 rotation;   // of its frame in that of the parent, at q = 0
  Vector3 position;   // [m]
  double turn, slide; // per unit of q: 1, 0 revolute; 0, 1 prismatic; 1, pitch helical
  double mass;        // [kg]
  Vector3 center;     // [m] center of mass
  Matrix3 inertia;    // [kg m^2] about the center of mass
};

struct BodyState {
  Matrix3 rotation;  // to the world
  Vector3 position;  // [m] from o
  Spatial velocity;
  Spatial acceleration;  // at dv = 0, of a world that falls up: minus gravity
};

class Tree {
 public:
  // Joints in an order in which parents come first; with `floating` the first one is a free flyer
  // (q: position, quaternion x, y, z, w; v: linear, angular in its own axes).
  Tree(std::vector<Joint> joints, bool floating, const Vector3& gravity, Vector armature);

  // Everything below at a state q (nq,), v (n,).
  void update(const double* q, const double* v);

  Index nq() const { return static_cast<Index>(joints_.size()) + (floating_ ? 6 : 0); }
  Index nv() const { return static_cast<Index>(joints_.size()) + (floating_ ? 5 : 0); }
  bool floating() const { return floating_; }
  Index joints() const { return static_cast<Index>(joints_.size()); }
  Index parent(Index joint) const { return joints_[joint].parent; }
  Index first_column(Index joint) const { return floating_ && joint > 0 ? joint + 5 : joint; }
  Index columns(Index joint) const { return floating_ && joint == 0 ? 6 : 1; }

  const BodyState& body(Index joint) const { return bodies_[joint]; }
  const Spatial& axis(Index column) const { return axes_[column]; }  // velocity of one unit of v
  const Vector3& origin() const { return origin_; }                   // o in the world [m]
  const Vector3& gravity() const { return gravity_; }                 // [m/s^2]
  double mass() const { return total_mass_; }                         // [kg]

  // Arrays whose memory stays where it is.
  Matrix mass_matrix;        // (n, n) M
  Vector bias;               // (n,) h
  Vector gravity_torque;     // (n,) h at v = 0
  Vector q, v;               // the state
  Matrix center_jacobian;    // (3, n) of the center of mass
  Matrix center;             // (3, 3) rows: its position, velocity, and acceleration at dv = 0

 private:
  void outwards();
  void inwards();
  void place_base();
  void place(Index joint);
  void add_body(Index joint);

  std::vector<Joint> joints_;
  bool floating_;
  Vector3 gravity_, origin_;
  Vector armature_;
  double total_mass_ = 0.0;
  std::vector<BodyState> bodies_;
  std::vector<Spatial> axes_;
  std::vector<Inertia> composite_;  // of each joint and all that it carries
  std::vector<Spatial> force_;      // alike, to move them with dv = 0
};

}  // namespace ghc
