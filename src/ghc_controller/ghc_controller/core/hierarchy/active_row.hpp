// Rows of the bounds at one of their sides, and the row that a point violates most.
#pragma once

#include <algorithm>
#include <vector>

#include "bounds.hpp"

namespace ghc {

struct ActiveRow {
  Index row;
  int side;  // +1 at its lower bound, -1 at its upper one
};

constexpr double kMet = 1e-9;        // [-] a row violated by less, over its length, is met
constexpr double kFeasible = 5e-8;   // [rad/s^2], [Nm], [N] of an answer
constexpr double kNoLength = 1e-9;   // [-] of a row that no s moves
constexpr double kWrongSign = 1e-9;  // [-] of the largest multiplier

// The row that the point at which the bounds stand violates most over its length, among those that
// are not active; side 0: none.
inline ActiveRow most_violated(const Bounds& bounds, const std::vector<char>& is_active) {
  ActiveRow worst{-1, 0};
  double most = kMet;
  const Vector &values = bounds.values(), &scale = bounds.scale();
  for (Index i = 0; i < bounds.count(); ++i) {
    const double below = bounds.lower(i) - values[i], above = values[i] - bounds.upper(i);
    const double by = std::max(below, above);
    if (!(by > most * scale[i]) || is_active[i]) continue;
    most = by / scale[i], worst = {i, below > above ? 1 : -1};
  }
  return worst;
}

}  // namespace ghc
