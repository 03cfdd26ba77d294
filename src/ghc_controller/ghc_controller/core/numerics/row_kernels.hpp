// Sums over rows of a matrix as NumPy stores them, two numbers and up to four rows at a time.
//
// The order of every sum is fixed by the length of a row alone: neither the rows beside it nor the
// width of the processor's registers change a digit.
#pragma once

#include <cstring>

#include "matrix.hpp"

namespace ghc {

using Two = double __attribute__((vector_size(16)));  // the registers of any processor

inline Two two_at(const double* from) {
  Two two;
  std::memcpy(&two, from, sizeof two);
  return two;
}

// out (R,) = rows (R, d) x, rows `stride` apart.
template <int R>
inline void dot_rows(const double* rows, Index stride, const double* x, Index d, double* out) {
  Two sum[R] = {};
  Index c = 0;
  for (; c + 2 <= d; c += 2) {
    const Two of_x = two_at(x + c);
    for (int r = 0; r < R; ++r) sum[r] += two_at(rows + r * stride + c) * of_x;
  }
  for (int r = 0; r < R; ++r) {
    out[r] = sum[r][0] + sum[r][1];
    if (c < d) out[r] += rows[r * stride + c] * x[c];
  }
}

// out (d,) += sum_r weights_r rows_r, one row after the other.
template <int R>
inline void add_weighted(const double* rows, Index stride, const double* weights, double sign,
                         Index d, double* out) {
  double weight[R];
  for (int r = 0; r < R; ++r) weight[r] = sign * weights[r];
  Index c = 0;
  for (; c + 2 <= d; c += 2) {
    Two sum = two_at(out + c);
    for (int r = 0; r < R; ++r) sum += two_at(rows + r * stride + c) * weight[r];
    std::memcpy(out + c, &sum, sizeof sum);
  }
  if (c == d) return;
  double last = out[c];
  for (int r = 0; r < R; ++r) last += rows[r * stride + c] * weight[r];
  out[c] = last;
}

// out (m,) = rows (m, d) x.
inline void dot_rows(const double* rows, Index stride, Index m, const double* x, Index d,
                     double* out) {
  for (; m >= 4; m -= 4, rows += 4 * stride, out += 4) dot_rows<4>(rows, stride, x, d, out);
  if (m == 3) dot_rows<3>(rows, stride, x, d, out);
  if (m == 2) dot_rows<2>(rows, stride, x, d, out);
  if (m == 1) dot_rows<1>(rows, stride, x, d, out);
}

// out (d,) += sign rows^T weights, of m rows.
inline void add_weighted(const double* rows, Index stride, Index m, const double* weights,
                         double sign, Index d, double* out) {
  for (; m >= 4; m -= 4, rows += 4 * stride, weights += 4) {
    add_weighted<4>(rows, stride, weights, sign, d, out);
  }
  if (m == 3) add_weighted<3>(rows, stride, weights, sign, d, out);
  if (m == 2) add_weighted<2>(rows, stride, weights, sign, d, out);
  if (m == 1) add_weighted<1>(rows, stride, weights, sign, d, out);
}

}  // namespace ghc
