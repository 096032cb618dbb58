#include "innermap/solve/kernel_simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "innermap/solve/kernel_simd.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_SCALAR
using D = hn::ScalableTag<double>;
#else
// Longer vectors (wide SVE, say) would write past the padding.
using D = hn::CappedTag<double, kRows / 4>;
#endif
using V = hn::Vec<D>;

// At least 12 good bits of 1/sqrt(x).
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

// 1/sqrt(x) by two Newton steps, error about one unit of rounding, or by one where that is enough;
// 0 where x is 0.
template <Rounding R = Rounding::full>
HWY_INLINE V InverseSqrt(D d, V x) {
  constexpr int kSteps = (HWY_TARGET == HWY_NEON ? 2 : 1) * (R == Rounding::full ? 2 : 1);
  const V half = hn::Set(d, 0.5);
  const V halfX = hn::Mul(half, x);
  V y = EstimateInverseSqrt(d, x);
  for (int step = 0; step < kSteps; ++step) {
    const V t = hn::NegMulAdd(hn::Mul(halfX, y), y, half);
    y = hn::MulAdd(y, t, y);
  }
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), y);
}

template <int K, Rounding R>
void SumValues(const double* HWY_RESTRICT sources, std::size_t sourceCount, const double* x,
               const double* y, const double* z, std::size_t count, std::size_t stride,
               double* HWY_RESTRICT values) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr int kUnroll = 4;
  for (std::size_t i = 0; i < count; i += kUnroll * lanes) {
    V px[kUnroll], py[kUnroll], pz[kUnroll], sum[kUnroll][K];
    for (int u = 0; u < kUnroll; ++u) {
      px[u] = hn::LoadU(d, x + i + u * lanes);
      py[u] = hn::LoadU(d, y + i + u * lanes);
      pz[u] = hn::LoadU(d, z + i + u * lanes);
      for (int k = 0; k < K; ++k) sum[u][k] = hn::Zero(d);
    }
    const double* s = sources;
    for (std::size_t j = 0; j < sourceCount; ++j, s += 3 + K) {
      const V qx = hn::Set(d, s[0]), qy = hn::Set(d, s[1]), qz = hn::Set(d, s[2]);
      for (int u = 0; u < kUnroll; ++u) {
        const V dx = hn::Sub(px[u], qx), dy = hn::Sub(py[u], qy), dz = hn::Sub(pz[u], qz);
        const V r = InverseSqrt<R>(d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
        for (int k = 0; k < K; ++k) sum[u][k] = hn::MulAdd(hn::Set(d, s[3 + k]), r, sum[u][k]);
      }
    }
    for (int u = 0; u < kUnroll; ++u)
      for (int k = 0; k < K; ++k) hn::StoreU(sum[u][k], d, values + k * stride + i + u * lanes);
  }
}

#if HWY_TARGET == HWY_SCALAR
using DF = hn::ScalableTag<float>;
#else
using DF = hn::CappedTag<float, kRows / 2>;
#endif
using VF = hn::Vec<DF>;

HWY_INLINE VF InverseSqrt(DF d, VF x) {
  const VF y = hn::ApproximateReciprocalSqrt(x), half = hn::Set(d, 0.5f);
  const VF t = hn::NegMulAdd(hn::Mul(hn::Mul(half, x), y), y, half);
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), hn::MulAdd(y, t, y));
}

// Adds the sums over `sourceCount` sources at the tile's targets, all in single precision.
template <int K>
void SumTile(const float* HWY_RESTRICT sources, std::size_t sourceCount, const float* x,
             const float* y, const float* z, std::size_t count, std::size_t stride,
             double* HWY_RESTRICT values) {
  const DF d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr int kUnroll = 2;
  for (std::size_t i = 0; i < count; i += kUnroll * lanes) {
    VF px[kUnroll], py[kUnroll], pz[kUnroll], sum[kUnroll][K];
    for (int u = 0; u < kUnroll; ++u) {
      px[u] = hn::LoadU(d, x + i + u * lanes);
      py[u] = hn::LoadU(d, y + i + u * lanes);
      pz[u] = hn::LoadU(d, z + i + u * lanes);
      for (int k = 0; k < K; ++k) sum[u][k] = hn::Zero(d);
    }
    const float* s = sources;
    for (std::size_t j = 0; j < sourceCount; ++j, s += 3 + K) {
      const VF qx = hn::Set(d, s[0]), qy = hn::Set(d, s[1]), qz = hn::Set(d, s[2]);
      for (int u = 0; u < kUnroll; ++u) {
        const VF dx = hn::Sub(px[u], qx), dy = hn::Sub(py[u], qy), dz = hn::Sub(pz[u], qz);
        const VF r = InverseSqrt(d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
        for (int k = 0; k < K; ++k) sum[u][k] = hn::MulAdd(hn::Set(d, s[3 + k]), r, sum[u][k]);
      }
    }
    float out[kRows];
    for (int k = 0; k < K; ++k) {
      for (int u = 0; u < kUnroll; ++u) hn::StoreU(sum[u][k], d, out + u * lanes);
      for (std::size_t t = 0; t < kUnroll * lanes; ++t) values[k * stride + i + t] += out[t];
    }
  }
}

// In tiles of targets and of sources: partial sums of few terms keep single precision's digits.
template <int K>
void SumValuesSingle(const double* sources, std::size_t sourceCount, const double* x,
                     const double* y, const double* z, std::size_t count, std::size_t stride,
                     double* values) {
  constexpr std::size_t kTargets = 4 * kPadding, kSources = 256;
  float at[3][kTargets], charges[kSources * (3 + K)];
  for (std::size_t i = 0; i < count; i += kTargets) {
    const std::size_t size = HWY_MIN(kTargets, count - i),
                      filled = (size + kRows - 1) / kRows * kRows;
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t t = 0; t < filled; ++t) values[k * stride + i + t] = 0;
    for (std::size_t t = 0; t < filled; ++t) {
      at[0][t] = static_cast<float>(x[i + t]);
      at[1][t] = static_cast<float>(y[i + t]);
      at[2][t] = static_cast<float>(z[i + t]);
    }
    for (std::size_t j = 0; j < sourceCount; j += kSources) {
      const std::size_t n = HWY_MIN(kSources, sourceCount - j);
      for (std::size_t c = 0; c < n * (3 + K); ++c)
        charges[c] = static_cast<float>(sources[j * (3 + K) + c]);
      SumTile<K>(charges, n, at[0], at[1], at[2], size, stride, values + i);
    }
  }
}

