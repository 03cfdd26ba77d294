// Sums over rows of a matrix as NumPy stores them, up to four rows at a time.
//
// The order of every sum is fixed by the length of a row alone: four partial sums, then what is
// left. Neither the rows beside it nor the width of the processor's registers change a digit:
// where it has AVX2, which is asked for when the extension is loaded, four numbers are one register.
#pragma once

#include "matrix.hpp"

namespace ghc {

// out (m,) = rows (m, d) x, rows `stride` apart.
void dot_rows(const double* rows, Index stride, Index m, const double* x, Index d, double* out);

// out (d,) += sign rows^T weights, of m rows, one after the other.
void add_weighted(const double* rows, Index stride, Index m, const double* weights, double sign,
                  Index d, double* out);

}  // namespace ghc
