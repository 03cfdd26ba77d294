// How a task of a standard kind measures its variable: error, Jacobian and drift of its rows.
#pragma once

#include <vector>

#include "model.hpp"

namespace ghc {

// Rows of one task; drift, velocity and acceleration as in TaskRows (types.py).
struct RowBlock {
  double *error, *drift, *velocity, *acceleration;  // (m,)
  double* jacobian;                                  // (m, n)
};

class Measure {
 public:
  Measure(Index rows, Index reference_size) : rows_(rows), reference_size_(reference_size) {}
  virtual ~Measure() = default;

  // Throws std::invalid_argument where the model has not what is measured.
  virtual void check(const Model& model) const = 0;

  // Write the rows at the model's last update; the reference as the kind of task counts it.
  virtual void write(const Model& model, const double* reference, const RowBlock& out) = 0;

  Index rows() const { return rows_; }
  Index reference_size() const { return reference_size_; }

 private:
  Index rows_, reference_size_;
};

// Chosen rows of x, y, z, rx, ry, rz (0 to 5) of a frame, positions first, all three turns or
// none; as seen from the world, or from another frame. The error of a rotation is log(R* R^T).
class FrameMeasure : public Measure {
 public:
  FrameMeasure(std::vector<Index> rows, Index frame, Index base);

  void check(const Model& model) const override;
  void write(const Model& model, const double* reference, const RowBlock& out) override;

 private:
  std::vector<Index> chosen_;
  Index frame_, base_;  // base -1: the world
  FrameTerms seen_;
};

// Chosen coordinates of the center of mass.
class CenterMeasure : public Measure {
 public:
  explicit CenterMeasure(std::vector<Index> axes);

  void check(const Model& model) const override;
  void write(const Model& model, const double* reference, const RowBlock& out) override;

 private:
  std::vector<Index> axes_;
};

// Positions of joints.
class JointMeasure : public Measure {
 public:
  explicit JointMeasure(std::vector<Index> joints);  // among the actuated ones

  void check(const Model& model) const override;
  void write(const Model& model, const double* reference, const RowBlock& out) override;

 private:
  std::vector<Index> joints_;
};

// Joints beyond an edge: rows that bring them to rest there; those of all others are zero.
class EdgeMeasure : public Measure {
 public:
  EdgeMeasure(Vector lower, Vector upper);  // (a,)

  void check(const Model& model) const override;
  void write(const Model& model, const double* reference, const RowBlock& out) override;

 private:
  Vector lower_, upper_;
};

}  // namespace ghc
