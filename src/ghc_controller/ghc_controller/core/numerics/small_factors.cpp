#include "small_factors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ghc {
namespace {

constexpr double kSmallestPivot = 1e-15;
constexpr double kRounding = 1e-14;  // [-] of the diagonal entry

}  // namespace

void cholesky(const Eigen::Ref<const Matrix>& matrix, Matrix& lower) {
  const Index m = matrix.rows();
  lower.setZero(m, m);
  Vector scale(m);  // 1 / L_cc, 0 where the column is dropped
  for (Index r = 0; r < m; ++r) {
    for (Index c = 0; c < r; ++c) {
      lower(r, c) =
          scale[c] * (matrix(r, c) - lower.row(r).head(c).dot(lower.row(c).head(c)));
    }
    const double value = matrix(r, r) - lower.row(r).head(r).squaredNorm();
    const double least = std::max(kRounding * matrix(r, r), kSmallestPivot);
    lower(r, r) = std::sqrt(value >= least ? value : least);
    scale[r] = value >= least ? 1.0 / lower(r, r) : 0.0;
  }
}

void damped_factor(const Eigen::Ref<const Matrix>& rows, double w, Matrix& lower) {
  Matrix gram = rows * rows.transpose();
  gram.diagonal().array() += w;
  cholesky(gram, lower);
}

void solve_factored(const Matrix& lower, Eigen::Ref<Vector> x) {
  lower.triangularView<Eigen::Lower>().solveInPlace(x);
  lower.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}

void inverse_factor(const Eigen::Ref<const Matrix>& matrix, Eigen::Ref<Matrix> factor) {
  const Index d = matrix.rows();
  Matrix lower;
  cholesky(matrix, lower);
  Matrix inverse = Matrix::Zero(d, d);
  for (Index r = 0; r < d; ++r) {  // by rows; what lies right of the diagonal stays zero
    auto row = inverse.row(r);
    for (Index p = 0; p < r; ++p) {
      row.head(p + 1) -= lower(r, p) * inverse.row(p).head(p + 1);
    }
    row[r] = 1.0;
    row.head(r + 1) /= lower(r, r);
  }
  factor = inverse.transpose();
}

bool invert(Eigen::Ref<Matrix> matrix) {
  const Index d = matrix.rows();
  std::vector<Index> swapped(static_cast<size_t>(d));
  for (Index p = 0; p < d; ++p) {
    Index best = p;
    for (Index r = p + 1; r < d; ++r) {
      if (std::abs(matrix(r, p)) > std::abs(matrix(best, p))) best = r;
    }
    if (!(std::abs(matrix(best, p)) > 0.0)) return false;
    swapped[static_cast<size_t>(p)] = best;
    if (best != p) matrix.row(p).swap(matrix.row(best));
    const double scale = 1.0 / matrix(p, p);
    matrix(p, p) = 1.0;
    matrix.row(p) *= scale;
    for (Index r = 0; r < d; ++r) {
      if (r == p) continue;
      const double share = std::exchange(matrix(r, p), 0.0);
      matrix.row(r) -= share * matrix.row(p);
    }
  }
  for (Index p = d - 1; p >= 0; --p) {
    const Index other = swapped[static_cast<size_t>(p)];
    if (other != p) matrix.col(p).swap(matrix.col(other));
  }
  return true;
}

bool selected_values(const Eigen::Ref<const Matrix>& rows, Vector& values) {
  values.setZero(rows.cols());
  for (Index r = 0; r < rows.rows(); ++r) {
    bool found = false;
    for (Index c = 0; c < rows.cols(); ++c) {
      if (rows(r, c) == 0.0) continue;
      if (found || values[c] != 0.0) return false;
      values[c] = rows(r, c);
      found = true;
    }
    if (!found) return false;
  }
  return true;
}

}  // namespace ghc
