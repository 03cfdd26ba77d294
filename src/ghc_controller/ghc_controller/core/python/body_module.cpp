// The Python face of the distances between bodies.
#include "body_pairs.hpp"
#include "build_modules.hpp"
#include "model.hpp"
#include "views.hpp"

namespace ghc::python {
namespace {

using Numbers = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using NumberPairs = nb::ndarray<const std::int64_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// A new NumPy array with entries to be written.
template <typename Value>
std::pair<Value*, nb::object> fresh(std::initializer_list<size_t> shape) {
  size_t size = 1;
  for (const size_t axis : shape) size *= axis;
  auto* memory = new Value[size]();
  nb::capsule owner(memory, [](void* kept) noexcept { delete[] static_cast<Value*>(kept); });
  return {memory, nb::cast(nb::ndarray<Value, nb::numpy, nb::c_contig>(memory, shape, owner))};
}

void make_pairs(BodyPairs* self, const Numbers& frames, const In2& centers, const In2& axes,
          const In1& radii, const NumberPairs& pairs) {
  const size_t count = frames.size();
  expect(centers.shape(0) == count && centers.shape(1) == 3 && axes.shape(0) == count &&
             axes.shape(1) == 9 && radii.size() == count && pairs.shape(1) == 2,
         "frames (e,), centers (e, 3), axes (e, 9), radii (e,) and pairs (p, 2) expected");
  std::vector<BodyShape> shapes;
  for (size_t k = 0; k < count; ++k) {
    using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    shapes.push_back({frames.data()[k], Eigen::Map<const Vector3>(centers.data() + 3 * k),
                      Eigen::Map<const Rows>(axes.data() + 9 * k), radii.data()[k]});
  }
  std::vector<std::pair<Index, Index>> found;
  for (size_t p = 0; p < pairs.shape(0); ++p) {
    found.emplace_back(pairs.data()[2 * p], pairs.data()[2 * p + 1]);
    const auto inside = [count](Index k) { return k >= 0 && k < static_cast<Index>(count); };
    expect(inside(found.back().first) && inside(found.back().second), "pairs of shapes expected");
  }
  new (self) BodyPairs(std::move(shapes), std::move(found));
}

void check_frames(const BodyPairs& self, const Model& model) {
  expect(self.most_frame() < model.frames.count(), "a model with the frames of all shapes expected");
}

nb::tuple near_pairs(BodyPairs& self, const Model& model, double within) {
  check_frames(self, model);
  const auto& found = self.near(model.frames, within);
  auto [pairs, pair_array] = fresh<std::int64_t>({found.size()});
  auto [distances, distance_array] = fresh<double>({found.size()});
  auto [places, place_array] = fresh<double>({found.size(), 6});
  for (size_t k = 0; k < found.size(); ++k) {
    pairs[k] = found[k].pair;
    distances[k] = found[k].distance;
    std::copy(found[k].u, found[k].u + 6, places + 6 * k);
  }
  return nb::make_tuple(pair_array, distance_array, place_array);
}

nb::tuple pair_motion(const BodyPairs& self, const Model& model, const Numbers& pairs,
                 const In1& distances, const In2& places) {
  check_frames(self, model);
  const size_t count = pairs.size(), n = static_cast<size_t>(model.tree.nv());
  expect(distances.size() == count && places.shape(0) == count && places.shape(1) == 6,
         "pairs (k,), distances (k,) and places (k, 6) expected");
  auto [rates, rate_array] = fresh<double>({count});
  auto [rows, row_array] = fresh<double>({count, n});
  auto [drifts, drift_array] = fresh<double>({count});
  for (size_t k = 0; k < count; ++k) {
    NearPair one{pairs.data()[k], distances.data()[k], {}};
    expect(one.pair >= 0 && one.pair < self.pairs(), "numbers of pairs expected");
    std::copy(places.data() + 6 * k, places.data() + 6 * k + 6, one.u);
    const DistanceMotion found = self.motion(model.frames, one, rows + n * k);
    rates[k] = found.rate;
    drifts[k] = found.drift;
  }
  return nb::make_tuple(rate_array, row_array, drift_array);
}

}  // namespace

void bind_bodies(nb::module_& m) {
  nb::class_<BodyPairs>(m, "BodyPairs")
      .def("__init__", &make_pairs)
      .def("near", &near_pairs)
      .def("motion", &pair_motion);
}

}  // namespace ghc::python
