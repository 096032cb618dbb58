#include "solve/detail/expansion_simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/detail/expansion_simd.cc"
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
using D = hn::CappedTag<double, 8>;
#endif
using V = hn::Vec<D>;

void SolidHarmonics(int order, const double* HWY_RESTRICT recurrence, const double* x,
                    const double* y, const double* z, std::size_t points, double* HWY_RESTRICT out,
                    std::size_t stride) {
  const D d;
  for (std::size_t i = 0; i < points; i += hn::Lanes(d)) {
    const V px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i), pz = hn::LoadU(d, z + i);
    const V r2 = hn::MulAdd(px, px, hn::MulAdd(py, py, hn::Mul(pz, pz)));
    V diagonalC = hn::Set(d, 1.0), diagonalS = hn::Zero(d);
    const double* factor = recurrence;
    double* to = out + i;
    for (int m = 0; m <= order; ++m) {
      const V a = hn::Set(d, *factor);
      factor += 2;
      if (m > 0) {
        const V c = hn::Mul(a, hn::NegMulAdd(py, diagonalS, hn::Mul(px, diagonalC)));
        diagonalS = hn::Mul(a, hn::MulAdd(py, diagonalC, hn::Mul(px, diagonalS)));
        diagonalC = c;
      }
      V c = diagonalC, s = diagonalS, beforeC = hn::Zero(d), beforeS = hn::Zero(d);
      for (int n = m;; ++n) {
        hn::StoreU(c, d, to);
        to += stride;
        if (m > 0) {
          hn::StoreU(s, d, to);
          to += stride;
        }
        if (n == order) break;
        const V az = hn::Mul(hn::Set(d, factor[0]), pz), br = hn::Mul(hn::Set(d, factor[1]), r2);
        factor += 2;
        const V nextC = hn::NegMulAdd(br, beforeC, hn::Mul(az, c));
        const V nextS = hn::NegMulAdd(br, beforeS, hn::Mul(az, s));
        beforeC = c;
        beforeS = s;
        c = nextC;
        s = nextS;
      }
    }
  }
}

void MultiplyThree(const double* HWY_RESTRICT a, std::size_t rows, std::size_t columns,
                   const double* HWY_RESTRICT x, std::size_t xStride, double* HWY_RESTRICT y) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr std::size_t kUnroll = 4;
  for (std::size_t i = 0; i < rows; i += kUnroll * lanes) {
    V sum[3][kUnroll];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t u = 0; u < kUnroll; ++u)
        sum[k][u] = hn::LoadU(d, y + k * rows + i + u * lanes);
    for (std::size_t j = 0; j < columns; ++j) {
      V x3[3];
      for (std::size_t k = 0; k < 3; ++k) x3[k] = hn::Set(d, x[k * xStride + j]);
      for (std::size_t u = 0; u < kUnroll; ++u) {
        const V row = hn::LoadU(d, a + j * rows + i + u * lanes);
        for (std::size_t k = 0; k < 3; ++k) sum[k][u] = hn::MulAdd(row, x3[k], sum[k][u]);
      }
    }
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t u = 0; u < kUnroll; ++u)
        hn::StoreU(sum[k][u], d, y + k * rows + i + u * lanes);
  }
}

// NOLINTEND(readability-identifier-naming)
}  // namespace HWY_NAMESPACE
}  // namespace innermap::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::simd {

HWY_EXPORT(SolidHarmonics);
HWY_EXPORT(MultiplyThree);

void solidHarmonics(int order, const double* recurrence, const double* x, const double* y,
                    const double* z, std::size_t points, double* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(SolidHarmonics)(order, recurrence, x, y, z, points, out, stride);
}

void multiplyThree(const double* a, std::size_t rows, std::size_t columns, const double* x,
                   std::size_t xStride, double* y) {
  HWY_DYNAMIC_DISPATCH(MultiplyThree)(a, rows, columns, x, xStride, y);
}

}  // namespace innermap::simd
#endif
