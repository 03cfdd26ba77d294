#include "null_motion.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace ghc {
namespace {

constexpr double kMayDepend = 1e-4;  // [-] of the largest pivot: a smaller one may depend
constexpr double kRowRank = 1e-9;       // [-] of the largest singular value

// vector -= scale (r . vector) r, with the entries of the reflector r from `start` on.
template <typename Reflector, typename Values>
void reflect(const Reflector& r, double scale, Index start, Values&& vector) {
  const auto left = r.tail(r.size() - start);
  auto right = vector.tail(r.size() - start);
  right -= (scale * left.dot(right)) * left;
}

}  // namespace

bool NullMotion::solve(const ConstMatrix& rows, const ConstVector& target) {
  if (rows.rows() <= rows.cols() && by_reflections(rows, target)) return true;
  by_singular_values(rows, target);
  return false;
}

bool NullMotion::by_reflections(const ConstMatrix& rows, const ConstVector& target) {
  const Index q = rows.rows(), n = rows.cols();
  reflectors_ = rows;  // row k: left of k what makes the triangle, then the reflector
  pivots_.resize(q), scales_.resize(q);
  for (Index k = 0; k < q; ++k) {
    auto row = reflectors_.row(k);
    const double square = row.tail(n - k).squaredNorm();
    pivots_[k] = row[k] > 0.0 ? -std::sqrt(square) : std::sqrt(square);
    row[k] -= pivots_[k];
    const double norm = 2.0 * (square - pivots_[k] * (row[k] + pivots_[k]));
    scales_[k] = norm > 0.0 ? 2.0 / norm : 0.0;
    for (Index r = k + 1; r < q; ++r) reflect(row, scales_[k], k, reflectors_.row(r));
  }
  least_.setZero(n);
  const double largest = q ? pivots_.cwiseAbs().maxCoeff() : 0.0;
  for (Index k = 0; k < q; ++k) {
    if (!(std::abs(pivots_[k]) > kMayDepend * largest)) return false;
    least_[k] = (target[k] - reflectors_.row(k).head(k).dot(least_.head(k))) / pivots_[k];
  }
  for (Index k = q - 1; k >= 0; --k) {
    reflect(reflectors_.row(k), scales_[k], k, least_.transpose());
  }
  formed_ = false;
  return true;
}

const Matrix& NullMotion::basis() {
  if (!formed_) form_basis();
  formed_ = true;
  return basis_;
}

// The last d columns of H_1 .. H_q = I - V T V^T, with the reflectors as columns of V and T upper
// triangular (R. Schreiber, C. Van Loan, SIAM J. Sci. Stat. Comput. 10, 1989).
void NullMotion::form_basis() {
  const Index q = reflectors_.rows(), n = reflectors_.cols();
  basis_.setZero(n, n - q);
  basis_.bottomRows(n - q).setIdentity();
  if (q == 0 || q == n) return;
  triangle_.resize(q, q);
  for (Index k = 0; k < q; ++k) {
    reflectors_.row(k).head(k).setZero();  // what made the triangle is used already
    triangle_(k, k) = scales_[k];
    if (k == 0) continue;
    overlap_.noalias() = reflectors_.topRows(k) * reflectors_.row(k).transpose();
    triangle_.col(k).head(k).noalias() =
        triangle_.topLeftCorner(k, k).triangularView<Eigen::Upper>() * overlap_;
    triangle_.col(k).head(k) *= -scales_[k];
  }
  shares_.noalias() = triangle_.triangularView<Eigen::Upper>() * reflectors_.rightCols(n - q);
  basis_.noalias() -= reflectors_.transpose() * shares_;
}

void NullMotion::by_singular_values(const ConstMatrix& rows, const ConstVector& target) {
  const Index n = rows.cols();
  const Eigen::JacobiSVD<Matrix> svd(rows, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const auto& sigma = svd.singularValues();
  const double least = kRowRank * (sigma.size() ? std::max(sigma[0], 1e-300) : 0.0);
  const Index rank = (sigma.array() > least).count();
  least_ = svd.matrixV().leftCols(rank) *
           ((svd.matrixU().leftCols(rank).transpose() * target).array() / sigma.head(rank).array())
               .matrix();
  basis_ = svd.matrixV().rightCols(n - rank);
  formed_ = true;
}

}  // namespace ghc
