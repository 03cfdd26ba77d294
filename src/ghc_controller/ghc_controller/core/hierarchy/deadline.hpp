// When a control step has to end where time is real: looked at between levels, never inside one.
#pragma once

#include <algorithm>
#include <chrono>

#include "matrix.hpp"

namespace ghc {

// Monotonic time [s]; with a step, one that moves by it at each look, the same on every machine.
class Clock {
 public:
  explicit Clock(double step = 0.0) : step_(step) {}

  double now() {
    if (step_ > 0.0) return counted_ += step_;
    const auto since = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(since).count();
  }

 private:
  double step_, counted_ = 0.0;
};

struct Deadline {
  Clock* clock = nullptr;  // none: effort is a count of pivots alone
  double end = 0.0;        // [s] of the clock

  bool over() const { return clock && clock->now() >= end; }

  // That of the first of `parts` that share alike what is left.
  Deadline first_of(Index parts) const {
    if (!clock || parts < 2) return *this;
    const double now = clock->now();
    return {clock, now + std::max(end - now, 0.0) / static_cast<double>(parts)};
  }
};

}  // namespace ghc
