// What the kernels of all lanes are written in, once for each instruction set. For sources that
// include lane_kernels.h, which has the number of lanes.
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.
#if defined(INNERMAP_PROOF_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INNERMAP_PROOF_LANES_INL_H_
#undef INNERMAP_PROOF_LANES_INL_H_
#else
#define INNERMAP_PROOF_LANES_INL_H_
#endif

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::proof {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_SCALAR
using D = hn::ScalableTag<double>;
#else
using D = hn::CappedTag<double, kLanes>;
#endif
using V = hn::Vec<D>;

struct Complex {
  V re, im;
};

// Lanes of a vector. The coefficients of so many lanes stand together, all of them before those of
// the next lanes: half the lanes' sums stay in the first cache where all of them would not.
HWY_INLINE std::size_t Side() { return hn::Lanes(D()); }

HWY_INLINE V Number(double x) { return hn::Set(D(), x); }

}  // namespace HWY_NAMESPACE
}  // namespace innermap::proof
HWY_AFTER_NAMESPACE();

#endif
// NOLINTEND(readability-identifier-naming)
