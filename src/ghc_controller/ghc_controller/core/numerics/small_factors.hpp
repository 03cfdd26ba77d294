// Factors of the small matrices of a tick, m or d a few dozen.
//
// A matrix singular to rounding gets a factor all the same: a pivot that is no more than the
// rounding of its own diagonal entry is raised to that, and its column is dropped. Else the factor
// and its inverse grow from one such pivot to the next until they overflow.
#pragma once

#include "matrix.hpp"

namespace ghc {

// L (m, m), lower triangular, with L L^T = matrix; only its lower triangle is read.
void cholesky(const Eigen::Ref<const Matrix>& matrix, Matrix& lower);

// L (m, m), lower triangular, with L L^T = J J^T + w I for rows J (m, d).
void damped_factor(const Eigen::Ref<const Matrix>& rows, double w, Matrix& lower);

// Overwrite x (m,) by (L L^T)^-1 x.
void solve_factored(const Matrix& lower, Eigen::Ref<Vector> x);

// F = L^-T (d, d) with matrix = L L^T, so that F F^T = matrix^-1.
void inverse_factor(const Eigen::Ref<const Matrix>& matrix, Eigen::Ref<Matrix> factor);

// Overwrite a square matrix by its inverse (Gauss-Jordan, rows pivoted); false: singular.
bool invert(Eigen::Ref<Matrix> matrix);

// Whether each row (m, d) has one entry, in a column of its own, and these entries by column (d,).
// So it is with a posture. J J^T is diagonal then, and what costs m^3 for other rows costs m.
bool selected_values(const Eigen::Ref<const Matrix>& rows, Vector& values);

}  // namespace ghc
