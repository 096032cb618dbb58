#include "proof/detail/lane_kernels.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proof/detail/lane_kernels.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::proof {
namespace HWY_NAMESPACE {
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.

namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_SCALAR
using D = hn::ScalableTag<double>;
#else
using D = hn::CappedTag<double, kLanes>;
#endif
using V = hn::Vec<D>;

HWY_INLINE V Number(double x) { return hn::Set(D(), x); }

HWY_INLINE hn::Mask<D> MaskOf(std::uint8_t bits, std::size_t lane) {
  const std::uint8_t all[8] = {static_cast<std::uint8_t>(bits >> lane)};
  return hn::LoadMaskBits(D(), all);
}

void Classify(const double* HWY_RESTRICT charges, const std::uint32_t* HWY_RESTRICT list,
              std::size_t count, const LaneSets& sets, double farRatio,
              std::uint8_t* HWY_RESTRICT farLanes, LaneRemainders& far, LaneRemainders& near) {
  const D d;
  const V one = Number(1), infinite = Number(std::numeric_limits<double>::infinity());
  std::fill_n(farLanes, count, std::uint8_t{0});
  for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
    const V cx = hn::Load(d, sets.center[0] + lane), cy = hn::Load(d, sets.center[1] + lane),
            cz = hn::Load(d, sets.center[2] + lane), radius = hn::Load(d, sets.radius + lane);
    V sums[2][4];
    for (auto& lot : sums)
      for (V& sum : lot) sum = hn::Zero(d);
    for (std::size_t i = 0; i < count; ++i) {
      const double* q = charges + kChargeStride * list[i];
      const V x = Number(q[0]) - cx, y = Number(q[1]) - cy, z = Number(q[2]) - cz;
      const V distance = hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, z * z)));
      const V inverse = one / distance, ratio = radius * inverse;
      const auto isFar = hn::Le(ratio, Number(farRatio));
      const auto known = hn::Le(ratio, Number(kNearRatio));
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, isFar, bits);
      farLanes[i] = static_cast<std::uint8_t>(farLanes[i] | (bits[0] << lane));
      V power = ratio;  // ratio^kOrder
      for (int n = 1; n < kOrder; ++n) power = power * ratio;
      const V spread = one / (one - ratio);  // sum of ratio^n
      const V value = Number(q[6]) * inverse * spread, gradient = value * inverse * spread;
      const V cutValue = value * power * ratio;
      const V cut = gradient * power * hn::NegMulAdd(Number(kOrder), ratio, Number(kOrder + 1));
      const V terms[4] = {cut, cutValue, gradient, value};
      for (int k = 0; k < 4; ++k) {
        const V term = hn::IfThenElse(known, terms[k], infinite);
        sums[0][k] = sums[0][k] + hn::IfThenElseZero(isFar, term);
        sums[1][k] = sums[1][k] + hn::IfThenZeroElse(isFar, term);
      }
    }
    LaneRemainders* const lots[2] = {&far, &near};
    for (int lot = 0; lot < 2; ++lot) {
      hn::Store(sums[lot][0], d, lots[lot]->gradient + lane);
      hn::Store(sums[lot][1], d, lots[lot]->value + lane);
      hn::Store(sums[lot][2], d, lots[lot]->gradientMagnitude + lane);
      hn::Store(sums[lot][3], d, lots[lot]->valueMagnitude + lane);
    }
  }
}

struct Complex {
  V re, im;
};

// I_nm(q) = (n - m)! P_n^m(cos theta) e^(i m phi) / r^(n+1), so that 1/|x - q| is the sum of
// I_nm(q) conj(R_nm(x)). 0 outside the mask.
HWY_INLINE void Irregular(V x, V y, V z, hn::Mask<D> mask, Complex* HWY_RESTRICT out) {
  const D d;
  const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
  const V inverse = Number(1) / hn::IfThenElse(mask, square, Number(1));
  x = hn::IfThenElseZero(mask, x * inverse);
  y = hn::IfThenElseZero(mask, y * inverse);
  z = hn::IfThenElseZero(mask, z * inverse);
  Complex diagonal{hn::IfThenElseZero(mask, hn::Sqrt(inverse)), hn::Zero(d)};
  for (int m = 0; m <= kOrder; ++m) {
    Complex before{hn::Zero(d), hn::Zero(d)}, now = diagonal;
    out[termOf(m, m)] = now;
    for (int n = m; n < kOrder; ++n) {
      const V up = Number(2.0 * n + 1) * z, down = Number(1.0 * n * n - 1.0 * m * m) * inverse;
      const Complex next{hn::NegMulAdd(down, before.re, up * now.re),
                         hn::NegMulAdd(down, before.im, up * now.im)};
      before = now;
      now = next;
      out[termOf(n + 1, m)] = now;
    }
    const V factor = Number(2.0 * m + 1);
    diagonal = {factor * hn::NegMulAdd(y, diagonal.im, x * diagonal.re),
                factor * hn::MulAdd(y, diagonal.re, x * diagonal.im)};
  }
}

