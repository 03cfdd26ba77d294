// The rows of all tasks of standard kinds, measured together, and the control law of all rows.
#pragma once

#include <vector>

#include "measure.hpp"

namespace ghc {

// The seven vectors of TaskRows (types.py), one below the other, (7, m).
enum RowVector7 { kError, kDrift, kVelocity, kAcceleration, kStiffness, kDamping, kTarget };

// xi''_d = xi''* + kp e + kd (xi'* - J v), target = xi''_d - dJ/dt v (section 6 of ghc_2015), of
// rows J (m, n), vectors (7, m) and v (n,).
void track(const Eigen::Ref<const Matrix>& jacobian, const double* v,
           Eigen::Ref<Matrix> vectors);

class TaskStack {
 public:
  // Memory of all rows: Jacobian (m, n), vectors (7, m). It must outlive the stack.
  TaskStack(const Model& model, double* jacobian, double* vectors, Index rows)
      : model_(model), jacobian_(jacobian), vectors_(vectors), rows_(rows) {}

  // Measure a task from a row on, against a reference that is read at every update.
  void add(Measure& measure, Index first, const double* reference) {
    tasks_.push_back({&measure, first, reference});
  }

  void measure();
  void track();

 private:
  struct Entry {
    Measure* measure;
    Index first;
    const double* reference;
  };

  const Model& model_;
  double *jacobian_, *vectors_;
  Index rows_;
  std::vector<Entry> tasks_;
};

}  // namespace ghc
