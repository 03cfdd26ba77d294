// Dual active-set method of Goldfarb and Idnani for a strictly convex dense QP.
//
// D. Goldfarb, A. Idnani: A numerically stable dual method for solving strictly convex quadratic
// programs, Mathematical Programming 27, 1983. The step directions of section 3 come from an
// orthogonal factor that is updated by Givens rotations (section 4); rows have two sides,
// equalities are never dropped. n variables, e equalities, r two-sided rows, q active rows.
#pragma once

#include <vector>

#include "matrix.hpp"
#include "residuals.hpp"

namespace ghc {

enum class DualEnd { solved, infeasible, limit, failed };

class DualMethod {
 public:
  // Solve with at most so many pivots.
  DualEnd solve(const Qp& qp, Index limit);

  Index pivots() const { return pivots_; }
  const Vector& x() const { return x_; }  // (n,)
  const Vector& y() const { return y_; }  // (e,), (r,): H x + g + A^T y + C^T z = 0
  const Vector& z() const { return z_; }

 private:
  struct Candidate {
    Index row;       // of the equalities, or of the rows
    int sign;        // +1 lower bound, -1 upper one
    double violation, value, length;
    bool is_equality;
  };
  enum class Step { taken, skipped, conflict, limit, failed };

  Candidate equality(Index row);
  Candidate most_violated();
  void set_normal(const Candidate& candidate);
  Step take_in(const Qp& qp, Candidate candidate, Index limit);
  void add(Vector& d);
  void drop(Index column);
  void refine();

  const Qp* qp_ = nullptr;
  Matrix basis_;     // row k: direction k, conjugate in H
  Matrix triangle_;  // R of the active rows in it
  Matrix normals_;   // (q, n) active rows, normalized and towards their bound
  Vector values_, multiplier_, sign_of_, norm_, x_, y_, z_, normal_, along_, step_;
  std::vector<Index> active_;  // rows behind the e equalities
  std::vector<int> side_;  // +1 active at the lower bound, -1 at the upper one, or skipped
  Index q_ = 0, pivots_ = 0;
};

}  // namespace ghc
