#include "row_kernels.hpp"

#include <cstring>

#define GHC_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__)
#define GHC_WIDE __attribute__((target("avx2")))
#endif

namespace ghc {
namespace {

using Two = double __attribute__((vector_size(16)));   // the registers of any processor
using Four = double __attribute__((vector_size(32)));  // those of AVX2

// Four numbers as two registers, or as one.
struct Narrow {
  Two low, high;
};
struct Wide {
  Four all;
};

GHC_INLINE void load(const double* from, Two& out) { std::memcpy(&out, from, sizeof out); }
GHC_INLINE void load(const double* from, Narrow& out) {
  load(from, out.low), load(from + 2, out.high);
}
GHC_INLINE void load(const double* from, Wide& out) { std::memcpy(&out.all, from, 32); }
GHC_INLINE void store(const Two& value, double* to) { std::memcpy(to, &value, sizeof value); }
GHC_INLINE void store(const Narrow& value, double* to) {
  store(value.low, to), store(value.high, to + 2);
}
GHC_INLINE void store(const Wide& value, double* to) { std::memcpy(to, &value.all, 32); }
GHC_INLINE void add_product(const Narrow& a, const Narrow& b, Narrow& sum) {
  sum.low += a.low * b.low, sum.high += a.high * b.high;
}
GHC_INLINE void add_product(const Wide& a, const Wide& b, Wide& sum) { sum.all += a.all * b.all; }
GHC_INLINE void add_scaled(const Narrow& a, double b, Narrow& sum) {
  sum.low += a.low * b, sum.high += a.high * b;
}
GHC_INLINE void add_scaled(const Wide& a, double b, Wide& sum) { sum.all += a.all * b; }
GHC_INLINE void halves(const Narrow& sum, Two& low, Two& high) { low = sum.low, high = sum.high; }
GHC_INLINE void halves(const Wide& sum, Two& low, Two& high) {
  low = Two{sum.all[0], sum.all[1]}, high = Two{sum.all[2], sum.all[3]};
}

template <typename Lanes, int R>
GHC_INLINE void dot(const double* rows, Index stride, const double* x, Index d, double* out) {
  Lanes sum[R] = {};
  Index c = 0;
  for (; c + 4 <= d; c += 4) {
    Lanes of_x;
    load(x + c, of_x);
    for (int r = 0; r < R; ++r) {
      Lanes of_row;
      load(rows + r * stride + c, of_row);
      add_product(of_row, of_x, sum[r]);
    }
  }
  for (int r = 0; r < R; ++r) {
    const double* row = rows + r * stride;
    Two low, high;
    halves(sum[r], low, high);
    low += high;
    Index k = c;
    if (k + 2 <= d) {
      Two of_row, of_x;
      load(row + k, of_row), load(x + k, of_x);
      low += of_row * of_x;
      k += 2;
    }
    double whole = low[0] + low[1];
    if (k < d) whole += row[k] * x[k];
    out[r] = whole;
  }
}

template <typename Lanes, int R>
GHC_INLINE void add(const double* rows, Index stride, const double* weights, double sign, Index d,
                    double* out) {
  double weight[R];
  for (int r = 0; r < R; ++r) weight[r] = sign * weights[r];
  Index c = 0;
  for (; c + 4 <= d; c += 4) {
    Lanes sum;
    load(out + c, sum);
    for (int r = 0; r < R; ++r) {
      Lanes of_row;
      load(rows + r * stride + c, of_row);
      add_scaled(of_row, weight[r], sum);
    }
    store(sum, out + c);
  }
  if (c + 2 <= d) {
    Two sum;
    load(out + c, sum);
    for (int r = 0; r < R; ++r) {
      Two of_row;
      load(rows + r * stride + c, of_row);
      sum += of_row * weight[r];
    }
    store(sum, out + c);
    c += 2;
  }
  if (c == d) return;
  double last = out[c];
  for (int r = 0; r < R; ++r) last += rows[r * stride + c] * weight[r];
  out[c] = last;
}

template <typename Lanes>
GHC_INLINE void dot_all(const double* rows, Index stride, Index m, const double* x, Index d,
                        double* out) {
  for (; m >= 4; m -= 4, rows += 4 * stride, out += 4) dot<Lanes, 4>(rows, stride, x, d, out);
  if (m == 3) dot<Lanes, 3>(rows, stride, x, d, out);
  if (m == 2) dot<Lanes, 2>(rows, stride, x, d, out);
  if (m == 1) dot<Lanes, 1>(rows, stride, x, d, out);
}

template <typename Lanes>
GHC_INLINE void add_all(const double* rows, Index stride, Index m, const double* weights,
                        double sign, Index d, double* out) {
  for (; m >= 4; m -= 4, rows += 4 * stride, weights += 4) {
    add<Lanes, 4>(rows, stride, weights, sign, d, out);
  }
  if (m == 3) add<Lanes, 3>(rows, stride, weights, sign, d, out);
  if (m == 2) add<Lanes, 2>(rows, stride, weights, sign, d, out);
  if (m == 1) add<Lanes, 1>(rows, stride, weights, sign, d, out);
}

constexpr Index kArm = 7;  // numbers of a row for which loops are unrolled: the joints of most arms

#ifdef GHC_WIDE
constexpr Index kWide = 16;  // numbers of a row from which on wider registers pay
const bool has_avx2 = __builtin_cpu_supports("avx2");

GHC_WIDE void dot_wide(const double* rows, Index stride, Index m, const double* x, Index d,
                       double* out) {
  dot_all<Wide>(rows, stride, m, x, d, out);
}

GHC_WIDE void add_wide(const double* rows, Index stride, Index m, const double* weights,
                       double sign, Index d, double* out) {
  add_all<Wide>(rows, stride, m, weights, sign, d, out);
}
#endif

}  // namespace

void dot_rows(const double* rows, Index stride, Index m, const double* x, Index d, double* out) {
#ifdef GHC_WIDE
  if (d >= kWide && has_avx2) return dot_wide(rows, stride, m, x, d, out);
#endif
  if (d == kArm) return dot_all<Narrow>(rows, stride, m, x, kArm, out);
  dot_all<Narrow>(rows, stride, m, x, d, out);
}

void add_weighted(const double* rows, Index stride, Index m, const double* weights, double sign,
                  Index d, double* out) {
#ifdef GHC_WIDE
  if (d >= kWide && has_avx2) return add_wide(rows, stride, m, weights, sign, d, out);
#endif
  if (d == kArm) return add_all<Narrow>(rows, stride, m, weights, sign, kArm, out);
  add_all<Narrow>(rows, stride, m, weights, sign, d, out);
}

}  // namespace ghc
