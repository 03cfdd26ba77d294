// The task stack as Python has it: with the arrays that it reads and writes.
#pragma once

#include <utility>
#include <vector>

#include "task_stack.hpp"
#include "views.hpp"

namespace ghc::python {

// The stack with what it reads and writes, which it keeps alive.
class HeldStack {
 public:
  HeldStack(nb::object model, const nb::list& measures, const std::vector<std::int64_t>& firsts,
            InOut2 jacobian, InOut2 vectors, InOut1 references)
      : model_(std::move(model)),
        measures_(nb::tuple(measures)),
        jacobian_(std::move(jacobian)),
        vectors_(std::move(vectors)),
        references_(std::move(references)),
        stack(nb::cast<const Model&>(model_), jacobian_.data(), vectors_.data(),
              static_cast<Index>(jacobian_.shape(0))) {
    const auto& core = nb::cast<const Model&>(model_);
    const auto m = static_cast<Index>(jacobian_.shape(0));
    expect(static_cast<Index>(jacobian_.shape(1)) == core.tree.nv() && vectors_.shape(0) == 7 &&
               static_cast<Index>(vectors_.shape(1)) == m && firsts.size() == measures_.size(),
           "a Jacobian (m, n), vectors (7, m) and a first row for each measure expected");
    Index used = 0;
    for (size_t i = 0; i < firsts.size(); ++i) {
      auto& measure = nb::cast<Measure&>(measures_[i]);
      measure.check(core);
      expect(firsts[i] >= 0 && firsts[i] + measure.rows() <= m &&
                 used + measure.reference_size() <= static_cast<Index>(references_.size()),
             "rows inside of the Jacobian, and references of all measures expected");
      stack.add(measure, static_cast<Index>(firsts[i]), references_.data() + used);
      used += measure.reference_size();
    }
  }

  const nb::object& model() const { return model_; }
  ghc::View jacobian() const {
    return {jacobian_.data(), static_cast<Index>(jacobian_.shape(0)),
            static_cast<Index>(jacobian_.shape(1))};
  }
  ghc::View target() const {
    const auto m = static_cast<Index>(vectors_.shape(1));
    return {vectors_.data() + kTarget * m, m, 1};
  }

 private:
  nb::object model_;
  nb::tuple measures_;
  InOut2 jacobian_, vectors_;
  InOut1 references_;

 public:
  TaskStack stack;
};

}  // namespace ghc::python
