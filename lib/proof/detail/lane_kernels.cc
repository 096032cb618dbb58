#include "proof/detail/lane_kernels.h"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proof/detail/lane_kernels.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "proof/detail/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace innermap::proof {
namespace HWY_NAMESPACE {
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.

HWY_INLINE double Total(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

std::uint8_t Measure(const double* HWY_RESTRICT charges, const std::uint32_t* HWY_RESTRICT list,
                     std::size_t count, const LaneSets& sets, double* HWY_RESTRICT nearest) {
  const D d;
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::fill_n(nearest, count, kInfinite);
  Lanes least;
  for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
    const V cx = hn::Load(d, sets.center[0] + lane), cy = hn::Load(d, sets.center[1] + lane),
            cz = hn::Load(d, sets.center[2] + lane), radius = hn::Load(d, sets.radius + lane);
    const V scale = Number(1) / (radius * radius);
    V closest = Number(kInfinite);
    for (std::size_t i = 0; i < count; ++i) {
      const double* q = charges + kChargeStride * list[i];
      const V x = Number(q[0]) - cx, y = Number(q[1]) - cy, z = Number(q[2]) - cz;
      const V square = scale * hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
      closest = hn::Min(closest, square);
      nearest[i] = std::min(nearest[i], hn::GetLane(hn::MinOfLanes(d, square)));
    }
    hn::StoreU(closest, d, least + lane);
  }
  unsigned out = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    if (least[lane] * (kNearRatio * kNearRatio) >= 1) out |= 1u << lane;
  return static_cast<std::uint8_t>(out);
}

void OrderPlaces(const double* HWY_RESTRICT charges, const std::uint32_t* HWY_RESTRICT list,
                 std::size_t count, const Vec3& center, double radius, const OrderLimits& limits,
                 std::int32_t* HWY_RESTRICT places) {
  const double scale = 1 / (radius * radius);
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const D d;
  const hn::RebindToSigned<D> whole;
  const hn::Rebind<std::int32_t, D> small;
  const V none = Number(kNotExpanded), zero = hn::Zero(d), one = Number(1);
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    const auto index = hn::LoadU(small, reinterpret_cast<const std::int32_t*>(list + i));
    const auto at = hn::Mul(hn::PromoteTo(whole, index), hn::Set(whole, kChargeStride));
    const V x = hn::GatherIndex(d, charges, at) - Number(center.x),
            y = hn::GatherIndex(d, charges + 1, at) - Number(center.y),
            z = hn::GatherIndex(d, charges + 2, at) - Number(center.z);
    const V square = Number(scale) * hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
    V passed = zero;
    for (const double l : limits)
      passed = passed + hn::IfThenElseZero(hn::Gt(square, Number(l)), one);
    const V place = hn::IfThenElse(hn::Eq(passed, zero), none, passed - one);
    hn::StoreU(hn::DemoteTo(small, place), small, places + i);
  }
#endif
  for (; i < count; ++i) {
    const double* const q = charges + kChargeStride * list[i];
    places[i] = orderPlace(limits, scale * squaredNorm(Vec3{q[0], q[1], q[2]} - center));
  }
}

// A charge, seen from the places that it is expanded about. Its harmonics are
// I_nm(q) = (n - m)! P_n^m(cos theta) e^(i m phi) / r^(n+1): 1/|x - q| is the sum of
// I_nm(q) conj(R_nm(x)).
struct Arm {
  V x, y, z;         // to the charge, over the square of the distance
  V inverse;         // of that square
  Complex diagonal;  // I_mm, at first of m = 0
  V weight[3];
};

HWY_INLINE Arm ArmTo(V x, V y, V z, V w0, V w1, V w2) {
  const V inverse = Number(1) / hn::MulAdd(x, x, hn::MulAdd(y, y, z * z));
  return {x * inverse, y * inverse, z * inverse, inverse, {hn::Sqrt(inverse), hn::Zero(D())},
          {w0, w1, w2}};
}

