// Where the torque rate counts from; copies, since a torque that was given out may be changed.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "buffers.hpp"

namespace ghc::python {

constexpr double kSameTime = 1e-9;  // [s]

// A vector of any size, or none.
class HeldVector {
 public:
  void take(const double* data, Index size) {
    numbers_.assign(data, data + size);
    given_ = true;
  }
  void take(nb::handle array) {
    Buffer<double> buffer;
    buffer.take(array, 1);
    take(buffer.data(), buffer.size());
  }

  // Memory of `size` numbers; nullptr where there are others or none.
  const double* data(Index size) const {
    return given_ && static_cast<Index>(numbers_.size()) == size ? numbers_.data() : nullptr;
  }
  nb::object array() const {
    if (!given_) return nb::none();
    const NewArray made(static_cast<Index>(numbers_.size()));
    std::copy(numbers_.begin(), numbers_.end(), made.data());
    return made.object();
  }
  bool is_given() const { return given_; }
  void forget() { given_ = false; }

 private:
  std::vector<double> numbers_;
  bool given_ = false;
};

// `Anchor` of native.pyi.
class HeldAnchor {
 public:
  explicit HeldAnchor(double hold) : hold_(hold) {}

  void note(nb::handle torque, double time) { sent_.take(torque), time_ = time; }
  void keep(const double* torque, Index joints, double time) {
    sent_.take(torque, joints), time_ = time;
  }
  void forget() { sent_.forget(), before_.forget(), time_ = 0.0; }

  // Whether the torque sent last is where the next one counts from: no hold came after it.
  bool follows(double time) const { return sent_.is_given() && time - time_ <= hold_; }

  // Memory (a,) of the torque from which the answer to a state counts, which `follows`.
  const double* at(double time, Index joints) {
    if (!(std::abs(time - time_) <= kSameTime)) before_ = sent_;
    return before_.data(joints);
  }

  bool is_given() const { return sent_.is_given(); }
  double time() const { return time_; }
  nb::object sent() const { return sent_.array(); }
  nb::object before() const { return before_.array(); }
  void set_before(nb::handle torque) {
    torque.is_none() ? before_.forget() : before_.take(torque);
  }

 private:
  double hold_, time_ = 0.0;
  HeldVector sent_, before_;
};

}  // namespace ghc::python