// Charges at once: the sums are read and written once for all of them.
constexpr std::size_t kBlock = 4;

struct ChargeBlock {
  const double* charge[kBlock];
  std::uint8_t lanes[kBlock];
};

HWY_INLINE void AddBlock(const ChargeBlock& block, std::size_t lane, const LaneSets& sets,
                         Complex (*HWY_RESTRICT harmonics)[kTerms],
                         double* HWY_RESTRICT coefficients) {
  const D d;
  V weights[kBlock][3];
  for (std::size_t b = 0; b < kBlock; ++b) {
    const double* q = block.charge[b];
    const V x = Number(q[0]) - hn::Load(d, sets.center[0] + lane);
    const V y = Number(q[1]) - hn::Load(d, sets.center[1] + lane);
    const V z = Number(q[2]) - hn::Load(d, sets.center[2] + lane);
    Irregular(x, y, z, MaskOf(block.lanes[b], lane), harmonics[b]);
    for (int k = 0; k < 3; ++k) weights[b][k] = Number(q[3 + k]);
  }
  for (std::size_t t = 0; t < kTerms; ++t) {
    for (int k = 0; k < 3; ++k) {
      double* const out = coefficients + (6 * t + 2 * k) * kLanes + lane;
      V re = hn::Load(d, out), im = hn::Load(d, out + kLanes);
      for (std::size_t b = 0; b < kBlock; ++b) {
        re = hn::MulAdd(weights[b][k], harmonics[b][t].re, re);
        im = hn::MulAdd(weights[b][k], harmonics[b][t].im, im);
      }
      hn::Store(re, d, out);
      hn::Store(im, d, out + kLanes);
    }
  }
}

void AddCharges(const double* HWY_RESTRICT charges, const std::uint32_t* HWY_RESTRICT list,
                const std::uint8_t* HWY_RESTRICT lanes, std::uint8_t flip, std::size_t count,
                const LaneSets& sets, double* HWY_RESTRICT coefficients) {
  Complex harmonics[kBlock][kTerms];
  std::size_t i = 0;
  while (i < count) {
    ChargeBlock block{};
    std::size_t filled = 0;
    for (; i < count && filled < kBlock; ++i) {
      const std::uint8_t used = lanes[i] ^ flip;
      if (used == 0) continue;
      block.charge[filled] = charges + kChargeStride * list[i];
      block.lanes[filled++] = used;
    }
    if (filled == 0) break;
    for (std::size_t b = filled; b < kBlock; ++b) block.charge[b] = block.charge[0];
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(D()))
      AddBlock(block, lane, sets, harmonics, coefficients);
  }
}

// Eight charges, one a lane, about the origin: coordinates and weights.
struct alignas(64) ChargeLanes {
  Lanes place[3], weight[3];
};

HWY_INLINE void AddLanes(const ChargeLanes& q, std::size_t lane, Complex* HWY_RESTRICT harmonics,
                         double* HWY_RESTRICT sums) {
  const D d;
  const V x = hn::Load(d, q.place[0] + lane);
  Irregular(x, hn::Load(d, q.place[1] + lane), hn::Load(d, q.place[2] + lane), hn::Eq(x, x),
            harmonics);
  for (int k = 0; k < 3; ++k) {
    const V weight = hn::Load(d, q.weight[k] + lane);
    double* out = sums + 2 * k * kLanes + lane;
    for (std::size_t t = 0; t < kTerms; ++t, out += 6 * kLanes) {
      hn::Store(hn::MulAdd(weight, harmonics[t].re, hn::Load(d, out)), d, out);
      hn::Store(hn::MulAdd(weight, harmonics[t].im, hn::Load(d, out + kLanes)), d, out + kLanes);
    }
  }
}

void AddAboutOne(const double* HWY_RESTRICT charges, const std::uint32_t* HWY_RESTRICT list,
                 std::size_t count, StepExpansion& expansion) {
  alignas(64) double sums[kCoefficients * kLanes] = {};
  Complex harmonics[kTerms];
  for (std::size_t i = 0; i < count; i += kLanes) {
    ChargeLanes q{};
    for (std::size_t l = 0; l < kLanes; ++l) {
      const bool real = i + l < count;
      const double* const charge = charges + kChargeStride * list[real ? i + l : i];
      for (int a = 0; a < 3; ++a) {
        q.place[a][l] = charge[a] - expansion.center[a];
        q.weight[a][l] = real ? charge[3 + a] : 0;
      }
    }
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(D()))
      AddLanes(q, lane, harmonics, sums);
  }
  for (std::size_t c = 0; c < kCoefficients; ++c)
    for (std::size_t l = 0; l < kLanes; ++l) expansion.coefficients[c] += sums[c * kLanes + l];
}

constexpr std::size_t kAll = (kOrder + 1) * (kOrder + 1);  // pairs (n, m), -n <= m <= n
constexpr std::size_t allOf(int n, int m) { return static_cast<std::size_t>(n * (n + 1) + m); }

