// The QP of a level that meets a bound: min 1/2 |s|^2 subject to every row at x = c + P F s.
//
// Dual active-set method of D. Goldfarb and A. Idnani (Mathematical Programming 27, 1983), with
// H = I: the active rows N (q, p), signed and of length one, have multipliers lambda >= 0 and
// N^T = Q^T R, so s = Q^T R^-T (right side) and lambda = R^-1 Q s. It starts from the active set
// of the same level one tick before: rows whose multiplier has the wrong sign are dropped until
// none is left, which is the optimum of a part of the rows, as good a start as none. Rows are
// formed only when they become active. Where that set is right, or wrong by a few rows, `KnownSet`
// has the answer before any of this begins, and the digits of an answer are always its.
#pragma once

#include <vector>

#include "active_row.hpp"
#include "bounds.hpp"
#include "known_set.hpp"
#include "level.hpp"
#include "null_space.hpp"
#include "projected_rows.hpp"

namespace ghc {

class ActiveSet {
 public:
  // True: optimal, every row is met, and `bounds` stands at the answer. False where the rows
  // conflict or `limit` pivots were not enough: another solver has to say which. `memory` holds
  // the active set to start from, and then the one found.
  bool solve(Level& level, const NullSpace& above, Bounds& bounds, ProjectedRows& rows,
             double force_weight, std::vector<ActiveRow>& memory, Index limit);

  Index pivots() const { return pivots_; }      // of the last solve, at least 1
  const Vector& optimum() const { return y_; }  // (d,) y

 private:
  void begin(Level& level, const NullSpace& above, Bounds& bounds, ProjectedRows& rows,
             double force_weight);
  bool form(const ActiveRow& active);           // the candidate row; false: it has no length
  void split_candidate();                       // into share_ = Q n and rest_ = n - Q^T Q n
  void append(const ActiveRow& active);         // the candidate becomes the last active row
  void drop(Index k);
  void start_from(const std::vector<ActiveRow>& memory);
  void factor(const std::vector<ActiveRow>& rows);  // make these the active ones
  // The active rows sorted: factored so, the last digit of an answer depends on the set alone.
  std::vector<ActiveRow> in_order() const;
  void answer();                                // s and lambda of the active rows
  bool enter(ActiveRow active, Index limit);    // make one violated row active
  bool refine();                                // s again, its active rows to rounding
  void evaluate();                              // y and every row at s

  Level* level_ = nullptr;
  const NullSpace* above_ = nullptr;
  Bounds* bounds_ = nullptr;
  ProjectedRows* rows_ = nullptr;
  double weight_ = 1.0;
  Index d_ = 0, size_ = 0, pivots_ = 0;         // size_ = q

  KnownSet known_;
  std::vector<ActiveRow> active_;
  std::vector<char> is_active_;                 // (rows of the bounds)
  Matrix normals_, basis_, triangle_;           // N (q, p), Q (q, p), R (q, q) upper
  Vector right_, multiplier_, s_, y_, base_;    // N s = right; base_: rows at s = 0
  RowVector candidate_, rest_;
  Matrix formed_;                               // rows of the bounds on s, those of length_ >= 0
  Vector length_;
  Vector share_, direction_;
  double candidate_right_ = 0.0, free_ = 0.0;   // free_ = |rest_|^2
};

}  // namespace ghc
