#include "solve/detail/kernel_simd.h"

#include <algorithm>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/detail/kernel_simd.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::simd {
namespace HWY_NAMESPACE {
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.

namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_SCALAR
using D = hn::ScalableTag<double>;
#else
// Longer vectors (wide SVE, say) would write past the padding.
using D = hn::CappedTag<double, kRows / 4>;
#endif
using V = hn::Vec<D>;

// Good bits of 1/sqrt(x): 14 with AVX-512, 11 with other x86, 8 with Neon.
HWY_INLINE V EstimateInverseSqrt(D d, V x) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  (void)d;
  return V{_mm512_rsqrt14_pd(x.raw)};
#elif HWY_TARGET == HWY_SCALAR
  return hn::Div(hn::Set(d, 1.0), hn::Sqrt(x));
#else
  const hn::Rebind<float, D> df;
  return hn::PromoteTo(d, hn::ApproximateReciprocalSqrt(hn::DemoteTo(df, x)));
#endif
}

// 1/sqrt(x) by two Newton steps, error about one unit of rounding, or by one, error 1e-8, where
// that is enough; 0 where x is 0. After an estimate of 11 bits two such steps leave up to 6e-14, so
// the last one is of the third order.
template <Rounding R>
HWY_INLINE V InverseSqrt(D d, V x) {
  constexpr int kSteps = (HWY_TARGET == HWY_NEON ? 2 : 1) * (R == Rounding::full ? 2 : 1);
  constexpr bool kThirdOrder = HWY_ARCH_X86 && HWY_TARGET > HWY_AVX3 && HWY_TARGET != HWY_SCALAR;
  const V half = hn::Set(d, 0.5);
  const V halfX = hn::Mul(half, x);
  V y = EstimateInverseSqrt(d, x);
  for (int step = 0; step < kSteps; ++step) {
    V t = hn::NegMulAdd(hn::Mul(halfX, y), y, half);
    if (kThirdOrder && step + 1 == kSteps) t = hn::MulAdd(hn::Mul(t, t), hn::Set(d, 1.5), t);
    y = hn::MulAdd(y, t, y);
  }
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), y);
}

#if HWY_TARGET == HWY_SCALAR
using DF = hn::ScalableTag<float>;
#else
using DF = hn::CappedTag<float, kRows / 2>;
#endif

// `nearest`: the largest so far.
template <Rounding R>
HWY_INLINE hn::Vec<DF> InverseSqrt(DF d, hn::Vec<DF> x, hn::Vec<DF>& nearest) {
  const auto y = hn::ApproximateReciprocalSqrt(x), half = hn::Set(d, 0.5f);
  nearest = hn::Max(nearest, y);
  const auto t = hn::NegMulAdd(hn::Mul(hn::Mul(half, x), y), y, half);
  return hn::MulAdd(y, t, y);
}

template <Rounding R>
HWY_INLINE V InverseSqrt(D d, V x, V&) {
  return InverseSqrt<R>(d, x);
}

// Added to squared distances. In single precision pairs that may coincide are summed again by the
// caller, who is told of them: no need to mask them out.
template <Rounding R>
constexpr double kTiny = R == Rounding::single ? 1e-30 : 0;

template <Rounding R>
using TagOf = std::conditional_t<R == Rounding::single, DF, D>;
template <Rounding R>
using NumberOf = std::conditional_t<R == Rounding::single, float, double>;

// In single precision, returns the largest 1/distance met; 0 otherwise.
template <int K, Rounding R, class T = NumberOf<R>>
T SumValues(const T* HWY_RESTRICT sources, std::size_t sourceCount, const T* x, const T* y,
            const T* z, std::size_t count, std::size_t stride, T* HWY_RESTRICT values) {
  using Vector = hn::Vec<TagOf<R>>;
  const TagOf<R> d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr int kUnroll = R == Rounding::single ? 2 : 4;  // kRows targets at most
  const Vector tiny = hn::Set(d, kTiny<R>);
  Vector nearest = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += kUnroll * lanes) {
    Vector px[kUnroll], py[kUnroll], pz[kUnroll], sum[kUnroll][K];
    for (int u = 0; u < kUnroll; ++u) {
      px[u] = hn::LoadU(d, x + i + u * lanes);
      py[u] = hn::LoadU(d, y + i + u * lanes);
      pz[u] = hn::LoadU(d, z + i + u * lanes);
      for (int k = 0; k < K; ++k) sum[u][k] = hn::Zero(d);
    }
    const T* s = sources;
    for (std::size_t j = 0; j < sourceCount; ++j, s += 3 + K) {
      const Vector qx = hn::Set(d, s[0]), qy = hn::Set(d, s[1]), qz = hn::Set(d, s[2]);
      for (int u = 0; u < kUnroll; ++u) {
        const Vector dx = hn::Sub(px[u], qx), dy = hn::Sub(py[u], qy), dz = hn::Sub(pz[u], qz);
        const Vector r = InverseSqrt<R>(
            d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::MulAdd(dz, dz, tiny))), nearest);
        for (int k = 0; k < K; ++k) sum[u][k] = hn::MulAdd(hn::Set(d, s[3 + k]), r, sum[u][k]);
      }
    }
    for (int u = 0; u < kUnroll; ++u)
      for (int k = 0; k < K; ++k) hn::StoreU(sum[u][k], d, values + k * stride + i + u * lanes);
  }
  return hn::GetLane(hn::MaxOfLanes(d, nearest));
}

