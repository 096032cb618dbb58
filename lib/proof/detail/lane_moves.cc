#include <algorithm>
#include <array>

#include "proof/detail/lane_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proof/detail/lane_moves.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "proof/detail/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::proof {
namespace HWY_NAMESPACE {
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.

constexpr std::size_t kAll = (kOrder + 1) * (kOrder + 1);  // pairs (n, m), -n <= m <= n
constexpr std::size_t allOf(int n, int m) { return static_cast<std::size_t>(n * (n + 1) + m); }

constexpr std::array<double, kTerms> kDivisors = [] {
  std::array<double, kTerms> out{};
  for (int n = 0; n <= kOrder; ++n)
    for (int m = 0; m <= n; ++m) out[termOf(n, m)] = 1.0 / ((n + 1) * (n + 1) - m * m);
  return out;
}();

// conj(R_nm(x)) for all m, up to degree `order`.
HWY_INLINE void ConjugateRegular(V x, V y, V z, int order, Complex* HWY_RESTRICT out) {
  const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
  Complex diagonal{Number(1), hn::Zero(D())};
  for (int m = 0; m <= order; ++m) {
    Complex before{hn::Zero(D()), hn::Zero(D())}, now = diagonal;
    const V sign = Number(m % 2 ? -1 : 1);
    for (int n = m; n <= order; ++n) {
      out[allOf(n, -m)] = {sign * now.re, hn::Neg(sign * now.im)};
      out[allOf(n, m)] = now;
      const V divisor = Number(kDivisors[termOf(n, m)]);
      const V up = Number(2.0 * n + 1) * z;
      const Complex next{divisor * hn::NegMulAdd(square, before.re, up * now.re),
                         divisor * hn::NegMulAdd(square, before.im, up * now.im)};
      before = now;
      now = next;
    }
    // Conjugates all through: x - i y.
    const V factor = Number(1 / (2.0 * m + 2));
    diagonal = {factor * hn::MulAdd(y, diagonal.im, x * diagonal.re),
                factor * hn::NegMulAdd(y, diagonal.re, x * diagonal.im)};
  }
}

// Coefficients of all m, up to degree `order`: kAll x kStride.
template <std::size_t kStride>
void CoefficientsOfAll(const double* HWY_RESTRICT coefficients, int order,
                       double* HWY_RESTRICT out) {
  for (int n = 0; n <= order; ++n)
    for (int m = 0; m <= n; ++m) {
      const double sign = m % 2 ? -1 : 1;
      const double* const from = coefficients + 6 * termOf(n, m);
      double* const minus = out + kStride * allOf(n, -m);
      double* const plus = out + kStride * allOf(n, m);
      for (int k = 0; k < 3; ++k) {
        minus[2 * k] = sign * from[2 * k];
        minus[2 * k + 1] = -sign * from[2 * k + 1];
        plus[2 * k] = from[2 * k];
        plus[2 * k + 1] = from[2 * k + 1];
      }
    }
}

// L'_ji = sum over n >= j and m of L_nm conj(R_(n-j)(m-i)(shift)).
HWY_INLINE void MoveTerm(int j, int i, int order, const double* HWY_RESTRICT from,
                         const Complex* HWY_RESTRICT regular, double* HWY_RESTRICT out) {
  const D d;
  V re[3], im[3];
  for (int k = 0; k < 3; ++k) re[k] = im[k] = hn::Zero(d);
  for (int k = 0; k <= order - j; ++k)
    for (int l = -k; l <= k; ++l) {
      const Complex r = regular[allOf(k, l)];
      const double* const c = from + 6 * allOf(j + k, i + l);
      for (int channel = 0; channel < 3; ++channel) {
        const V a = Number(c[2 * channel]), b = Number(c[2 * channel + 1]);
        re[channel] = hn::NegMulAdd(b, r.im, hn::MulAdd(a, r.re, re[channel]));
        im[channel] = hn::MulAdd(b, r.re, hn::MulAdd(a, r.im, im[channel]));
      }
    }
  for (int k = 0; k < 3; ++k) {
    hn::Store(re[k], d, out + 2 * k * kLanes);
    hn::Store(im[k], d, out + (2 * k + 1) * kLanes);
  }
}

void MoveExpansion(const StepExpansion& from, int order, const LaneSets& sets,
                   double* HWY_RESTRICT coefficients) {
  const D d;
  double all[6 * kAll];
  CoefficientsOfAll<6>(from.coefficients.data(), order, all);
  Complex regular[kAll];
  for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
    ConjugateRegular(hn::Load(d, sets.center[0] + lane) - Number(from.center.x),
                     hn::Load(d, sets.center[1] + lane) - Number(from.center.y),
                     hn::Load(d, sets.center[2] + lane) - Number(from.center.z), order, regular);
    for (int j = 0; j <= order; ++j)
      for (int i = 0; i <= j; ++i)
        MoveTerm(j, i, order, all, regular, coefficients + 6 * termOf(j, i) * kLanes + lane);
  }
  for (std::size_t c = 6 * termOf(order + 1, 0) * kLanes; c < kCoefficients * kLanes;
       c += hn::Lanes(d))
    hn::Store(hn::Zero(d), d, coefficients + c);
}

