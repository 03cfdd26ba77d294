#include "reduction.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>

namespace ghc {
namespace {

constexpr double kFixed = 1e-8;  // [-] of a task row's length: what is left where a contact holds it
constexpr double kForceRank = 1e-9;   // [-] of the largest singular value of the balance force

View view(const Matrix& matrix) { return {matrix.data(), matrix.rows(), matrix.cols()}; }
View view(const Vector& vector) { return {vector.data(), vector.size(), 1}; }

View rows_of(const View& whole, Index first, Index count) {
  return {whole.data + first * whole.cols, count, whole.cols};
}

// out = rows times basis; a row with one entry, of a posture, takes that row of the basis.
void times_basis(const ConstMatrix& rows, const Matrix& basis, Matrix& out) {
  out.resize(rows.rows(), basis.cols());
  Index dense = 0;  // rows up to here go by one product
  const auto only = [&rows](Index r) {
    Index place = -1;
    for (Index c = 0; c < rows.cols(); ++c) {
      if (rows(r, c) == 0.0) continue;
      if (place >= 0) return Index{-1};
      place = c;
    }
    return place;
  };
  for (Index r = 0; r < rows.rows(); ++r) {
    const Index place = only(r);
    if (place < 0) continue;
    if (dense < r) out.middleRows(dense, r - dense).noalias() = rows.middleRows(dense, r - dense) * basis;
    out.row(r) = rows(r, place) * basis.row(place);
    dense = r + 1;
  }
  const Index left = rows.rows() - dense;
  if (left) out.bottomRows(left).noalias() = rows.bottomRows(left) * basis;
}

}  // namespace

void Reduction::keep_contacts(const Problem& problem) {
  const Index u = problem.unactuated, n = problem.bias.size(), a = n - u;
  const auto M = problem.mass_matrix.matrix();
  const auto h = problem.bias.vector();
  formed_ = free_formed_ = free_by_reflections_ = dropped_ = false;
  fixed_base_ = u == 0, factor_ = problem.in_contact ? problem.force_factor : View{};
  jacobian_ = problem.jacobian, target_ = problem.target;
  mass_of_joints = rows_of(problem.mass_matrix, u, a), bias_of_joints = {h.data() + u, a, 1};
  basis = offset = torque_force = balance_force = center = gain = residual = View{};
  free_.resize(0, 0);
  if (!problem.in_contact) {
    balance_matrix = rows_of(problem.mass_matrix, 0, u);
    balance_target_ = -h.head(u);
    balance_target = view(balance_target_);
    return;
  }
  motion_.solve(problem.contact_jacobian.matrix(), problem.drift_target.vector());
  const Matrix& Z = motion_.basis();
  const Vector& least = motion_.least();
  const auto J = problem.jacobian.matrix();
  times_basis(J, Z, rows_);
  goals_ = problem.target.vector();
  goals_.noalias() -= J * least;
  for (Index r = 0; r < J.rows(); ++r) {  // rounding is no direction to project on
    if (rows_.row(r).squaredNorm() > kFixed * kFixed * J.row(r).squaredNorm()) continue;
    rows_.row(r).setZero();
    goals_[r] = 0.0;
  }
  force_ = -problem.force_jacobian.matrix().transpose();
  balance_matrix_.noalias() = M.topRows(u) * Z;
  balance_target_ = -h.head(u);
  balance_target_.noalias() -= M.topRows(u) * least;
  jacobian_ = view(rows_), target_ = view(goals_);
  basis = view(Z), offset = view(least);
  torque_force = rows_of(view(force_), u, a), balance_force = rows_of(view(force_), 0, u);
  balance_matrix = view(balance_matrix_), balance_target = view(balance_target_);
  center = problem.force_center;
}

void Reduction::balance() {
  const Index u = balance_target.size(), c = center.size();
  if (u == 0) return;
  const ConstMatrix on_base(balance_force.data, u, c), factor(factor_.data, c, c);
  whitened_.noalias() = on_base * factor;
  none_.setZero(u);
  const ConstMatrix rows(whitened_.data(), u, c);
  if (c >= u && forces_.solve(rows, ConstVector(none_.data(), u))) {
    gram_.noalias() = whitened_ * whitened_.transpose();
    inverse_ = gram_.llt().solve(whitened_).transpose();
    free_by_reflections_ = true;
  } else {
    Matrix left = Matrix::Identity(u, u);
    Index rank = 0;
    free_.resize(c, c), inverse_.resize(c, 0);
    if (c) {
      const Eigen::JacobiSVD<Matrix> svd(rows, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const auto& sigma = svd.singularValues();
      rank = (sigma.array() > kForceRank * sigma[0]).count();
      left = svd.matrixU();
      inverse_ = svd.matrixV().leftCols(rank) * sigma.head(rank).cwiseInverse().asDiagonal();
      free_ = factor * svd.matrixV().rightCols(c - rank);
    }
    const Matrix across = left.transpose();
    drop_uncarried(across.bottomRows(u - rank), across.topRows(rank));
  }
  gain_.noalias() = factor * inverse_;
  gain = view(gain_);
  residual_ = balance_target.vector();
  if (c) residual_.noalias() -= balance_force.matrix() * center.vector();
  residual = view(residual_);
}

void Reduction::expand(const Problem& problem, const ForceExpansion& cost) {
  if (dropped_) keep_contacts(problem);  // y is reduced further by the balance
  center = cost.center, factor_ = cost.factor;
  free_formed_ = free_by_reflections_ = false;
  balance();
}

// Reduce y by uncarried M_u y = uncarried rhs; keep the balance along `carried` rows.
void Reduction::drop_uncarried(const Eigen::Ref<const Matrix>& uncarried,
                               const Eigen::Ref<const Matrix>& carried) {
  dropped_ = true;
  const Matrix momentum = uncarried * balance_matrix.matrix();
  const Vector goal = uncarried * balance_target.vector();
  momentum_.solve({momentum.data(), momentum.rows(), momentum.cols()},
                  {goal.data(), goal.size()});
  const Matrix& kept = momentum_.basis();
  const Vector& least = momentum_.least();
  goals_ = (target_.vector() - jacobian_.matrix() * least).eval();
  rows_ = (jacobian_.matrix() * kept).eval();
  balance_target_ =
      (carried * (balance_target.vector() - balance_matrix.matrix() * least)).eval();
  balance_matrix_ = (carried * balance_matrix.matrix() * kept).eval();
  if (basis.rows) {
    offset_ = offset.vector() + basis.matrix() * least;
    basis_ = basis.matrix() * kept;
  } else {
    offset_ = least, basis_ = kept;
  }
  const Index c = center.size();
  balance_force_ = carried * ConstMatrix(balance_force.data, carried.cols(), c);
  jacobian_ = view(rows_), target_ = view(goals_);
  basis = view(basis_), offset = view(offset_);
  balance_matrix = view(balance_matrix_), balance_target = view(balance_target_);
  balance_force = view(balance_force_);
}

RowTerms Reduction::rows() {
  if (!formed_) {
    formed_ = true;
    if (basis.rows) torque_matrix_.noalias() = mass_of_joints.matrix() * basis.matrix();
  }
  if (!free_formed_) {
    free_formed_ = true;
    if (free_by_reflections_) free_.noalias() = factor_.matrix() * forces_.basis();
  }
  const View torques = basis.rows ? view(torque_matrix_) : mass_of_joints;
  const View free = fixed_base_ ? factor_ : view(free_);  // nothing to balance: all are free
  return {torques.matrix(), free.matrix()};
}

Terms Reduction::terms(const Problem& problem) {
  return {basis.matrix(),
          offset.vector(),
          mass_of_joints.matrix(),
          bias_of_joints.vector(),
          torque_force.matrix(),
          center.vector(),
          gain.matrix(),
          residual.vector(),
          balance_matrix.matrix(),
          balance_force.matrix(),
          problem.general.matrix(),
          problem.general_force.matrix(),
          problem.force_matrix.matrix(),
          problem.x_lower.vector(),
          problem.x_upper.vector(),
          problem.limit_lower.vector(),
          problem.limit_upper.vector(),
          problem.general_lower.vector(),
          problem.general_upper.vector(),
          problem.force_lower.vector(),
          problem.force_upper.vector(),
          this};
}

void Reduction::coordinates(const Eigen::Ref<const Vector>& x, Vector& y) const {
  if (basis.rows) {
    y.noalias() = basis.matrix().transpose() * x;
  } else {
    y = x;
  }
}

}  // namespace ghc
