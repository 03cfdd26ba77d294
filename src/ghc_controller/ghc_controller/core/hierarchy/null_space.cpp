#include "null_space.hpp"

#include <algorithm>
#include <cmath>

namespace ghc {

void NullSpace::reset(Index d, Index capacity) {
  if (basis_.cols() != d || basis_.rows() < capacity) basis_.resize(capacity, d);
  along_.resize(basis_.rows());
  used_ = 0, trace_ = static_cast<double>(d);
}

void NullSpace::append(const Eigen::Ref<const Matrix>& rows,
                       const Eigen::Ref<const Matrix>& projected, double e) {
  const Index before = used_;
  for (Index r = 0; r < rows.rows(); ++r) {
    const auto given = rows.row(r);
    auto row = basis_.row(used_);
    row = projected.row(r);
    project_on(given, before, row);
    const double pivot = e * e * std::max(1.0, given.squaredNorm()) + given.dot(row);
    row *= 1.0 / std::sqrt(std::max(pivot, e * e));
    trace_ -= row.squaredNorm();
    ++used_;
  }
}

Matrix NullSpace::projector() const {
  const auto rows = basis_.topRows(used_);
  return Matrix::Identity(dimension(), dimension()) - rows.transpose() * rows;
}

}  // namespace ghc