template <int K, Rounding R, class T = NumberOf<R>>
T SumGradients(const T* HWY_RESTRICT sources, std::size_t sourceCount, const T* x, const T* y,
               const T* z, std::size_t count, std::size_t stride, T* HWY_RESTRICT values,
               T* HWY_RESTRICT gradients) {
  using Vector = hn::Vec<TagOf<R>>;
  const TagOf<R> d;
  const std::size_t lanes = hn::Lanes(d);
  const Vector tiny = hn::Set(d, kTiny<R>);
  Vector nearest = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += lanes) {
    const Vector px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i), pz = hn::LoadU(d, z + i);
    Vector sum[K], gx[K], gy[K], gz[K];
    for (int k = 0; k < K; ++k) sum[k] = gx[k] = gy[k] = gz[k] = hn::Zero(d);
    const T* s = sources;
    for (std::size_t j = 0; j < sourceCount; ++j, s += 3 + K) {
      const Vector dx = hn::Sub(px, hn::Set(d, s[0])), dy = hn::Sub(py, hn::Set(d, s[1])),
                   dz = hn::Sub(pz, hn::Set(d, s[2]));
      const Vector r = InverseSqrt<R>(
          d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::MulAdd(dz, dz, tiny))), nearest);
      const Vector r3 = hn::Mul(hn::Mul(r, r), r);
      const Vector ex = hn::Mul(dx, r3), ey = hn::Mul(dy, r3), ez = hn::Mul(dz, r3);
      for (int k = 0; k < K; ++k) {
        const Vector w = hn::Set(d, s[3 + k]);
        sum[k] = hn::MulAdd(w, r, sum[k]);
        gx[k] = hn::NegMulAdd(w, ex, gx[k]);
        gy[k] = hn::NegMulAdd(w, ey, gy[k]);
        gz[k] = hn::NegMulAdd(w, ez, gz[k]);
      }
    }
    for (int k = 0; k < K; ++k) {
      hn::StoreU(sum[k], d, values + k * stride + i);
      hn::StoreU(gx[k], d, gradients + (3 * k + 0) * stride + i);
      hn::StoreU(gy[k], d, gradients + (3 * k + 1) * stride + i);
      hn::StoreU(gz[k], d, gradients + (3 * k + 2) * stride + i);
    }
  }
  return hn::GetLane(hn::MaxOfLanes(d, nearest));
}

// In tiles of targets and of sources: partial sums of few terms keep single precision's digits.
template <int K>
double SumSingle(const double* sources, std::size_t sourceCount, const double* x, const double* y,
                 const double* z, std::size_t count, std::size_t stride, double* values,
                 double* gradients) {
  constexpr std::size_t kTargets = 256, kSources = 256;
  float at[3][kTargets], charges[kSources * (3 + K)], sums[K * kTargets], slopes[3 * K * kTargets],
      nearest = 0;
  const auto add = [&](const float* from, double* to, std::size_t columns, std::size_t size) {
    for (std::size_t k = 0; k < columns; ++k)
      for (std::size_t t = 0; t < size; ++t) to[k * stride + t] += from[k * kTargets + t];
  };
  for (std::size_t i = 0; i < count; i += kTargets) {
    const std::size_t size = HWY_MIN(kTargets, count - i),
                      filled = (size + kRows - 1) / kRows * kRows;
    for (std::size_t k = 0; k < K; ++k) std::fill_n(values + k * stride + i, filled, 0.0);
    for (std::size_t k = 0; gradients && k < 3 * K; ++k)
      std::fill_n(gradients + k * stride + i, filled, 0.0);
    for (std::size_t t = 0; t < filled; ++t) {
      at[0][t] = static_cast<float>(x[i + t]);
      at[1][t] = static_cast<float>(y[i + t]);
      at[2][t] = static_cast<float>(z[i + t]);
    }
    for (std::size_t j = 0; j < sourceCount; j += kSources) {
      const std::size_t n = HWY_MIN(kSources, sourceCount - j);
      for (std::size_t c = 0; c < n * (3 + K); ++c)
        charges[c] = static_cast<float>(sources[j * (3 + K) + c]);
      const float met = gradients
                            ? SumGradients<K, Rounding::single>(charges, n, at[0], at[1], at[2],
                                                                size, kTargets, sums, slopes)
                            : SumValues<K, Rounding::single>(charges, n, at[0], at[1], at[2], size,
                                                             kTargets, sums);
      nearest = HWY_MAX(nearest, met);
      add(sums, values + i, K, filled);
      if (gradients) add(slopes, gradients + i, 3 * K, filled);
    }
  }
  return nearest;
}

