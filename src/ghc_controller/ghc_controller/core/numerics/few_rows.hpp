// Products with rows, and substitutions with few of them, as most tasks and active sets have.
//
// A call of Eigen's general product or triangular solver takes longer than the sums of three rows
// and a few dozen columns; loops over rows do without it. From kFew rows on Eigen's solver is faster.
#pragma once

#include "matrix.hpp"
#include "row_kernels.hpp"

namespace ghc {

constexpr Index kFew = 10;

// out (m,) = rows (m, d) x (d,); `out` may be longer.
template <typename Rows, typename Values, typename Out>
void times(const Rows& rows, const Values& x, Out& out) {
  dot_rows(rows.data(), rows.outerStride(), rows.rows(), x.data(), rows.cols(), out.data());
}

// out (d,) += sign rows^T weights, of the first m weights.
template <typename Rows, typename Weights, typename Values>
void add_rows(const Rows& rows, const Weights& weights, double sign, Values& out) {
  add_weighted(rows.data(), rows.outerStride(), rows.rows(), weights.data(), sign, rows.cols(),
               out.data());
}

// x = R^-1 x of the first m entries, with R (m, m) the upper triangle in the corner of a matrix.
inline void divide_by_upper(const Matrix& upper, Index m, Vector& x) {
  for (Index i = m - 1; i >= 0; --i) {
    double met = 0.0;
    for (Index c = i + 1; c < m; ++c) met += upper(i, c) * x[c];
    x[i] = (x[i] - met) / upper(i, i);
  }
}

// x = R^-T x, alike.
inline void divide_by_upper_transposed(const Matrix& upper, Index m, Vector& x) {
  for (Index i = 0; i < m; ++i) {
    x[i] /= upper(i, i);
    for (Index c = i + 1; c < m; ++c) x[c] -= upper(i, c) * x[i];
  }
}

// x = L^-1 x, with L the lower triangle of a square matrix.
inline void divide_by_lower(const Matrix& lower, Vector& x) {
  const Index m = lower.rows();
  if (m > kFew) {
    lower.triangularView<Eigen::Lower>().solveInPlace(x);
    return;
  }
  for (Index i = 0; i < m; ++i) {
    double met = 0.0;
    for (Index c = 0; c < i; ++c) met += lower(i, c) * x[c];
    x[i] = (x[i] - met) / lower(i, i);
  }
}

// x = L^-T x, alike.
inline void divide_by_lower_transposed(const Matrix& lower, Vector& x) {
  const Index m = lower.rows();
  if (m > kFew) {
    lower.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
    return;
  }
  for (Index i = m - 1; i >= 0; --i) {
    x[i] /= lower(i, i);
    for (Index c = 0; c < i; ++c) x[c] -= x[i] * lower(i, c);
  }
}

// columns = L^-1 columns (m, q), each as if it were alone.
inline void divide_columns_by_lower(const Matrix& lower, Matrix& columns) {
  const Index m = columns.rows(), q = columns.cols();
  for (Index i = 0; i < m; ++i) {
    const double* row = lower.row(i).data();
    double* out = columns.row(i).data();
    if (q < 4) {  // too few for calls
      for (Index j = 0; j < q; ++j) {
        for (Index c = 0; c < i; ++c) out[j] -= row[c] * columns(c, j);
      }
    } else {
      add_weighted(columns.data(), q, i, row, -1.0, q, out);
    }
    const double inverse = 1.0 / row[i];
    for (Index j = 0; j < q; ++j) out[j] *= inverse;
  }
}

// columns = L^-T columns, alike.
inline void divide_columns_by_lower_transposed(const Matrix& lower, Matrix& columns) {
  const Index m = columns.rows(), q = columns.cols();
  for (Index i = m - 1; i >= 0; --i) {
    const double* row = lower.row(i).data();
    double* of_row = columns.row(i).data();
    const double inverse = 1.0 / row[i];
    for (Index j = 0; j < q; ++j) of_row[j] *= inverse;
    for (Index c = 0; c < i; ++c) {
      double* out = columns.row(c).data();
      for (Index j = 0; j < q; ++j) out[j] -= row[c] * of_row[j];
    }
  }
}

}  // namespace ghc
