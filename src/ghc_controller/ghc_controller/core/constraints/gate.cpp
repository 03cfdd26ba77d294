#include "gate.hpp"

#include <algorithm>
#include <cmath>

namespace ghc {

Excess clip_torque(const ConstVector& torque, const double* previous, const ConstVector& limit,
                   const ConstVector& step, double* out) {
  Excess excess;
  for (Index i = 0; i < torque.size(); ++i) {
    double value = torque[i];
    excess.limit = std::max(excess.limit, std::abs(value) - limit[i]);
    if (previous) {
      excess.rate = std::max(excess.rate, std::abs(value - previous[i]) - step[i]);
      value = std::min(std::max(value, previous[i] - step[i]), previous[i] + step[i]);
    }
    value = std::min(std::max(value, -limit[i]), limit[i]);
    if (previous) excess.broken = std::max(excess.broken, std::abs(value - previous[i]) - step[i]);
    out[i] = value;
  }
  return excess;
}

bool all_finite(const ConstVector& values) {
  return std::all_of(values.data(), values.data() + values.size(),
                     [](double value) { return std::isfinite(value); });
}

}  // namespace ghc
