// Null space that opens and closes smoothly: P = I - S^T (S S^T + e^2 I)^-1 S.
//
// S stacks the rows of all levels above. With L L^T = S S^T + e^2 I and V = L^-1 S it is
// P = I - V^T V, and a further level only appends rows to V. At a singularity P goes from 0 to 1
// over singular values of about e instead of at once.
#pragma once

#include <algorithm>

#include "few_rows.hpp"
#include "matrix.hpp"

namespace ghc {

class NullSpace {
 public:
  // The whole space of d directions; `capacity` rows can be appended.
  void reset(Index d, Index capacity);

  // Append what the rows (m, d) of a level add; `projected` (m, d) are rows P before it. A row longer than 1 is damped in proportion, so
  // that rounding never outweighs the damping e.
  void append(const Eigen::Ref<const Matrix>& rows, const Eigen::Ref<const Matrix>& projected,
              double e);

  // out (d,) = P row; P is symmetric. The shares are those of the row as it is given, since V is no
  // orthonormal basis.
  template <typename Row, typename Out>
  void project(const Eigen::MatrixBase<Row>& row, Eigen::MatrixBase<Out>&& out) const {
    out = row;
    project_on(row.derived(), 0, out.derived());
  }

  // The same, where the first rows of V are taken off already.
  template <typename Row, typename Out>
  void project_on(const Row& row, Index first, Out&& out) const {
    const auto V = basis_.middleRows(first, used_ - first);
    times(V, row, along_);
    add_rows(V, along_, -1.0, out);
  }

  // out (m, d) = rows P.
  void project_rows(const Eigen::Ref<const Matrix>& rows, Matrix& out) const {
    out = rows;
    if (used_ == 0) return;
    for (Index r = 0; r < rows.rows(); ++r) project_on(rows.row(r), 0, out.row(r));
  }

  // P (d, d).
  Matrix projector() const;

  auto basis() const { return basis_.topRows(used_); }  // V (used, d)
  Index used() const { return used_; }
  Index left() const { return basis_.rows() - used_; }  // rows that can still be appended
  double trace() const { return std::max(trace_, 0.0); }  // of P, no less than its norm
  Index dimension() const { return basis_.cols(); }

 private:
  Matrix basis_;           // V; rows from used_ on are free
  mutable Vector along_;   // V row of `project_on`
  Index used_ = 0;
  double trace_ = 0.0;
};

}  // namespace ghc
