// Rotation vectors of rotations.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "tree.hpp"

namespace ghc {

// Rotation vector [rad] of a unit quaternion, of length at most pi.
inline Vector3 rotation_log(const Eigen::Quaterniond& q) {
  const double sign = q.w() >= 0.0 ? 1.0 : -1.0, cosine = sign * q.w();
  const double sine = q.vec().norm();
  // angle / sine -> 2 at the identity; atan2 is exact for every other angle
  const double scale = sine < 1e-12 ? 2.0 / cosine : 2.0 * std::atan2(sine, cosine) / sine;
  return sign * scale * q.vec();
}

// e with R* = exp(e) R of the reference quaternion (x, y, z, w).
inline Vector3 rotation_error(const double* reference, const Matrix3& rotation) {
  const Eigen::Quaterniond wanted(reference[3], reference[0], reference[1], reference[2]);
  return rotation_log(wanted * Eigen::Quaterniond(rotation).conjugate());
}

}  // namespace ghc