HWY_INLINE Complex NextDiagonal(const Arm& arm, V factor, const Complex& diagonal) {
  return {factor * hn::NegMulAdd(arm.y, diagonal.im, arm.x * diagonal.re),
          factor * hn::MulAdd(arm.y, diagonal.re, arm.x * diagonal.im)};
}

// Factors of the recurrences.
struct Factors {
  double up[kOrder + 1], down[kTerms];
};
constexpr Factors kFactors = [] {
  Factors out{};
  for (int n = 0; n <= kOrder; ++n) {
    out.up[n] = 2 * n + 1;
    for (int m = 0; m <= n; ++m) out.down[termOf(n, m)] = n * n - m * m;
  }
  return out;
}();

// Adds the expansions of some charges at once, so that sums are read and written once for all of
// them. I_nm / I_mm is real: a recurrence of real numbers for each order m, then one product for
// each sum and charge. Overwrites the diagonals of the arms.
template <std::size_t kCharges>
HWY_NOINLINE void AddArms(int order, Arm* HWY_RESTRICT arms, double* HWY_RESTRICT coefficients) {
  V up[kOrder + 1][kCharges], amplitude[kOrder + 2][kCharges];
  for (int n = 0; n < order; ++n)
    for (std::size_t c = 0; c < kCharges; ++c) up[n][c] = Number(kFactors.up[n]) * arms[c].z;
  for (int m = 0; m <= order; ++m) {
    for (std::size_t c = 0; c < kCharges; ++c) {
      amplitude[m][c] = Number(1);
      if (m < order) amplitude[m + 1][c] = up[m][c];
    }
    for (int n = m + 1; n < order; ++n)
      for (std::size_t c = 0; c < kCharges; ++c) {
        const V down = Number(kFactors.down[termOf(n, m)]) * arms[c].inverse;
        amplitude[n + 1][c] = hn::MulSub(up[n][c], amplitude[n][c], down * amplitude[n - 1][c]);
      }
    for (int part = 0; part < (m == 0 ? 1 : 2); ++part) {
      V weight[kCharges][3];
      for (std::size_t c = 0; c < kCharges; ++c)
        for (int k = 0; k < 3; ++k)
          weight[c][k] =
              arms[c].weight[k] * (part == 0 ? arms[c].diagonal.re : arms[c].diagonal.im);
      for (int n = m; n <= order; ++n) {
        double* out = coefficients + (6 * termOf(n, m) + part) * Side();
        for (int k = 0; k < 3; ++k, out += 2 * Side()) {
          V sum = hn::Load(D(), out);
          for (std::size_t c = 0; c < kCharges; ++c)
            sum = hn::MulAdd(weight[c][k], amplitude[n][c], sum);
          hn::Store(sum, D(), out);
        }
      }
    }
    for (std::size_t c = 0; c < kCharges; ++c)
      arms[c].diagonal = NextDiagonal(arms[c], Number(kFactors.up[m]), arms[c].diagonal);
  }
}

struct Rest {
  V gradient, value, gradientMagnitude, valueMagnitude;
};

// What a charge of a weight of that length adds, on sets of these radii.
HWY_INLINE void AddRest(int order, const Arm& arm, V length, V radius, Rest& sum) {
  const V one = Number(1), infinite = Number(std::numeric_limits<double>::infinity());
  const V inverse = arm.diagonal.re, ratio = radius * inverse;
  const auto known = hn::Le(ratio, Number(kNearRatio));
  V power = ratio;  // ratio^order
  for (int n = 1; n < order; ++n) power = power * ratio;
  const V spread = one / (one - ratio);  // sum of ratio^n
  const V value = length * inverse * spread, gradient = value * inverse * spread;
  const V cut = power * hn::NegMulAdd(Number(order), ratio, Number(order + 1));
  const auto orInfinite = [&](V x) { return hn::IfThenElse(known, x, infinite); };
  sum.gradient = sum.gradient + orInfinite(gradient * cut);
  sum.value = sum.value + orInfinite(value * power * ratio);
  sum.gradientMagnitude = sum.gradientMagnitude + orInfinite(gradient);
  sum.valueMagnitude = sum.valueMagnitude + orInfinite(value);
}

