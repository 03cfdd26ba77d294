#include "body_pairs.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace ghc {
namespace {

constexpr double kPenalty = 3e-3;     // [-] e
constexpr double kMostOfBox = 0.1;    // [m] L, the most that counts of a half axis of a box
constexpr double kTiny = 1e-12;       // [m^2] axis of no length
constexpr double kLeastGap = 1e-4;    // [m] between cores: below it there is no direction
constexpr double kStationary = 1e-10; // [m^2] of a projected gradient
constexpr int kMostNewton = 30;       // steps of a box; a few are usual
constexpr int kMostHalvings = 20;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using PairAxes = Eigen::Matrix<double, 3, 6>;  // B

double clipped(double value) { return std::min(std::max(value, -1.0), 1.0); }

// e l_k^2 of the axes of a shape.
Vector3 penalties_of(const Matrix3& axes) {
  const Vector3 squares = axes.colwise().squaredNorm();
  const bool box = (squares.array() > kTiny).count() > 1;
  return kPenalty * (box ? Vector3(squares.cwiseMin(kMostOfBox * kMostOfBox)) : squares);
}

// u of two segments: one clipped, then the other, then the first is optimal in the square.
Vector6 segment_points(const Vector3& between, const PairAxes& axes, const Vector6& penalty) {
  const Vector3 a = axes.col(0), b = axes.col(3);
  const double h11 = a.squaredNorm() + penalty[0] + kTiny;
  const double h22 = b.squaredNorm() + penalty[3] + kTiny;
  const double h12 = a.dot(b), g1 = a.dot(between), g2 = b.dot(between);
  Vector6 u = Vector6::Zero();
  u[0] = clipped((h12 * g2 - h22 * g1) / (h11 * h22 - h12 * h12));
  u[3] = clipped(-(g2 + h12 * u[0]) / h22);
  u[0] = clipped(-(g1 + h12 * u[3]) / h11);
  return u;
}

// u of a pair with a box, by projected Newton steps that lower the cost.
Vector6 box_points(const Vector3& between, const PairAxes& axes, const Vector6& penalty) {
  Matrix6 hessian = axes.transpose() * axes;
  hessian.diagonal() += penalty + Vector6::Constant(kTiny);
  const Vector6 constant = axes.transpose() * between;
  const auto cost = [&](const Vector6& u) { return (0.5 * hessian * u + constant).dot(u); };
  const auto project = [](const Vector6& u) { return Vector6(u.cwiseMax(-1.0).cwiseMin(1.0)); };
  Vector6 u = Vector6::Zero();
  for (int newton = 0; newton < kMostNewton; ++newton) {
    const Vector6 gradient = hessian * u + constant;
    if ((project(u - gradient) - u).cwiseAbs().maxCoeff() < kStationary) break;
    Matrix6 free = hessian;
    Vector6 step = -gradient;
    for (int k = 0; k < 6; ++k) {
      if (!((u[k] <= -1.0 && gradient[k] > 0.0) || (u[k] >= 1.0 && gradient[k] < 0.0))) continue;
      free.row(k).setZero();
      free.col(k).setZero();
      free(k, k) = 1.0;
      step[k] = 0.0;
    }
    step = free.ldlt().solve(step).eval();
    const double before = cost(u);
    double size = 1.0;
    int halving = 0;
    for (; halving < kMostHalvings; ++halving, size *= 0.5) {
      const Vector6 moved = project(u + size * step);
      if (cost(moved) > before - 1e-16) continue;
      u = moved;
      break;
    }
    if (halving == kMostHalvings) break;
  }
  return u;
}

}  // namespace

BodyPairs::BodyPairs(std::vector<BodyShape> shapes, std::vector<std::pair<Index, Index>> pairs)
    : shapes_(std::move(shapes)), pairs_(std::move(pairs)), placed_(shapes_.size()) {
  for (const BodyShape& shape : shapes_) {
    reach_.push_back(shape.axes.norm() + shape.radius);
    penalties_.push_back(penalties_of(shape.axes));
  }
}

Index BodyPairs::most_frame() const {
  Index most = -1;
  for (const BodyShape& shape : shapes_) most = std::max(most, shape.frame);
  return most;
}

