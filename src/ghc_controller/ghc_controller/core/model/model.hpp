// The model of a robot: its tree of joints and the frames in use, updated together.
#pragma once

#include <utility>

#include "frames.hpp"

namespace ghc {

struct Model {
  Model(std::vector<Joint> joints, bool floating, const Vector3& gravity, Vector armature)
      : tree(std::move(joints), floating, gravity, std::move(armature)), frames(tree) {}
  Model(const Model&) = delete;

  void update(const double* q, const double* v) {
    tree.update(q, v);
    frames.update();
  }

  Tree tree;
  Frames frames;
};

}  // namespace ghc
