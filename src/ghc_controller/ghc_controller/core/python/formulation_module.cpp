// The Python face of projectors, and of the systems that formulations make of them.
#include "buffers.hpp"
#include "compare_modules.hpp"
#include "projected.hpp"
#include "projectors.hpp"
#include "small_factors.hpp"
#include "weights.hpp"

namespace ghc::python {
namespace {

// Rows of k tasks as Python has them.
class GivenTasks {
 public:
  GivenTasks(nb::handle jacobian, nb::handle starts, nb::handle alpha)
      : jacobian_(jacobian, 2), alpha_(alpha, 2) {
    starts_.take(starts, 1);
    const Index k = alpha_.rows(), m = jacobian_.rows();
    bool ordered = alpha_.cols() == k && starts_.size() == k + 1;
    for (Index i = 0; ordered && i <= k; ++i) {
      const std::int64_t least = i ? starts_.data()[i - 1] : 0;
      ordered = starts_.data()[i] >= least && starts_.data()[i] <= m;
    }
    fits(ordered, "J (m, d), the first rows (k + 1,) and priorities (k, k) expected");
  }

  TaskRows tasks() const { return {jacobian_.matrix(), starts_.data(), alpha_.matrix()}; }
  Index count() const { return alpha_.rows(); }
  Index d() const { return jacobian_.cols(); }

  // Write the projectors (k, d, d).
  void project(double rank_tolerance, double damping, double* out) const {
    write_projectors(tasks(), {rank_tolerance, damping}, out);
  }

 private:
  In jacobian_, alpha_;
  Buffer<std::int64_t> starts_;
};

ConstVector targets_of(const In& target, const GivenTasks& given) {
  fits(target.entries() == given.tasks().jacobian.rows(), "a target (m,) expected");
  return target.vector();
}

nb::object projectors(nb::handle J, nb::handle starts, nb::handle alpha, double rank_tolerance,
                      double damping) {
  const GivenTasks given(J, starts, alpha);
  const NewArray made(given.count(), given.d(), given.d());
  given.project(rank_tolerance, damping, made.data());
  return made.object();
}

nb::tuple target_of_ghc(nb::handle J, nb::handle b, nb::handle starts, nb::handle alpha, double w,
                        double rank_tolerance, double damping) {
  const GivenTasks given(J, starts, alpha);
  const In target(b, 1);
  const NewArray projectors(given.count(), given.d(), given.d()), x0(given.d());
  given.project(rank_tolerance, damping, projectors.data());
  ghc_target(given.tasks(), targets_of(target, given), projectors.data(), w, x0.vector());
  return nb::make_tuple(x0.object(), projectors.object());
}

nb::object factor_of_ghc(nb::handle J, nb::handle starts, nb::handle alpha, nb::handle projectors,
                         double w, double damping) {
  const GivenTasks given(J, starts, alpha);
  const In P(projectors, 3);
  fits(P.entries() == given.count() * given.d() * given.d(), "projectors (k, d, d) expected");
  Matrix factor;
  ghc_factor(given.tasks(), P.data(), w, damping == 0.0, factor);
  const NewArray made(given.d(), given.d());
  made.matrix() = factor;
  return made.object();
}

nb::tuple system_of_balanced(nb::handle J, nb::handle starts, nb::handle alpha, double w,
                             double rank_tolerance, double damping) {
  const GivenTasks given(J, starts, alpha);
  const NewArray projectors(given.count(), given.d(), given.d()), system(given.d(), given.d());
  given.project(rank_tolerance, damping, projectors.data());
  balanced_system(given.tasks(), projectors.data(), w, system.matrix());
  return nb::make_tuple(system.object(), projectors.object());
}

nb::tuple target_of_balanced(nb::handle J, nb::handle b, nb::handle starts, nb::handle alpha,
                             double w, double rank_tolerance, double damping, double guard) {
  const GivenTasks given(J, starts, alpha);
  const In target(b, 1);
  Vector projectors(given.count() * given.d() * given.d());
  given.project(rank_tolerance, damping, projectors.data());
  const NewArray x(given.d());
  const double sigma = balanced_target(given.tasks(), targets_of(target, given),
                                       projectors.data(), w, guard, x.vector());
  return nb::make_tuple(x.object(), sigma);
}

nb::object weights_of(nb::handle alpha, double ratio, double spread) {
  const In given(alpha, 2);
  fits(given.rows() == given.cols(), "priorities (k, k) expected");
  const NewArray weights(given.rows());
  priority_weights(given.matrix(), ratio, spread, weights.vector());
  return weights.object();
}

nb::tuple system_of_weighted(nb::handle J, nb::handle b, nb::handle starts, nb::handle alpha,
                             double ratio, double spread, double damping) {
  const GivenTasks given(J, starts, alpha);
  const In target(b, 1);
  Vector weights(given.count());
  priority_weights(given.tasks().alpha, ratio, spread, weights);
  const NewArray hessian(given.d(), given.d()), right(given.d());
  weighted_system(given.tasks(), targets_of(target, given), weights, damping, hessian.matrix(),
                  right.vector());
  return nb::make_tuple(hessian.object(), right.object());
}

nb::object cholesky_of(nb::handle matrix) {
  const In given(matrix, 2);
  fits(given.rows() == given.cols(), "a matrix (d, d) expected");
  Matrix lower;
  cholesky(given.matrix(), lower);
  const NewArray made(given.rows(), given.rows());
  made.matrix() = lower;
  return made.object();
}

nb::object inverse_factor_of(nb::handle matrix) {
  const In given(matrix, 2);
  fits(given.rows() == given.cols(), "a matrix (d, d) expected");
  const NewArray made(given.rows(), given.rows());
  inverse_factor(given.matrix(), made.matrix());
  return made.object();
}

}  // namespace

void bind_formulations(nb::module_& m) {
  m.def("generalized_projectors", &projectors);
  m.def("ghc_target", &target_of_ghc);
  m.def("ghc_factor", &factor_of_ghc);
  m.def("balanced_system", &system_of_balanced);
  m.def("balanced_target", &target_of_balanced);
  m.def("priority_weights", &weights_of);
  m.def("weighted_system", &system_of_weighted);
  m.def("cholesky", &cholesky_of);
  m.def("inverse_factor", &inverse_factor_of);
}

}  // namespace ghc::python