// conj(R_nm(x)) for all m: kAll.
HWY_INLINE void ConjugateRegular(V x, V y, V z, Complex* HWY_RESTRICT out) {
  const D d;
  const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
  Complex diagonal{Number(1), hn::Zero(d)};
  for (int m = 0; m <= kOrder; ++m) {
    Complex before{hn::Zero(d), hn::Zero(d)}, now = diagonal;
    for (int n = m; n <= kOrder; ++n) {
      out[allOf(n, m)] = now;
      const V divisor = Number(1 / ((n + 1.0) * (n + 1.0) - 1.0 * m * m));
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
  for (int n = 1; n <= kOrder; ++n)
    for (int m = 1; m <= n; ++m) {
      const Complex c = out[allOf(n, m)];
      const V sign = Number(m % 2 ? -1 : 1);
      out[allOf(n, -m)] = {sign * c.re, hn::Neg(sign * c.im)};
    }
}

// The same for the coefficients, real numbers: kAll x 6.
void CoefficientsOfAll(const double* HWY_RESTRICT coefficients, double* HWY_RESTRICT out) {
  for (int n = 0; n <= kOrder; ++n)
    for (int m = 0; m <= n; ++m)
      for (int k = 0; k < 3; ++k) {
        const double re = coefficients[6 * termOf(n, m) + 2 * k],
                     im = coefficients[6 * termOf(n, m) + 2 * k + 1];
        const double sign = m % 2 ? -1 : 1;
        out[6 * allOf(n, -m) + 2 * k] = sign * re;
        out[6 * allOf(n, -m) + 2 * k + 1] = -sign * im;
        out[6 * allOf(n, m) + 2 * k] = re;
        out[6 * allOf(n, m) + 2 * k + 1] = im;
      }
}

// L'_ji = sum over n >= j and m of L_nm conj(R_(n-j)(m-i)(shift)).
HWY_INLINE void MoveTerm(int j, int i, const double* HWY_RESTRICT from,
                         const Complex* HWY_RESTRICT regular, double* HWY_RESTRICT out) {
  const D d;
  V re[3], im[3];
  for (int k = 0; k < 3; ++k) re[k] = im[k] = hn::Zero(d);
  for (int k = 0; k <= kOrder - j; ++k)
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

void MoveExpansion(const StepExpansion& from, const LaneSets& sets,
                   double* HWY_RESTRICT coefficients) {
  const D d;
  double all[6 * kAll];
  CoefficientsOfAll(from.coefficients.data(), all);
  Complex regular[kAll];
  for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
    ConjugateRegular(hn::Load(d, sets.center[0] + lane) - Number(from.center.x),
                     hn::Load(d, sets.center[1] + lane) - Number(from.center.y),
                     hn::Load(d, sets.center[2] + lane) - Number(from.center.z), regular);
    for (int j = 0; j <= kOrder; ++j)
      for (int i = 0; i <= j; ++i)
        MoveTerm(j, i, all, regular, coefficients + 6 * termOf(j, i) * kLanes + lane);
  }
}

// NOLINTEND(readability-identifier-naming)
}  // namespace HWY_NAMESPACE
}  // namespace innermap::proof
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::proof {

HWY_EXPORT(Classify);
HWY_EXPORT(AddCharges);
HWY_EXPORT(AddAboutOne);
HWY_EXPORT(MoveExpansion);

void classify(const double* charges, const std::uint32_t* list, std::size_t count,
              const LaneSets& sets, double farRatio, std::uint8_t* farLanes, LaneRemainders& far,
              LaneRemainders& near) {
  HWY_DYNAMIC_DISPATCH(Classify)(charges, list, count, sets, farRatio, farLanes, far, near);
}

void addCharges(const double* charges, const std::uint32_t* list, const std::uint8_t* lanes,
                std::uint8_t flip, std::size_t count, const LaneSets& sets, double* coefficients) {
  HWY_DYNAMIC_DISPATCH(AddCharges)(charges, list, lanes, flip, count, sets, coefficients);
}

void addCharges(const double* charges, const std::uint32_t* list, std::size_t count,
                StepExpansion& expansion) {
  HWY_DYNAMIC_DISPATCH(AddAboutOne)(charges, list, count, expansion);
}

void addInherited(const StepExpansion& from, const LaneSets& sets, LaneRemainders& remainders) {
  const Remainder& r = from.remainder;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Vec3 center{sets.center[0][lane], sets.center[1][lane], sets.center[2][lane]};
    remainders.gradient[lane] += r.gradient;
    remainders.value[lane] += r.value;
    remainders.gradientMagnitude[lane] += r.gradientMagnitude;
    remainders.valueMagnitude[lane] +=
        r.valueMagnitude + norm(center - from.center) * r.gradientMagnitude;
  }
}

void moveExpansion(const StepExpansion& from, const LaneSets& sets, double* coefficients) {
  HWY_DYNAMIC_DISPATCH(MoveExpansion)(from, sets, coefficients);
}

}  // namespace innermap::proof
#endif
