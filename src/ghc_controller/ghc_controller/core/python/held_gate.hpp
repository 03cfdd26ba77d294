// The gate as Python has it.
#pragma once

#include <algorithm>
#include <limits>

#include "arrays.hpp"
#include "gate.hpp"

namespace ghc {

using Output = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

// `Gate` of native.pyi: limits of torques and of their change per control period.
class HeldGate {
 public:
  HeldGate(nb::handle limit, nb::handle step) {
    const View limits = limit_held_.take(limit, 1), steps = step_held_.take(step, 1);
    if (limits.size() != steps.size()) throw nb::value_error("as many limits as steps expected");
    limit_ = limits, step_ = steps;
  }

  // Write the torque that may follow `before`; the largest excess [Nm] over limit and rate, inf
  // where one of both is not finite.
  double follow(const ConstVector& torque, const double* before, double* out) const {
    const Index a = limit_.size();
    if (!all_finite(torque) || !all_finite({before, a})) {
      return std::numeric_limits<double>::infinity();
    }
    const Excess excess = clip_torque(torque, before, limit_.vector(), step_.vector(), out);
    return std::max({excess.limit, excess.rate, excess.broken});
  }

  Index joints() const { return limit_.size(); }

  // See native.pyi.
  nb::tuple clip(nb::handle torque, nb::handle previous, const Output& out) {
    const Index a = limit_.size();
    const View wanted = torque_.take(torque, 1), before = previous_.take(previous, 1);
    if (wanted.size() != a || (!previous.is_none() && before.size() != a) || out.ndim() != 1 ||
        static_cast<Index>(out.size()) != a) {
      throw nb::value_error("torques (a,) expected");
    }
    const bool finite = all_finite(wanted.vector());
    const bool known = previous.is_none() || all_finite(before.vector());
    const Excess excess =
        clip_torque(wanted.vector(), previous.is_none() ? nullptr : before.data,
                    limit_.vector(), step_.vector(), out.data());
    return nb::make_tuple(finite, known, excess.limit, excess.rate, excess.broken);
  }

 private:
  HeldArray limit_held_, step_held_, torque_, previous_;
  View limit_, step_;  // read anew at every call: they may change
};

}  // namespace ghc