// Of the charge at that place of the list.
HWY_INLINE int OrderAt(const OrderedCharges& some, std::size_t place) {
  std::size_t i = 0;
  while (place >= some.ends[i]) ++i;
  return kOrders[i];
}

HWY_INLINE Arm ArmOf(const double* HWY_RESTRICT q, const LaneSets& sets, std::size_t lane) {
  const D d;
  return ArmTo(Number(q[0]) - hn::Load(d, sets.center[0] + lane),
               Number(q[1]) - hn::Load(d, sets.center[1] + lane),
               Number(q[2]) - hn::Load(d, sets.center[2] + lane), Number(q[3]), Number(q[4]),
               Number(q[5]));
}

constexpr std::size_t kAtOnce = 4;

// Adds kAtOnce charges from `begin` on, or what is left of them.
HWY_INLINE void AddSome(const double* HWY_RESTRICT charges, const OrderedCharges& some,
                        std::size_t begin, const LaneSets& sets, std::size_t lane,
                        double* HWY_RESTRICT coefficients, LaneRemainders& remainders) {
  const D d;
  const int order = OrderAt(some, begin);
  const V radius = hn::Load(d, sets.radius + lane);
  Rest sum{hn::Load(d, remainders.gradient + lane), hn::Load(d, remainders.value + lane),
           hn::Load(d, remainders.gradientMagnitude + lane),
           hn::Load(d, remainders.valueMagnitude + lane)};
  Arm arms[kAtOnce];
  for (std::size_t c = 0; c < kAtOnce; ++c) {
    if (begin + c < some.count()) {
      const double* const q = charges + kChargeStride * some.list[begin + c];
      arms[c] = ArmOf(q, sets, lane);
      AddRest(order, arms[c], Number(q[6]), radius, sum);
    } else {
      arms[c] = arms[0];
      for (V& w : arms[c].weight) w = hn::Zero(d);
    }
  }
  AddArms<kAtOnce>(order, arms, coefficients + lane * kCoefficients);
  hn::Store(sum.gradient, d, remainders.gradient + lane);
  hn::Store(sum.value, d, remainders.value + lane);
  hn::Store(sum.gradientMagnitude, d, remainders.gradientMagnitude + lane);
  hn::Store(sum.valueMagnitude, d, remainders.valueMagnitude + lane);
}

void AddCharges(const double* HWY_RESTRICT charges, const OrderedCharges& some,
                const LaneSets& sets, double* HWY_RESTRICT coefficients,
                LaneRemainders& remainders) {
  for (std::size_t lane = 0; lane < kLanes; lane += Side())
    for (std::size_t i = 0; i < some.count(); i += kAtOnce)
      AddSome(charges, some, i, sets, lane, coefficients, remainders);
}

// Charges, one a lane, about the origin, with the weights' lengths.
struct ChargeLanes {
  V place[3], weight[3], length;
};

// Those from `begin` on; lanes that are left have no weight.
HWY_INLINE ChargeLanes Gather(const double* HWY_RESTRICT charges, const OrderedCharges& some,
                              std::size_t begin, const Vec3& center) {
  const D d;
  const hn::RebindToSigned<D> whole;
  alignas(64) std::int64_t at[kLanes];
  const std::size_t last = some.count() - 1;
  for (std::size_t l = 0; l < hn::Lanes(d); ++l)
    at[l] = static_cast<std::int64_t>(kChargeStride * some.list[std::min(begin + l, last)]);
  const auto index = hn::Load(whole, at);
  const auto real = hn::FirstN(d, begin <= last ? some.count() - begin : 0);
  ChargeLanes out;
  for (int a = 0; a < 3; ++a) {
    out.place[a] = hn::GatherIndex(d, charges + a, index) - Number(center[a]);
    out.weight[a] = hn::IfThenElseZero(real, hn::GatherIndex(d, charges + 3 + a, index));
  }
  out.length = hn::IfThenElseZero(real, hn::GatherIndex(d, charges + 6, index));
  return out;
}

