#include "force_cost.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace ghc {

void force_cost(const ForceWeights& weights, const ConstVector& normal, const ConstVector& last,
                double* center, double* factor, Index stride) {
  const Index c = normal.size();
  const double points = normal.squaredNorm(), load = normal.dot(last);
  const double held = std::max(load, weights.least), scale = weights.share / held;
  const Vector ratio = (last - normal * (load / points)) / held;
  const double square = ratio.squaredNorm();
  Matrix hessian = Matrix::Identity(c, c) * (weights.base + scale);
  hessian -= scale * (ratio * normal.transpose() + normal * ratio.transpose());
  hessian += (scale * (square - 1.0 / points) + weights.task) * normal * normal.transpose();
  const Vector pull = normal * (0.5 * weights.share * square + weights.task * weights.reference) -
                      weights.share * ratio;
  const Eigen::LLT<Matrix> cholesky(hessian);
  Eigen::Map<Matrix, 0, Eigen::OuterStride<>> inverse(factor, c, c, Eigen::OuterStride<>(stride));
  inverse.setIdentity();
  cholesky.matrixU().solveInPlace(inverse);
  Eigen::Map<Vector>(center, c) = cholesky.solve(pull);
}

}  // namespace ghc
