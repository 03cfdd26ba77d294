#include "tree.hpp"

#include <cmath>
#include <utility>

namespace ghc {
namespace {

// Rate of a spatial vector that is carried along by `motion`.
Spatial carried(const Spatial& motion, const Spatial& vector) {
  return {motion.angular.cross(vector.linear) + motion.linear.cross(vector.angular),
          motion.angular.cross(vector.angular)};
}

Spatial carried_force(const Spatial& motion, const Spatial& momentum) {
  return {motion.angular.cross(momentum.linear),
          motion.angular.cross(momentum.angular) + motion.linear.cross(momentum.linear)};
}

}  // namespace

Tree::Tree(std::vector<Joint> joints, bool floating, const Vector3& gravity, Vector armature)
    : joints_(std::move(joints)),
      floating_(floating),
      gravity_(gravity),
      origin_(Vector3::Zero()),
      armature_(std::move(armature)) {
  const Index n = nv();
  bodies_.resize(joints_.size());
  composite_.resize(joints_.size());
  force_.resize(joints_.size());
  axes_.resize(n);
  mass_matrix = Matrix::Zero(n, n);
  bias = gravity_torque = v = Vector::Zero(n);
  q = Vector::Zero(nq());
  center_jacobian = Matrix::Zero(3, n);
  center = Matrix::Zero(3, 3);
  for (const Joint& joint : joints_) total_mass_ += joint.mass;
}

void Tree::update(const double* q_now, const double* v_now) {
  q = ConstVector(q_now, nq());
  v = ConstVector(v_now, nv());
  outwards();
  inwards();
}

void Tree::outwards() {
  for (Index j = 0; j < joints(); ++j) {
    if (floating_ && j == 0) {
      place_base();
    } else {
      place(j);
    }
    add_body(j);
  }
}

void Tree::place_base() {
  const Joint& base = joints_[0];
  BodyState& body = bodies_[0];
  const Eigen::Quaterniond turn(q[6], q[3], q[4], q[5]);
  body.rotation = base.rotation * turn.toRotationMatrix();
  origin_ = base.position + base.rotation * q.head<3>();
  body.position.setZero();
  for (Index k = 0; k < 3; ++k) {
    axes_[k] = {body.rotation.col(k), Vector3::Zero()};
    axes_[3 + k] = {Vector3::Zero(), body.rotation.col(k)};
  }
  body.velocity = {body.rotation * v.head<3>(), body.rotation * v.segment<3>(3)};
  body.acceleration = {-gravity_, Vector3::Zero()};
}

void Tree::place(Index j) {
  const Joint& joint = joints_[j];
  BodyState& body = bodies_[j];
  const Index column = first_column(j);
  const double angle = joint.turn * q[nq() - nv() + column];
  const double travel = joint.slide * q[nq() - nv() + column];
  if (joint.parent >= 0) {
    const BodyState& parent = bodies_[joint.parent];
    body.rotation.noalias() = parent.rotation * joint.rotation;
    body.position.noalias() = parent.position + parent.rotation * joint.position;
    body.velocity = parent.velocity;
    body.acceleration = parent.acceleration;
  } else {
    body.rotation = joint.rotation;
    body.position = joint.position;  // a second root beside a floating base does not occur
    body.velocity = {Vector3::Zero(), Vector3::Zero()};
    body.acceleration = {-gravity_, Vector3::Zero()};
  }
  const Vector3 z = body.rotation.col(2);
  if (joint.turn != 0.0) {
    const double sine = std::sin(angle), cosine = std::cos(angle);
    const Vector3 x = body.rotation.col(0), y = body.rotation.col(1);
    body.rotation.col(0) = cosine * x + sine * y;
    body.rotation.col(1) = cosine * y - sine * x;
  }
  body.position += travel * z;
  axes_[column] = {joint.slide * z + joint.turn * body.position.cross(z), joint.turn * z};
  const Spatial own{axes_[column].linear * v[column], axes_[column].angular * v[column]};
  body.velocity += own;
  body.acceleration += carried(body.velocity, own);
}

// Inertia of the link about o, and the force that moves it.
void Tree::add_body(Index j) {
  const Joint& joint = joints_[j];
  const BodyState& body = bodies_[j];
  Inertia& inertia = composite_[j];
  const Vector3 c = body.position + body.rotation * joint.center;
  inertia.mass = joint.mass;
  inertia.moment = joint.mass * c;
  const Matrix3 turned = body.rotation * joint.inertia;
  inertia.rotation.noalias() = turned * body.rotation.transpose();
  inertia.rotation -= inertia.moment * c.transpose();
  inertia.rotation.diagonal().array() += inertia.moment.dot(c);
  force_[j] = inertia * body.acceleration;
  force_[j] += carried_force(body.velocity, inertia * body.velocity);
}

void Tree::inwards() {
  const Index fixed = floating_ ? 1 : 0;
  Vector3 moment = Vector3::Zero(), push = Vector3::Zero();
  for (Index j = joints() - 1; j >= 0; --j) {
    const Inertia& inertia = composite_[j];
    const Index first = first_column(j), end = first + columns(j);
    for (Index column = first; column < end; ++column) {
      const Spatial needed = inertia * axes_[column];  // to accelerate all that j carries
      for (Index row = first; row <= column; ++row) {
        mass_matrix(row, column) = mass_matrix(column, row) = axes_[row].dot(needed);
      }
      for (Index a = parent(j); a >= fixed; a = parent(a)) {
        const Index row = first_column(a);
        mass_matrix(row, column) = mass_matrix(column, row) = axes_[row].dot(needed);
      }
      if (fixed && j > 0) {
        const Matrix3& base = bodies_[0].rotation;
        Eigen::Matrix<double, 6, 1> row;
        row << base.transpose() * needed.linear, base.transpose() * needed.angular;
        mass_matrix.block<6, 1>(0, column) = row;
        mass_matrix.block<1, 6>(column, 0) = row.transpose();
      }
      mass_matrix(column, column) += armature_[column];
      bias[column] = axes_[column].dot(force_[j]);
      gravity_torque[column] = -gravity_.dot(needed.linear);
      center_jacobian.col(column) = needed.linear / total_mass_;
    }
    if (parent(j) >= 0) {
      Inertia& above = composite_[parent(j)];
      above.mass += inertia.mass;
      above.moment += inertia.moment;
      above.rotation += inertia.rotation;
      force_[parent(j)] += force_[j];
    } else {
      moment += inertia.moment;
      push += force_[j].linear;
    }
  }
  if (!(total_mass_ > 0.0)) return;
  center.row(0) = (origin_ + moment / total_mass_).transpose();
  center.row(1).noalias() = (center_jacobian * v).transpose();
  center.row(2) = (push / total_mass_ + gravity_).transpose();
}

}  // namespace ghc
