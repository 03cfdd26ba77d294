// Distances of pairs of thickened points, segments and boxes on the frames of a robot.
#pragma once

#include <utility>
#include <vector>

#include "frames.hpp"

namespace ghc {

// The points center + axes u, |u_k| <= 1, and all within `radius` of them.
struct BodyShape {
  Index frame;     // number in Frames; -1: the world
  Vector3 center;  // [m] in the frame
  Matrix3 axes;    // [m] half axes as columns, zero where there is none
  double radius;   // [m]
};

// A pair whose distance is small. u: of the second shape, then of the first.
struct NearPair {
  Index pair;
  double distance;  // [m]
  double u[6];
};

// d'' = jacobian x + drift.
struct DistanceMotion {
  double rate;   // [m/s]
  double drift;  // [m/s^2]
};

// With p(u) = c + B u between the cores of a pair, B = [A_2, -A_1], and a penalty e:
//
//     W = min_u |p|^2 + e sum_k l_k^2 (u_k^2 - 1),    d = sqrt(W) - r_1 - r_2,
//
// l_k = |b_k|, of a box min(|b_k|, L): otherwise a box is seen the nearer, the larger it is. The
// true closest points (e = 0) jump where axes are parallel. With e > 0 the minimum is unique, u is
// continuous, and so is the gradient of d, that of p at fixed u. The added term is never positive
// at the true minimum: d is never larger than the true distance. W is smaller than the square of
// that between the cores by at most the sum of e l_k^2 over the axes with |u_k| < 1.
class BodyPairs {
 public:
  BodyPairs(std::vector<BodyShape> shapes, std::vector<std::pair<Index, Index>> pairs);

  // Pairs nearer than `within` [m], nearest first.
  const std::vector<NearPair>& near(const Frames& frames, double within);

  // How the distance of one of them moves, at the same state; J is added to row (n,).
  DistanceMotion motion(const Frames& frames, const NearPair& near, double* row) const;

  Index pairs() const { return static_cast<Index>(pairs_.size()); }
  Index most_frame() const;  // largest number of a frame

 private:
  struct Placed {
    Vector3 center;
    Matrix3 axes;
  };

  const std::vector<BodyShape> shapes_;
  const std::vector<std::pair<Index, Index>> pairs_;
  std::vector<double> reach_;  // [m] of a ball about the center of a shape that contains it
  std::vector<Vector3> penalties_;  // [m^2] e l_k^2 of the axes of a shape
  std::vector<Placed> placed_;
  std::vector<NearPair> near_;
};

}  // namespace ghc
