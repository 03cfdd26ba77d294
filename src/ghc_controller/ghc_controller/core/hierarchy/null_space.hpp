// Null space that opens and closes smoothly: P = I - S^T (S S^T + e^2 I)^-1 S.
//
// S stacks the rows of all levels above. With L L^T = S S^T + e^2 I and V = L^-1 S it is
// P = I - V^T V, and a further level only appends rows to V. At a singularity P goes from 0 to 1
// over singular values of about e instead of at once.
#pragma once

#include <algorithm>

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
    project_on(row, 0, out.derived());
  }

  // The same, where the first rows of V are taken off already.
  template <typename Row, typename Out>
  void project_on(const Eigen::MatrixBase<Row>& row, Index first, Out&& out) const {
    for (Index b = first; b < used_; ++b) out -= row.dot(basis_.row(b)) * basis_.row(b);
  }

  // out (m, d) = rows P.
  void project_rows(const Eigen::Ref<const Matrix>& rows, Matrix& out) {
    out = rows;
    if (used_ == 0) return;
    if (dimension() <= kShort) {
      for (Index r = 0; r < rows.rows(); ++r) project_on(rows.row(r), 0, out.row(r));
      return;
    }
    const auto V = basis_.topRows(used_);
    along_.noalias() = rows * V.transpose();
    out.noalias() -= along_ * V;
  }

  // P (d, d).
  Matrix projector() const;

  auto basis() const { return basis_.topRows(used_); }  // V (used, d)
  Index used() const { return used_; }
  Index left() const { return basis_.rows() - used_; }  // rows that can still be appended
  double trace() const { return std::max(trace_, 0.0); }  // of P, no less than its norm
  Index dimension() const { return basis_.cols(); }

 private:
  static constexpr Index kShort = 12;  // directions up to which products of matrices do not pay

  Matrix basis_;  // V; rows from used_ on are free
  Matrix along_;  // rows V^T of `project_rows`
  Index used_ = 0;
  double trace_ = 0.0;
};

}  // namespace ghc
