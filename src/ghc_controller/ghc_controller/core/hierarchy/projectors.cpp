#include "projectors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "small_factors.hpp"

namespace ghc {
namespace {

constexpr double kNoLength = 1e-12;

// Tasks by descending priority over one task; of a tie the more dominant comes first. Ties carry
// one weight, so their order is free: taking it from the whole matrix makes the rows of a strict
// hierarchy begin alike, and they share one basis.
template <typename Row>
void descending_order(const Row& alpha, const Vector& dominance, std::vector<Index>& order) {
  std::iota(order.begin(), order.end(), Index{0});
  for (size_t a = 1; a < order.size(); ++a) {
    const Index current = order[a];
    size_t b = a;
    for (; b > 0; --b) {
      const Index before = order[b - 1];
      if (!(alpha[before] < alpha[current] ||
            (alpha[before] == alpha[current] && dominance[before] < dominance[current]))) {
        break;
      }
      order[b] = before;
    }
    order[b] = current;
  }
}

// The directions that rows span, one after the other; those of the first tasks can be kept.
class Basis {
 public:
  Basis(Index d, Index rows) : basis_(std::max(d, rows), d), share_(std::max(d, rows)) {}

  Index rank = 0;

  auto rows() const { return basis_.topRows(rank); }

  // Append what rows (m, d) add, orthonormal.
  template <typename Rows>
  void add_exact(const Rows& rows, double rank_tolerance) {
    const Index d = basis_.cols();
    for (Index r = 0; r < rows.rows() && rank < d; ++r) {
      auto direction = basis_.row(rank);
      direction = rows.row(r);
      const double before = direction.norm();
      for (int pass = 0; pass < 2; ++pass) {  // the second removes the rounding of the first
        auto share = share_.head(rank);
        share.noalias() = basis_.topRows(rank) * direction.transpose();
        direction.noalias() -= share.transpose() * basis_.topRows(rank);
      }
      const double left = direction.norm();
      if (left > rank_tolerance * before && left > kNoLength) {
        direction /= left;
        ++rank;
      }
    }
  }

  // Append rows of L^-1 J. A row longer than 1 is damped in proportion, so that rounding never
  // outweighs the damping e.
  template <typename Rows>
  void add_damped(const Rows& rows, double e) {
    for (Index r = 0; r < rows.rows(); ++r) {
      const auto given = rows.row(r);
      auto share = share_.head(rank);
      share.noalias() = basis_.topRows(rank) * given.transpose();
      auto row = basis_.row(rank);
      row = given;
      row.noalias() -= share.transpose() * basis_.topRows(rank);
      const double pivot = e * e * std::max(1.0, given.squaredNorm()) + given.dot(row);
      row /= std::sqrt(std::max(pivot, e * e));
      ++rank;
    }
  }

 private:
  Matrix basis_;
  Vector share_;
};

}  // namespace

void write_projectors(const TaskRows& tasks, const ProjectorRule& rule, double* out) {
  const Index k = tasks.count(), d = tasks.jacobian.cols();
  const size_t count = static_cast<size_t>(k);
  const Vector dominance = tasks.alpha.colwise().sum().transpose();
  std::vector<char> completes(count, 0);
  Vector values;
  for (Index i = 0; i < k && rule.damping == 0.0; ++i) {
    completes[i] = tasks.rows(i).rows() == d && selected_values(tasks.rows(i), values);
  }
  Basis basis(d, tasks.jacobian.rows());
  std::vector<Index> order(count), chain(count), rank_after(count + 1, 0);
  Matrix weighted;
  Index length = 0;  // of the chain of tasks whose directions are in the basis
  for (Index i = 0; i < k; ++i) {
    const auto alpha = tasks.alpha.row(i);
    descending_order(alpha, dominance, order);
    Index above = 0;
    while (above < k && alpha[order[above]] > 0.0) {
      ++above;
      if (completes[order[above - 1]]) break;
    }
    Index shared = 0;
    while (shared < std::min(length, above) && chain[shared] == order[shared]) ++shared;
    for (Index position = shared; position < above; ++position) {
      const Index task = order[position];
      basis.rank = rank_after[position];
      if (rule.damping > 0.0) {
        basis.add_damped(tasks.rows(task), rule.damping);
      } else if (!completes[task]) {
        basis.add_exact(tasks.rows(task), rule.rank_tolerance);
      }
      rank_after[position + 1] = basis.rank;
      chain[position] = task;
      length = position + 1;
    }
    // Weight of the directions that are not in the basis.
    const bool whole = above > 0 && completes[order[above - 1]];
    const double rest = whole ? alpha[order[above - 1]] : 0.0;
    Eigen::Map<Matrix> P(out + i * d * d, d, d);
    P.setZero();
    P.diagonal().setConstant(1.0 - rest);
    basis.rank = rank_after[above];
    if (basis.rank == 0) continue;
    weighted = basis.rows();
    for (Index position = 0; position < above; ++position) {
      const Index first = rank_after[position];
      weighted.middleRows(first, rank_after[position + 1] - first) *=
          alpha[order[position]] - rest;
    }
    P.triangularView<Eigen::Lower>() -= weighted.transpose() * basis.rows();
    P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
  }
}

}  // namespace ghc