const std::vector<NearPair>& BodyPairs::near(const Frames& frames, double within) {
  for (size_t k = 0; k < shapes_.size(); ++k) {
    const BodyShape& shape = shapes_[k];
    if (shape.frame < 0) {
      placed_[k] = {shape.center, shape.axes};
      continue;
    }
    const FrameTerms& frame = frames[shape.frame];
    placed_[k].center = frame.position() + frame.rotation() * shape.center;
    placed_[k].axes = frame.rotation() * shape.axes;
  }
  near_.clear();
  for (size_t pair = 0; pair < pairs_.size(); ++pair) {
    const auto [i, j] = pairs_[pair];
    const Placed &first = placed_[i], &second = placed_[j];
    const Vector3 between = second.center - first.center;
    if (between.norm() - reach_[i] - reach_[j] >= within) continue;
    PairAxes axes;
    axes << second.axes, -first.axes;
    const Vector6 lengths = axes.colwise().squaredNorm();
    const bool segments = lengths[1] + lengths[2] + lengths[4] + lengths[5] < kTiny;
    Vector6 penalty;
    penalty << penalties_[j], penalties_[i];
    const Vector6 u =
        segments ? segment_points(between, axes, penalty) : box_points(between, axes, penalty);
    const Vector6 missing = u.cwiseProduct(u) - Vector6::Ones();
    const double squares = (between + axes * u).squaredNorm() + penalty.dot(missing);
    const double distance = std::sqrt(std::max(squares, kLeastGap * kLeastGap)) -
                            shapes_[i].radius - shapes_[j].radius;
    if (distance >= within) continue;
    near_.push_back({static_cast<Index>(pair), distance, {}});
    Eigen::Map<Vector6>(near_.back().u) = u;
  }
  std::stable_sort(near_.begin(), near_.end(), [](const NearPair& a, const NearPair& b) {
    return a.distance < b.distance;
  });
  return near_;
}

DistanceMotion BodyPairs::motion(const Frames& frames, const NearPair& near, double* row) const {
  const auto [i, j] = pairs_[near.pair];
  const Eigen::Map<const Vector6> u(near.u);
  PairAxes axes, turning = PairAxes::Zero();  // B and its rate
  axes << placed_[j].axes, -placed_[i].axes;
  const Vector3 gap = placed_[j].center - placed_[i].center + axes * u;
  const double length = near.distance + shapes_[i].radius + shapes_[j].radius;
  const Vector3 normal = gap / length;
  Vector3 speed = Vector3::Zero(), drift = Vector3::Zero();
  for (const bool second : {true, false}) {
    const Index shape = second ? j : i, number = shapes_[shape].frame;
    if (number < 0) continue;
    const FrameTerms& frame = frames[number];
    const double sign = second ? 1.0 : -1.0;
    const Vector3 own = second ? u.head<3>() : u.tail<3>();
    const Vector3 arm = placed_[shape].center + placed_[shape].axes * own - frame.position();
    const Vector3 w = frame.motion.row(0).tail<3>().transpose();
    const Vector3 velocity = frame.motion.row(0).head<3>().transpose();
    const Vector3 a = frame.motion.row(1).head<3>().transpose();
    const Vector3 b = frame.motion.row(1).tail<3>().transpose();
    speed += sign * (velocity + w.cross(arm));
    drift += sign * (a + b.cross(arm) + w.cross(w.cross(arm)));
    const int at = second ? 0 : 3;
    for (int k = at; k < at + 3; ++k) turning.col(k) = w.cross(Vector3(axes.col(k)));
    Eigen::Matrix<double, 1, 6> twist;
    twist << sign * normal.transpose(), sign * arm.cross(normal).transpose();
    Eigen::Map<RowVector>(row, frame.jacobian.cols()) += twist * frame.jacobian;
  }
  // Closest points that slide along their axes lower the second derivative.
  Vector6 pull = axes.transpose() * speed + turning.transpose() * gap;
  Matrix6 hessian = axes.transpose() * axes;
  Vector6 penalty;
  penalty << penalties_[j], penalties_[i];
  for (int k = 0; k < 6; ++k) {
    if (hessian(k, k) > kTiny && std::abs(u[k]) < 1.0) {
      hessian(k, k) += penalty[k];
      continue;
    }
    hessian.row(k).setZero();
    hessian.col(k).setZero();
    hessian(k, k) = 1.0;
    pull[k] = 0.0;
  }
  const double sliding = pull.dot(hessian.llt().solve(pull));
  const double rate = gap.dot(speed) / length;
  const double curvature = gap.dot(drift) + speed.squaredNorm() - sliding;
  return {rate, (curvature - rate * rate) / length};
}

}  // namespace ghc
