// Matrices as NumPy stores them (rows one after the other).
//
// Sizes in the comments: n accelerations x, d reduced ones y, a joints, u unactuated coordinates,
// c contact forces f, m rows of a level, q active rows, p entries of the QP's variables s.
#pragma once

#include <Eigen/Core>

namespace ghc {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;
using RowVector = Eigen::RowVectorXd;
using ConstMatrix = Eigen::Map<const Matrix>;
using ConstVector = Eigen::Map<const Vector>;
using Index = Eigen::Index;

// Memory of an array; without entries where there is none.
struct View {
  const double* data = nullptr;
  Index rows = 0, cols = 0;

  ConstMatrix matrix() const { return {data, rows, cols}; }
  ConstVector vector() const { return {data, rows * cols}; }
  Index size() const { return rows * cols; }
};

}  // namespace ghc