template <int K, Rounding R>
void SumGradients(const double* HWY_RESTRICT sources, std::size_t sourceCount, const double* x,
                  const double* y, const double* z, std::size_t count, std::size_t stride,
                  double* HWY_RESTRICT values, double* HWY_RESTRICT gradients) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < count; i += lanes) {
    const V px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i), pz = hn::LoadU(d, z + i);
    V sum[K], gx[K], gy[K], gz[K];
    for (int k = 0; k < K; ++k) sum[k] = gx[k] = gy[k] = gz[k] = hn::Zero(d);
    const double* s = sources;
    for (std::size_t j = 0; j < sourceCount; ++j, s += 3 + K) {
      const V dx = hn::Sub(px, hn::Set(d, s[0])), dy = hn::Sub(py, hn::Set(d, s[1])),
              dz = hn::Sub(pz, hn::Set(d, s[2]));
      const V r = InverseSqrt<R>(d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
      const V r2 = hn::Mul(r, r);
      for (int k = 0; k < K; ++k) {
        const V wr = hn::Mul(hn::Set(d, s[3 + k]), r);
        sum[k] = hn::Add(sum[k], wr);
        const V wr3 = hn::Mul(wr, r2);
        gx[k] = hn::NegMulAdd(wr3, dx, gx[k]);
        gy[k] = hn::NegMulAdd(wr3, dy, gy[k]);
        gz[k] = hn::NegMulAdd(wr3, dz, gz[k]);
      }
    }
    for (int k = 0; k < K; ++k) {
      hn::StoreU(sum[k], d, values + k * stride + i);
      hn::StoreU(gx[k], d, gradients + (3 * k + 0) * stride + i);
      hn::StoreU(gy[k], d, gradients + (3 * k + 1) * stride + i);
      hn::StoreU(gz[k], d, gradients + (3 * k + 2) * stride + i);
    }
  }
}

template <int K, Rounding R>
void Sum(const double* sources, std::size_t sourceCount, const double* x, const double* y,
         const double* z, std::size_t count, std::size_t stride, double* values,
         double* gradients) {
  if (!gradients && R == Rounding::single)
    SumValuesSingle<K>(sources, sourceCount, x, y, z, count, stride, values);
  else if (gradients)
    SumGradients<K, R>(sources, sourceCount, x, y, z, count, stride, values, gradients);
  else
    SumValues<K, R>(sources, sourceCount, x, y, z, count, stride, values);
}

void SumCharges(const double* sources, std::size_t sourceCount, int channels, const double* x,
                const double* y, const double* z, std::size_t count, std::size_t stride,
                double* values, double* gradients, Rounding rounding) {
  const auto full = channels == 1   ? Sum<1, Rounding::full>
                    : channels == 2 ? Sum<2, Rounding::full>
                                    : Sum<3, Rounding::full>;
  const auto rough = channels == 1   ? Sum<1, Rounding::rough>
                     : channels == 2 ? Sum<2, Rounding::rough>
                                     : Sum<3, Rounding::rough>;
  const auto single = channels == 1   ? Sum<1, Rounding::single>
                      : channels == 2 ? Sum<2, Rounding::single>
                                      : Sum<3, Rounding::single>;
  (rounding == Rounding::full ? full
   : rounding == Rounding::rough
       ? rough
       : single)(sources, sourceCount, x, y, z, count, stride, values, gradients);
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
    const V value =
        hn::Mul(factor, InverseSqrt(d, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)))));
    if (i + lanes <= count) {
      hn::StoreU(value, d, out + i);
    } else {
      hn::StoreU(value, d, tail);
      for (std::size_t k = 0; i + k < count; ++k) out[i + k] = tail[k];
    }
  }
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace innermap::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::simd {

HWY_EXPORT(SumCharges);
HWY_EXPORT(KernelColumn);
HWY_EXPORT(TargetName);

void sumCharges(const double* sources, std::size_t sourceCount, int channels, const double* x,
                const double* y, const double* z, std::size_t count, std::size_t stride,
                double* values, double* gradients, Rounding rounding) {
  HWY_DYNAMIC_DISPATCH(SumCharges)
  (sources, sourceCount, channels, x, y, z, count, stride, values, gradients, rounding);
}

void kernelColumn(const double* x, const double* y, const double* z, std::size_t count, double qx,
                  double qy, double qz, double scale, double* out) {
  HWY_DYNAMIC_DISPATCH(KernelColumn)(x, y, z, count, qx, qy, qz, scale, out);
}

const char* targetName() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace innermap::simd
#endif