HWY_INLINE Arm ArmOf(const ChargeLanes& q) {
  return ArmTo(q.place[0], q.place[1], q.place[2], q.weight[0], q.weight[1], q.weight[2]);
}

void AddAboutOne(const double* HWY_RESTRICT charges, const OrderedCharges& some, double radius,
                 StepExpansion& expansion) {
  if (some.count() == 0) return;
  const D d;
  const V zero = hn::Zero(d), within = Number(radius);
  alignas(64) double sums[kCoefficients * kLanes];
  const std::size_t used = 6 * termOf(OrderAt(some, 0) + 1, 0);
  for (std::size_t c = 0; c < used; ++c) hn::Store(zero, d, sums + c * Side());
  Rest rest{zero, zero, zero, zero};
  for (std::size_t i = 0; i < some.count(); i += 2 * hn::Lanes(d)) {
    const int order = OrderAt(some, i);
    const ChargeLanes first = Gather(charges, some, i, expansion.center);
    const ChargeLanes second = Gather(charges, some, i + hn::Lanes(d), expansion.center);
    Arm arms[2] = {ArmOf(first), ArmOf(second)};
    AddRest(order, arms[0], first.length, within, rest);
    AddRest(order, arms[1], second.length, within, rest);
    AddArms<2>(order, arms, sums);
  }
  for (std::size_t c = 0; c < used; ++c)
    expansion.coefficients[c] += Total(hn::Load(d, sums + c * Side()));
  expansion.remainder.gradient += Total(rest.gradient);
  expansion.remainder.value += Total(rest.value);
  expansion.remainder.gradientMagnitude += Total(rest.gradientMagnitude);
  expansion.remainder.valueMagnitude += Total(rest.valueMagnitude);
}

// NOLINTEND(readability-identifier-naming)
}  // namespace HWY_NAMESPACE
}  // namespace innermap::proof
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace innermap::proof {

HWY_EXPORT(Measure);
HWY_EXPORT(OrderPlaces);
HWY_EXPORT(AddCharges);
HWY_EXPORT(AddAboutOne);

std::uint8_t measure(const double* charges, const std::uint32_t* list, std::size_t count,
                     const LaneSets& sets, double* nearest) {
  return HWY_DYNAMIC_DISPATCH(Measure)(charges, list, count, sets, nearest);
}

void orderPlaces(const double* charges, const std::uint32_t* list, std::size_t count,
                 const Vec3& center, double radius, const OrderLimits& limits,
                 std::int32_t* places) {
  HWY_DYNAMIC_DISPATCH(OrderPlaces)(charges, list, count, center, radius, limits, places);
}

void arrange(const std::uint32_t* charges, const std::vector<std::int32_t>& places,
             OrderedCharges& out) {
  std::array<std::size_t, kOrders.size() + 1> next{};
  for (std::size_t i = 0; i < kOrders.size(); ++i) {
    const auto of = std::count(places.begin(), places.end(), static_cast<std::int32_t>(i));
    next[i + 1] = out.ends[i] = next[i] + static_cast<std::size_t>(of);
  }
  out.list.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    out.list[next[static_cast<std::size_t>(places[i])]++] = charges[i];
}

void addCharges(const double* charges, const OrderedCharges& some, const LaneSets& sets,
                double* coefficients, LaneRemainders& remainders) {
  HWY_DYNAMIC_DISPATCH(AddCharges)(charges, some, sets, coefficients, remainders);
}

void addCharges(const double* charges, const OrderedCharges& some, double radius,
                StepExpansion& expansion) {
  HWY_DYNAMIC_DISPATCH(AddAboutOne)(charges, some, radius, expansion);
}

}  // namespace innermap::proof
#endif
