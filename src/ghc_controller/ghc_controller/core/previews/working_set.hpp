// Dual active-set method (Goldfarb and Idnani 1983) in the space of the bounded rows.
//
// The QPs of previews have hundreds of rows and a handful of active ones. Written in y = C x with
// the bounds y <= b, the method needs no matrix but the columns C H^-1 C^T of the rows that it
// takes in: each QP supplies them from its own structure on request.
#pragma once

#include <vector>

#include "matrix.hpp"

namespace ghc {

class WorkingSet {
 public:
  static constexpr Index kCapacity = 64;     // rows; previews have a few per jump in the horizon
  static constexpr int kMaxChanges = 400;    // rows added before the method stops

  // y (m,) of the optimum without bounds, and bounds (m,), inf where there is none.
  WorkingSet(const Vector& y, const Vector& bound);

  // Row farthest above its bound; -1 where all are within `share` of the accepted violation.
  Index most_violated(const Vector& y, double share = 1.0) const;
  Index most_violated() const { return most_violated(y_); }

  bool full() const { return count() == kCapacity - 1; }

  // Make a row hold with equality, of which `column` (m,) is C H^-1 C^T; false: rows conflict.
  bool take_in(Index row, const Vector& column);

  Index count() const { return static_cast<Index>(rows_.size()); }
  Index row(Index k) const { return rows_[static_cast<size_t>(k)]; }
  double multiplier(Index k) const { return multipliers_[static_cast<size_t>(k)]; }
  const Vector& y() const { return y_; }

 private:
  Vector y_, bound_, change_;
  double tolerance_;
  std::vector<Index> rows_;
  std::vector<double> multipliers_;
  std::vector<Vector> columns_;
  Eigen::MatrixXd gram_;
  Vector across_, share_;
};

}  // namespace ghc
