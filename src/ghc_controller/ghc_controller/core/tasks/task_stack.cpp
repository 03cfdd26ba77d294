#include "task_stack.hpp"

namespace ghc {

void track(const Eigen::Ref<const Matrix>& jacobian, const double* v,
           Eigen::Ref<Matrix> vectors) {
  const ConstVector velocity(v, jacobian.cols());
  for (Index i = 0; i < jacobian.rows(); ++i) {
    const double rate = jacobian.row(i).dot(velocity);
    const double wanted = vectors(kAcceleration, i) + vectors(kStiffness, i) * vectors(kError, i) +
                          vectors(kDamping, i) * (vectors(kVelocity, i) - rate);
    vectors(kTarget, i) = wanted - vectors(kDrift, i);
  }
}

void TaskStack::measure() {
  const Index n = model_.tree.nv();
  const auto vector = [this](RowVector7 which, Index first) {
    return vectors_ + which * rows_ + first;
  };
  for (const Entry& task : tasks_) {
    const Index first = task.first;
    task.measure->write(model_, task.reference,
                        {vector(kError, first), vector(kDrift, first), vector(kVelocity, first),
                         vector(kAcceleration, first), jacobian_ + first * n});
  }
}

void TaskStack::track() {
  ghc::track(ConstMatrix(jacobian_, rows_, model_.tree.nv()), model_.tree.v.data(),
             Eigen::Map<Matrix>(vectors_, 7, rows_));
}

}  // namespace ghc
