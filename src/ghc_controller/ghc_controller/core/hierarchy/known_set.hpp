// The QP of a level whose active rows are known but for a few, mostly those of the tick before.
//
// With B (q, p) the active rows on u and s_f, c the optimum without bounds and H = A^T A + w I (the
// identity on s_f), the point of least cost at which these rows are met is x = c + P H^-1 B^T l with
// G l = right side - rows at c and G = B H^-1 B^T (Schur complement; J. Nocedal, S. Wright,
// Numerical Optimization, 2006, section 16.2). It is stationary whatever l is, so that
// multipliers of the right sign, active rows at their bounds and all others met are optimality.
// G takes the factor of the level as it is: nothing is whitened. Rows that are nearly dependent
// are left to `ActiveSet`, which keeps an orthogonal factor.
#pragma once

#include <vector>

#include "active_row.hpp"
#include "level.hpp"
#include "null_space.hpp"
#include "projected_rows.hpp"

namespace ghc {

class KnownSet {
 public:
  // What a level hands over; `base` are the rows of the bounds at its optimum without them.
  struct Task {
    Level& level;
    const NullSpace& above;
    Bounds& bounds;
    ProjectedRows& rows;
    double force_weight;
    const Vector& base;
  };

  // True: optimal, every row is met, `bounds` stands at the answer y (d,), and `set` is its active
  // set. False: the set is further from it than a few rows, or `limit` pivots; it stays.
  bool solve(const Task& task, std::vector<ActiveRow>& set, Index limit, Vector& y);

  Index pivots() const { return pivots_; }  // of the last solve, at least 1

 private:
  struct Slot {  // of a row that is or was active
    ActiveRow active;
    double length, inverse;  // root of its entry of G
  };

  void begin(const Task& task, Index rows);
  bool add(const ActiveRow& active);  // false: it has no bound
  Index take(Index row);              // its slot, -1: there is none left
  void complete();                    // G of the slots taken since; rows without length leave
  bool factor();                      // G of the active rows; false: they are nearly dependent
  void divide();                      // right_ = G^-1 right_, both of rows of length one
  bool drop_wrong();                  // rows whose multiplier has the wrong sign
  void move(Vector& y);               // y and every row at the multipliers
  double miss();                      // right_ = what the active rows miss; the largest of it
  bool refine(Vector& y);

  const Task* task_ = nullptr;
  std::vector<Slot> slots_;
  std::vector<Index> order_;     // slots of the active rows, by row
  std::vector<char> is_active_;  // (rows of the bounds)
  Matrix rows_, seen_, through_;  // (slots, p), (slots, k) twice: Level::see
  Matrix gram_, lower_;           // (slots, slots) G, and L of the active rows in their order
  Vector right_, multiplier_, pull_, step_, direct_, met_, across_;
  Index d_ = 0, free_ = 0, seen_size_ = 0, completed_ = 0, pivots_ = 0;
};

}  // namespace ghc
