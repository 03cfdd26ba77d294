// KKT residuals of an answer of min 1/2 x^T H x + g^T x, A x = b, l <= C x <= u.
#pragma once

#include "matrix.hpp"

namespace ghc {

struct Qp {
  ConstMatrix hessian;  // H (n, n), positive definite
  ConstVector linear;   // g (n,)
  ConstMatrix equalities;  // A (e, n)
  ConstVector right;       // b (e,)
  ConstMatrix rows;           // C (r, n)
  ConstVector lower, upper;   // (r,)

  // Throws std::invalid_argument where sizes do not fit together.
  void check() const;

  // 0 .. 6: the first part (in the order above) that is not finite; -1 where all can be used. A
  // bound may be infinite on its own side.
  int not_finite() const;
};

// Largest entry of each; NaN where the answer is not finite.
struct Residuals {
  double primal;           // violation of equalities and bounds, each row times its unit
  double dual;             // stationarity
  double complementarity;  // multiplier times distance to its bound
  double size;             // 1 + max |x|
  double terms;            // 1 + the largest term of the stationarity
};

Residuals kkt_residuals(const Qp& qp, const ConstVector& x, const ConstVector& y,
                        const ConstVector& z, const ConstVector& units);

}  // namespace ghc