template <int K, Rounding R>
double Sum(const double* sources, std::size_t sourceCount, const double* x, const double* y,
           const double* z, std::size_t count, std::size_t stride, double* values,
           double* gradients) {
  if constexpr (R == Rounding::single) {
    return SumSingle<K>(sources, sourceCount, x, y, z, count, stride, values, gradients);
  } else {
    return gradients
               ? SumGradients<K, R>(sources, sourceCount, x, y, z, count, stride, values, gradients)
               : SumValues<K, R>(sources, sourceCount, x, y, z, count, stride, values);
  }
}

template <int K>
double SumRounded(const double* sources, std::size_t sourceCount, const double* x, const double* y,
                  const double* z, std::size_t count, std::size_t stride, double* values,
                  double* gradients, Rounding rounding) {
  const auto sum = rounding == Rounding::full    ? Sum<K, Rounding::full>
                   : rounding == Rounding::rough ? Sum<K, Rounding::rough>
                                                 : Sum<K, Rounding::single>;
  return sum(sources, sourceCount, x, y, z, count, stride, values, gradients);
}

double SumCharges(const double* sources, std::size_t sourceCount, int channels, const double* x,
                  const double* y, const double* z, std::size_t count, std::size_t stride,
                  double* values, double* gradients, Rounding rounding) {
  const auto sum = channels == 1 ? SumRounded<1> : channels == 2 ? SumRounded<2> : SumRounded<3>;
  return sum(sources, sourceCount, x, y, z, count, stride, values, gradients, rounding);
}

void KernelColumn(const double* x, const double* y, const double* z, std::size_t count, double qx,
                  double qy, double qz, double scale, double* HWY_RESTRICT out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V sx = hn::Set(d, qx), sy = hn::Set(d, qy), sz = hn::Set(d, qz), factor = hn::Set(d, scale);
  HWY_ALIGN double tail[kPadding];
  for (std::size_t i = 0; i < count; i += lanes) {
    const V dx = hn::Sub(hn::LoadU(d, x + i), sx), dy = hn::Sub(hn::LoadU(d, y + i), sy),
            dz = hn::Sub(hn::LoadU(d, z + i), sz);
    const V value = hn::Mul(
        factor,
        InverseSqrt<Rounding::full>(d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)))));
    if (i + lanes <= count) {
      hn::StoreU(value, d, out + i);
    } else {
      hn::StoreU(value, d, tail);
      for (std::size_t k = 0; i + k < count; ++k) out[i + k] = tail[k];
    }
  }
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

// NOLINTEND(readability-identifier-naming)
}  // namespace HWY_NAMESPACE
}  // namespace innermap::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::simd {

HWY_EXPORT(SumCharges);
HWY_EXPORT(KernelColumn);
HWY_EXPORT(TargetName);

double sumCharges(const double* sources, std::size_t sourceCount, int channels, const double* x,
                  const double* y, const double* z, std::size_t count, std::size_t stride,
                  double* values, double* gradients, Rounding rounding) {
  return HWY_DYNAMIC_DISPATCH(SumCharges)(sources, sourceCount, channels, x, y, z, count, stride,
                                          values, gradients, rounding);
}

void kernelColumn(const double* x, const double* y, const double* z, std::size_t count, double qx,
                  double qy, double qz, double scale, double* out) {
  HWY_DYNAMIC_DISPATCH(KernelColumn)(x, y, z, count, qx, qy, qz, scale, out);
}

const char* targetName() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace innermap::simd
#endif
