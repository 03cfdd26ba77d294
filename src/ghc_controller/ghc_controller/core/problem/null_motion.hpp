// Motion that keeps rows: the least x with R x = target, and an orthonormal basis of R x = 0.
#pragma once

#include "matrix.hpp"

namespace ghc {

class NullMotion {
 public:
  // Rows R (q, n). By Householder reflections of R^T (G. Golub, C. Van Loan, Matrix Computations,
  // section 5.2); rows that may depend on others by a singular value decomposition, and their
  // targets are then met in the least-squares sense. Returns whether no row depends on others.
  bool solve(const ConstMatrix& rows, const ConstVector& target);

  const Vector& least() const { return least_; }  // (n,)

  // (n, d), computed at the first call after `solve`.
  const Matrix& basis();

 private:
  bool by_reflections(const ConstMatrix& rows, const ConstVector& target);
  void by_singular_values(const ConstMatrix& rows, const ConstVector& target);
  void form_basis();

  Matrix reflectors_, triangle_, shares_, basis_;
  Vector pivots_, scales_, least_, overlap_;
  bool formed_ = false;
};

}  // namespace ghc
