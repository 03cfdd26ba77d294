// Boxes of one space as Python has them: with the arrays that they are merged in.
#pragma once

#include <utility>
#include <vector>

#include "boxes.hpp"
#include "model.hpp"
#include "views.hpp"

namespace ghc::python {

using Sources = nb::ndarray<std::int64_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

inline ConstVector vector(const In1& a) { return {a.data(), static_cast<Index>(a.size())}; }

inline ConstMatrix matrix(const In2& a) {
  if (!a.is_valid()) return {nullptr, 0, 0};
  return {a.data(), static_cast<Index>(a.shape(0)), static_cast<Index>(a.shape(1))};
}

// What a box depends on, at the last update of a model.
inline Tick tick_of(const Model& model, const In1& previous, double dt, const In1& jerk,
                    Index joints) {
  const Tree& tree = model.tree;
  const Index base = tree.floating() ? 1 : 0, u = 6 * base, a = tree.nv() - u;
  const auto fits = [a](const In1& given) {
    return !given.is_valid() || static_cast<Index>(given.size()) == a;
  };
  expect(a == joints && fits(previous) && fits(jerk), "a bound, torque and jerk of each joint");
  return {tree.q.data() + 7 * base, tree.v.data() + u, tree.gravity_torque.data() + u,
          previous.is_valid() ? previous.data() : nullptr,
          jerk.is_valid() ? jerk.data() : nullptr, dt};
}

// Boxes of one space with the memory of their merge; a box that is None is written by Python.
class HeldBoxes {
 public:
  HeldBoxes(const nb::list& boxes, Index hard, InOut2 lowers, InOut2 uppers, InOut2 merged,
            Sources sources, InOut2 slack)
      : boxes_(nb::tuple(boxes)),
        hard_(hard),
        lowers_(std::move(lowers)),
        uppers_(std::move(uppers)),
        merged_(std::move(merged)),
        slack_(std::move(slack)),
        sources_(std::move(sources)) {
    const size_t count = boxes_.size(), entries = merged_.shape(1);
    for (const InOut2& array : {lowers_, uppers_, slack_}) {
      expect(array.shape(0) == count && array.shape(1) == entries, "(c, r) arrays expected");
    }
    expect(merged_.shape(0) == 4 && sources_.shape(0) == 2 && sources_.shape(1) == entries,
           "merged (4, r) and sources (2, r) expected");
    for (size_t c = 0; c < count; ++c) {
      if (boxes_[c].is_none()) continue;
      const auto& box = nb::cast<const JointBox&>(boxes_[c]);
      const Index skipped = static_cast<Index>(entries) - box.joints();
      expect(skipped >= 0 && (compiled_.empty() ||
                              compiled_.front().box->joints() == box.joints()),
             "boxes of the same joints, no more than there are entries, expected");
      compiled_.push_back({&box, static_cast<Index>(c * entries) + skipped});
    }
  }

  Index entries() const { return static_cast<Index>(merged_.shape(1)); }
  bool complete() const { return compiled_.size() == boxes_.size(); }  // none is written by Python

  // Lower, upper, and the same of the hard boxes alone: which = 0 to 3.
  ghc::View merged(Index which) const {
    return {merged_.data() + which * entries(), entries(), 1};
  }

  bool update(const Model& model, const In1& previous, double dt, const In1& jerk) {
    if (compiled_.empty()) return update_at({});
    return update_at(tick_of(model, previous, dt, jerk, compiled_.front().box->joints()));
  }

  bool update_at(const Tick& tick) {
    for (const Entry& entry : compiled_) {
      entry.box->write(tick, lowers_.data() + entry.first, uppers_.data() + entry.first);
    }
    const auto all = [](const InOut2& a) {
      return ConstMatrix(a.data(), static_cast<Index>(a.shape(0)),
                         static_cast<Index>(a.shape(1)));
    };
    return merge_boxes(all(lowers_), all(uppers_), hard_, merged_.data(), sources_.data(),
                       slack_.data());
  }

 private:
  struct Entry {
    const JointBox* box;
    Index first;  // in lowers and uppers
  };

  nb::tuple boxes_;
  Index hard_;
  InOut2 lowers_, uppers_, merged_, slack_;
  Sources sources_;
  std::vector<Entry> compiled_;
};

}  // namespace ghc::python