// The six numbers of a coefficient stand side by side in lanes. `turned` are those of i times it.
HWY_INLINE void MoveSix(int j, int i, int order, const double* HWY_RESTRICT from,
                        const double* HWY_RESTRICT turned, const Complex* HWY_RESTRICT regular,
                        std::size_t lane, double* HWY_RESTRICT out) {
  const D d;
  V sums[2][2];  // rows of odd and even degree apart: they need not wait for one another
  for (auto& row : sums)
    for (V& sum : row) sum = hn::Zero(d);
  for (int k = 0; k <= order - j; ++k) {
    V plain = sums[k % 2][0], other = sums[k % 2][1];
    for (int l = -k; l <= k; ++l) {
      const Complex r = regular[allOf(k, l)];
      const std::size_t c = kLanes * allOf(j + k, i + l) + lane;
      plain = hn::MulAdd(r.re, hn::Load(d, from + c), plain);
      other = hn::MulAdd(r.im, hn::Load(d, turned + c), other);
    }
    sums[k % 2][0] = plain;
    sums[k % 2][1] = other;
  }
  hn::Store((sums[0][0] + sums[0][1]) + (sums[1][0] + sums[1][1]), d, out + lane);
}

void MoveToOne(const StepExpansion& from, int order, const Vec3& center,
               double* HWY_RESTRICT coefficients) {
  alignas(64) double all[kLanes * kAll], turned[kLanes * kAll];
  const std::size_t used = kLanes * allOf(order + 1, -order - 1);
  std::fill_n(all, used, 0.0);
  CoefficientsOfAll<kLanes>(from.coefficients.data(), order, all);
  for (std::size_t c = 0; c < used; c += 2) {
    turned[c] = -all[c + 1];
    turned[c + 1] = all[c];
  }
  Complex regular[kAll];
  ConjugateRegular(Number(center.x - from.center.x), Number(center.y - from.center.y),
                   Number(center.z - from.center.z), order, regular);
  for (int j = 0; j <= order; ++j)
    for (int i = 0; i <= j; ++i) {
      alignas(64) double six[kLanes];
      for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(D()))
        MoveSix(j, i, order, all, turned, regular, lane, six);
      std::copy_n(six, 6, coefficients + 6 * termOf(j, i));
    }
  std::fill(coefficients + 6 * termOf(order + 1, 0), coefficients + kCoefficients, 0.0);
}

// NOLINTEND(readability-identifier-naming)
}  // namespace HWY_NAMESPACE
}  // namespace innermap::proof
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::proof {

HWY_EXPORT(MoveExpansion);
HWY_EXPORT(MoveToOne);

void moveExpansion(const StepExpansion& from, int order, const LaneSets& sets,
                   double* coefficients) {
  HWY_DYNAMIC_DISPATCH(MoveExpansion)(from, order, sets, coefficients);
}

void moveExpansion(const StepExpansion& from, int order, const Vec3& center, double* coefficients) {
  HWY_DYNAMIC_DISPATCH(MoveToOne)(from, order, center, coefficients);
}

}  // namespace innermap::proof
#endif
