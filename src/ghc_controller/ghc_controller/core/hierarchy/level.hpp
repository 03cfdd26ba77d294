// One level of the cascade without bounds: min |J (y + P u) - b|^2 + w |u|^2 over u.
//
// With A = J P and S S^T = A A^T + w I its optimum is c = y + P A^T S^-T S^-1 (b - J y). The QP of
// a level that meets a bound has variables s with x = c + P F s and cost 1/2 |s|^2, where
// F F^T = (A^T A + w I)^-1: F = w^-1/2 (I - A^T K A), K = S^-T (S + sqrt(w) I)^-1, from the factor
// that c needs anyway. A level that asks for every acceleration (J = I, a posture) has A = P, and
// is solved by the few rows V of the levels above instead (docs/architecture.md, "The core").
#pragma once

#include "few_rows.hpp"
#include "matrix.hpp"
#include "null_space.hpp"

namespace ghc {

// Damping of a level of rows J (m, d), of what the levels above leave, A = J P, and r = b - J y,
// by their squares: w (1 - kept (1 - s)) + (1 - kept) min(|r|^2 / (2 a)^2, 4 w), with
// kept = |A|^2 / |J|^2, s = min(1, |J| / sqrt(m)). A task of short rows keeps its gains as far as
// it keeps its directions. Along any direction it asks for |r| / (2 sqrt(w_l)) at most, where the
// levels above take them all for a or less while |r| <= 4 a sqrt(w).
double level_damping(Index m, double jacobian, double rows, double residual, double w);

class Level {
 public:
  // Optimum of rows `jacobian` (m, d) and `target` (m,) from y (d,) on in a null space.
  void solve(const Eigen::Ref<const Matrix>& jacobian, const Eigen::Ref<const Vector>& target,
             const Eigen::Ref<const Vector>& y, NullSpace& above, double w);

  // The same for J = I, from the r rows V of the null space.
  void solve_identity(const Eigen::Ref<const Vector>& target, const Eigen::Ref<const Vector>& y,
                      const NullSpace& above, double w);

  // Make ready for `whiten` and `step`, which a level that meets every bound does not need.
  void prepare(const NullSpace& above);

  const Vector& optimum() const { return optimum_; }  // c (d,)
  const Matrix& rows() const { return inner_; }       // A (m, d), after `solve`
  double damping() const { return damping_; }         // w of this level

  // out (d,) = e P F in place of e P, of a row e (d,) on accelerations: the same row on s.
  template <typename Out>
  void whiten(Eigen::MatrixBase<Out>&& out) {
    weights_.resize(inner_.rows());
    times(inner_, out.derived(), weights_);
    weights_times_k();
    add_rows(inner_, weights_, 1.0, out.derived());
    out *= scale_;
  }

  // out (d,) = P F s, the step of accelerations of s (d,).
  void step(const Eigen::Ref<const Vector>& s, const NullSpace& above, Vector& out);

  // For products b_i H^-1 b_j of rows b (d,) = e P, H = A^T A + w I, without `prepare`: what the
  // level sees of `count` of them, and the same through its factor, a column each of (k, count):
  // S^-1 A b twice, or V b and X V b.
  void see(const double* rows, Index stride, Index count, const NullSpace& above);
  const Matrix& seen() const { return seen_; }
  const Matrix& through() const { return through_; }
  Index seen_rows() const { return inner_rows_; }

  // b_i H^-1 b_j from b_i b_j and what is seen of the one times the other through the factor.
  double product(double direct, double met) const {
    return identity_ ? (direct + met) / (1.0 + damping_) : (direct - met) / damping_;
  }

  // out (d,) = P H^-1 pull, the step of accelerations of a pull (d,) on u.
  void step_of_pull(const Eigen::Ref<const Vector>& pull, const NullSpace& above, Vector& out);

 private:
  // F = scale (I + D^T K D): D = A and K = -S^-T (S + sqrt(w) I)^-1, or D = W and K = (S + I)^-1.
  void weights_times_k();  // weights^T K in place
  void k_times_weights();  // K weights in place
  static void factor(Matrix& square);  // S in place of S S^T
  void solve_factored();   // weights = S^-T S^-1 weights

  bool identity_ = false, prepared_ = false;
  Index inner_rows_ = 0;             // m, or the r rows V of the identity
  Matrix inner_, factor_, shifted_;  // D, S and S + sqrt(w) I or S + I; lower triangles
  Matrix overlap_, spread_, root_;   // of the identity: E = I - V V^T, X, and the S of K
  Matrix seen_, through_;            // of `see`
  Vector optimum_, residual_, weights_, whitened_, spread_of_;
  double damping_ = 0.0, scale_ = 1.0;
};

}  // namespace ghc
