#include "frames.hpp"

namespace ghc {

Index Frames::add(Index joint, const Matrix3& rotation, const Vector3& position) {
  Frame frame{joint, rotation, position, {}, FrameTerms(tree_.nv())};
  frame.terms.pose << rotation, position.transpose();
  for (Index j = joint; j >= 0; j = tree_.parent(j)) {
    const Index first = tree_.first_column(j);
    for (Index k = 0; k < tree_.columns(j); ++k) frame.moving.push_back(first + k);
  }
  frames_.push_back(frame);
  return count() - 1;
}

void Frames::update() {
  for (Frame& frame : frames_) {
    if (frame.joint >= 0) update(frame);
  }
}

void Frames::update(Frame& frame) const {
  const BodyState& body = tree_.body(frame.joint);
  FrameTerms& terms = frame.terms;
  const Vector3 r = body.position + body.rotation * frame.offset;  // from o
  terms.pose.topRows<3>().noalias() = body.rotation * frame.offset_rotation;
  terms.pose.row(3) = (tree_.origin() + r).transpose();
  const Vector3 &w = body.velocity.angular, &b = body.acceleration.angular;
  const Vector3 speed = body.velocity.linear + w.cross(r);
  const Vector3 drift =
      tree_.gravity() + body.acceleration.linear + b.cross(r) + w.cross(speed);
  terms.motion.row(0) << speed.transpose(), w.transpose();
  terms.motion.row(1) << drift.transpose(), b.transpose();
  for (const Index column : frame.moving) {
    const Spatial& axis = tree_.axis(column);
    terms.jacobian.col(column) << axis.linear + axis.angular.cross(r), axis.angular;
  }
}

void see_from(const FrameTerms& base, const FrameTerms& frame, FrameTerms& seen) {
  const Matrix3 turn = base.rotation().transpose();
  const Vector3 r = frame.position() - base.position();
  const auto part = [](const FrameTerms& terms, Index row, Index first) -> Vector3 {
    return terms.motion.row(row).segment<3>(first).transpose();
  };
  const Vector3 w = part(base, 0, 3), swept = w.cross(r);
  const Vector3 spin = part(frame, 0, 3) - w;
  const Vector3 u = part(frame, 0, 0) - part(base, 0, 0) - swept;
  const Vector3 change = part(frame, 1, 0) - part(base, 1, 0) - part(base, 1, 3).cross(r) -
                         w.cross(swept) - 2.0 * w.cross(u);
  const Vector3 turned = part(frame, 1, 3) - part(base, 1, 3) - w.cross(spin);
  seen.pose.topRows<3>().noalias() = turn * frame.rotation();
  seen.pose.row(3) = (turn * r).transpose();
  seen.motion.row(0) << (turn * u).transpose(), (turn * spin).transpose();
  seen.motion.row(1) << (turn * change).transpose(), (turn * turned).transpose();
  for (Index c = 0; c < seen.jacobian.cols(); ++c) {
    const Vector3 a = base.jacobian.col(c).tail<3>(), b = frame.jacobian.col(c).tail<3>();
    const Vector3 moved =
        frame.jacobian.col(c).head<3>() - base.jacobian.col(c).head<3>() + r.cross(a);
    seen.jacobian.col(c) << turn * moved, turn * (b - a);
  }
}

}  // namespace ghc
