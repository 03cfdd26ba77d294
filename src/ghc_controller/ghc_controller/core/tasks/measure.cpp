#include "measure.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "rotation.hpp"

namespace ghc {
namespace {

constexpr Index kFirstTurn = 3;  // of x, y, z, rx, ry, rz

Index turns(const std::vector<Index>& rows) {
  return std::count_if(rows.begin(), rows.end(), [](Index row) { return row >= kFirstTurn; });
}

Index size(const std::vector<Index>& rows) { return static_cast<Index>(rows.size()); }

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

Index unactuated(const Model& model) { return model.tree.floating() ? 6 : 0; }

// Positions of the actuated joints, (a,).
const double* joint_positions(const Model& model) {
  return model.tree.q.data() + (model.tree.floating() ? 7 : 0);
}

}  // namespace

FrameMeasure::FrameMeasure(std::vector<Index> rows, Index frame, Index base)
    : Measure(size(rows), size(rows) + (turns(rows) ? 1 : 0)),
      chosen_(std::move(rows)),
      frame_(frame),
      base_(base),
      seen_(0) {
  require(std::is_sorted(chosen_.begin(), chosen_.end(),
                        [](Index a, Index b) { return a < kFirstTurn && b >= kFirstTurn; }) &&
             (turns(chosen_) == 0 || turns(chosen_) == 3),
         "rows of the position, then all three of the rotation or none expected");
  for (const Index row : chosen_) require(row >= 0 && row < 6, "rows 0 to 5 expected");
}

void FrameMeasure::check(const Model& model) const {
  require(frame_ >= 0 && frame_ < model.frames.count() && base_ < model.frames.count(),
         "frames of the model expected");
}

void FrameMeasure::write(const Model& model, const double* reference, const RowBlock& out) {
  const Index n = model.tree.nv(), m = rows();
  if (base_ >= 0) {
    if (seen_.jacobian.cols() != n) seen_ = FrameTerms(n);
    see_from(model.frames[base_], model.frames[frame_], seen_);
  }
  const FrameTerms& terms = base_ >= 0 ? seen_ : model.frames[frame_];
  if (chosen_.back() >= kFirstTurn) {
    const Vector3 turn = rotation_error(reference + m - 3, terms.rotation());
    std::copy_n(turn.data(), 3, out.error + m - 3);
  }
  for (Index i = 0; i < m; ++i) {
    const Index row = chosen_[i];
    if (row < kFirstTurn) out.error[i] = reference[i] - terms.pose(3, row);
    out.drift[i] = terms.motion(1, row);
    std::copy_n(terms.jacobian.data() + row * n, n, out.jacobian + i * n);
  }
}

CenterMeasure::CenterMeasure(std::vector<Index> axes)
    : Measure(size(axes), size(axes)), axes_(std::move(axes)) {
  for (const Index axis : axes_) require(axis >= 0 && axis < 3, "axes 0 to 2 expected");
}

void CenterMeasure::check(const Model& model) const {
  require(model.tree.mass() > 0.0, "a robot with a mass expected");
}

void CenterMeasure::write(const Model& model, const double* reference, const RowBlock& out) {
  const Tree& tree = model.tree;
  for (Index i = 0; i < rows(); ++i) {
    const Index axis = axes_[i];
    out.error[i] = reference[i] - tree.center(0, axis);
    out.drift[i] = tree.center(2, axis);
    std::copy_n(tree.center_jacobian.data() + axis * tree.nv(), tree.nv(),
                out.jacobian + i * tree.nv());
  }
}

JointMeasure::JointMeasure(std::vector<Index> joints)
    : Measure(size(joints), size(joints)), joints_(std::move(joints)) {}

void JointMeasure::check(const Model& model) const {
  for (const Index joint : joints_) {
    require(joint >= 0 && joint < model.tree.nv() - unactuated(model), "actuated joints expected");
  }
}

void JointMeasure::write(const Model& model, const double* reference, const RowBlock& out) {
  const double* position = joint_positions(model);
  const Index n = model.tree.nv(), u = unactuated(model);
  for (Index i = 0; i < rows(); ++i) {
    out.error[i] = reference[i] - position[joints_[i]];
    out.drift[i] = 0.0;
    std::fill_n(out.jacobian + i * n, n, 0.0);
    out.jacobian[i * n + u + joints_[i]] = 1.0;
  }
}

EdgeMeasure::EdgeMeasure(Vector lower, Vector upper)
    : Measure(lower.size(), 0), lower_(std::move(lower)), upper_(std::move(upper)) {
  require(lower_.size() == upper_.size(), "as many lower as upper edges expected");
}

void EdgeMeasure::check(const Model& model) const {
  require(rows() == model.tree.nv() - unactuated(model), "an edge for each actuated joint expected");
}

void EdgeMeasure::write(const Model& model, const double*, const RowBlock& out) {
  const double* position = joint_positions(model);
  const Index n = model.tree.nv(), u = unactuated(model);
  for (Index i = 0; i < rows(); ++i) {
    const double edge = std::min(std::max(position[i], lower_[i]), upper_[i]);
    out.error[i] = edge - position[i];
    out.drift[i] = out.velocity[i] = out.acceleration[i] = 0.0;
    std::fill_n(out.jacobian + i * n, n, 0.0);
    out.jacobian[i * n + u + i] = out.error[i] != 0.0 ? 1.0 : 0.0;
  }
}

}  // namespace ghc
