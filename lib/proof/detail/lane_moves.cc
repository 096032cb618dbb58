#include <algorithm>
#include <array>

#include "proof/detail/lane_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proof/detail/lane_moves.cc"
#include "hwy/foreach_target.h"  // compiles this file once for each instruction set
#include "proof/detail/lanes-inl.h"

// A move along z mixes no orders m: d/dz L_nm = L_(n+1)m. A turn of the axes mixes no degrees n. So
// a move is, three times, a move along z and a turn that puts x in the place of z, y of x and z of
// y. That is O(P^3) products; the addition theorem (Epton and Dembart 1995) takes O(P^4). After
// White and Head-Gordon, "Rotating around the quartic angular momentum barrier in fast multipole
// method calculations", J. Chem. Phys. 105, 1996, who turn z into the direction of the move.
#ifndef INNERMAP_PROOF_LANE_MOVES_TABLES
#define INNERMAP_PROOF_LANE_MOVES_TABLES
namespace innermap::proof {

// L_nm is (d/dx + i d/dy)^m (d/dz)^(n-m) f at the centre. Write t for d/dx + i d/dy, -1/t for
// d/dx - i d/dy and 1 for d/dz: then t^s stands for L_ns. After the turn L_nm is
// (d/dy + i d/dz)^m (d/dx)^(n-m) f = (-i)^m ((t - 2 + 1/t) / 2)^m ((t - 1/t) / 2)^(n-m).
// A row holds the coefficients of t^s, s >= 0, without (-i)^m. Those of s > 0 stand twice, as t^-s
// has the same up to its sign. They are whole numbers over 2^n: exact.
using TurnRow = std::array<double, kOrder + 1>;

constexpr TurnRow turnRow(int n, int m) {
  constexpr int kMiddle = kOrder + 1, kSize = 2 * kMiddle + 1;
  std::array<double, kSize> power{};
  power[kMiddle] = 1;
  for (int k = 0; k < n; ++k) {
    const double constant = k < m ? -1 : 0, down = k < m ? 0.5 : -0.5;
    std::array<double, kSize> next{};
    for (int s = 1; s + 1 < kSize; ++s)
      next[s] = 0.5 * power[s - 1] + constant * power[s] + down * power[s + 1];
    power = next;
  }
  TurnRow out{};
  for (int s = 0; s <= n; ++s) out[s] = (s == 0 ? 1 : 2) * power[kMiddle + s];
  return out;
}

inline constexpr std::array<TurnRow, kTerms> kTurn = [] {
  std::array<TurnRow, kTerms> out{};
  for (int n = 0; n <= kOrder; ++n)
    for (int m = 0; m <= n; ++m) out[termOf(n, m)] = turnRow(n, m);
  return out;
}();

// Real and imaginary parts of L_nm: those of one order stand side by side, m = 0 has no imaginary
// ones.
constexpr std::size_t kParts = (kOrder + 1) * (kOrder + 1);
constexpr std::size_t columnOf(int m, int part) {
  const int before = m == 0 ? 0 : kOrder + 1 + (m - 1) * (2 * kOrder + 2 - m);
  return static_cast<std::size_t>(before + part * (kOrder + 1 - m));
}
constexpr std::size_t partOf(int n, int m, int part) {
  return columnOf(m, part) + static_cast<std::size_t>(n - m);
}

}  // namespace innermap::proof
#endif

HWY_BEFORE_NAMESPACE();
namespace innermap::proof {
namespace HWY_NAMESPACE {
// NOLINTBEGIN(readability-identifier-naming): named like the functions of Highway.

#if HWY_TARGET == HWY_SCALAR
using D4 = D;
#else
using D4 = hn::CappedTag<double, 4>;
#endif

// Channels of one part, a vector each.
template <class Vector, std::size_t kChannels>
struct Part {
  Vector v[kChannels];
};

template <class Vector, std::size_t kChannels>
HWY_INLINE void AddMultiple(Vector factor, const Part<Vector, kChannels>& x,
                            Part<Vector, kChannels>& sum) {
  for (std::size_t k = 0; k < kChannels; ++k) sum.v[k] = hn::MulAdd(factor, x.v[k], sum.v[k]);
}

// L_nm becomes the sum of shift^k / k! L_(n+k)m.
template <class Tag, class Vector, std::size_t kChannels>
HWY_INLINE void MoveAlongZ(Tag d, Vector shift, int order, Part<Vector, kChannels>* parts) {
  Vector powers[kOrder + 1];
  powers[0] = hn::Set(d, 1.0);
  for (int k = 1; k <= order; ++k) powers[k] = powers[k - 1] * shift * hn::Set(d, 1.0 / k);
  for (int m = 0; m <= order; ++m)
    for (int part = 0; part < (m == 0 ? 1 : 2); ++part) {
      Part<Vector, kChannels>* const column = parts + columnOf(m, part);
      for (int n = 0; n < order - m; ++n) {
        Part<Vector, kChannels> sum = column[n];
        for (int k = 1; k <= order - m - n; ++k) AddMultiple(powers[k], column[n + k], sum);
        column[n] = sum;
      }
    }
}

// Of one degree.
template <class Tag, class Vector, std::size_t kChannels>
HWY_INLINE void TurnDegree(Tag d, int n, Part<Vector, kChannels>* parts) {
  Part<Vector, kChannels> turned[2 * kOrder + 2];
  for (int m = 0; m <= n; ++m) {
    const TurnRow& row = kTurn[termOf(n, m)];
    Part<Vector, kChannels> even, odd;  // sums over even and odd n - m + s
    for (std::size_t k = 0; k < kChannels; ++k) even.v[k] = odd.v[k] = hn::Zero(d);
    const int first = (n - m) % 2;
    for (int s = first; s <= n; s += 2)
      AddMultiple(hn::Set(d, row[s]), parts[partOf(n, s, 0)], even);
    for (int s = first == 0 ? 1 : 2; s <= n; s += 2)
      AddMultiple(hn::Set(d, row[s]), parts[partOf(n, s, 1)], odd);
    // (-i)^m (even + i odd)
    const bool swapped = m % 2 != 0;
    const Vector re = hn::Set(d, m % 4 < 2 ? 1.0 : -1.0);
    const Vector im = hn::Set(d, m % 4 == 0 || m % 4 == 3 ? 1.0 : -1.0);
    for (std::size_t k = 0; k < kChannels; ++k) {
      turned[2 * m].v[k] = re * (swapped ? odd.v[k] : even.v[k]);
      turned[2 * m + 1].v[k] = im * (swapped ? even.v[k] : odd.v[k]);
    }
  }
  parts[partOf(n, 0, 0)] = turned[0];
  for (int m = 1; m <= n; ++m)
    for (int part = 0; part < 2; ++part) parts[partOf(n, m, part)] = turned[2 * m + part];
}

template <class Tag, class Vector, std::size_t kChannels>
HWY_INLINE void Move(Tag d, const Vector (&shift)[3], int order, Part<Vector, kChannels>* parts) {
  for (const int axis : {2, 0, 1}) {  // those that turns bring to z, one after the other
    MoveAlongZ(d, shift[axis], order, parts);
    for (int n = 1; n <= order; ++n) TurnDegree(d, n, parts);
  }
}

// Calls each(its place among the parts, its place among the coefficients of a channel) for all
// parts.
template <class Each>
HWY_INLINE void ForParts(int order, const Each& each) {
  for (int n = 0; n <= order; ++n)
    for (int m = 0; m <= n; ++m)
      for (int part = 0; part < (m == 0 ? 1 : 2); ++part)
        each(partOf(n, m, part), 6 * termOf(n, m) + static_cast<std::size_t>(part));
}

void MoveExpansion(const StepExpansion& from, int order, const LaneSets& sets,
                   double* HWY_RESTRICT coefficients) {
  const D d;
  std::fill_n(coefficients, kCoefficients * kLanes, 0.0);
  Part<V, 3> parts[kParts];
  for (std::size_t lane = 0; lane < kLanes; lane += Side()) {
    V shift[3];
    for (int a = 0; a < 3; ++a)
      shift[a] = hn::Load(d, sets.center[a] + lane) - Number(from.center[a]);
    ForParts(order, [&](std::size_t p, std::size_t c) {
      for (std::size_t k = 0; k < 3; ++k) parts[p].v[k] = Number(from.coefficients[c + 2 * k]);
    });
    Move(d, shift, order, parts);
    double* const out = coefficients + lane * kCoefficients;
    ForParts(order, [&](std::size_t p, std::size_t c) {
      for (std::size_t k = 0; k < 3; ++k) hn::Store(parts[p].v[k], d, out + (c + 2 * k) * Side());
    });
  }
}

// The three channels stand side by side in lanes.
void MoveToOne(const StepExpansion& from, int order, const Vec3& center,
               double* HWY_RESTRICT coefficients) {
  const D4 d;
  using Four = hn::Vec<D4>;
  constexpr std::size_t kSide = hn::MaxLanes(D4()), kVectors = 4 / kSide;
  alignas(32) double channels[4] = {};
  Part<Four, kVectors> parts[kParts];
  ForParts(order, [&](std::size_t p, std::size_t c) {
    for (std::size_t k = 0; k < 3; ++k) channels[k] = from.coefficients[c + 2 * k];
    for (std::size_t v = 0; v < kVectors; ++v) parts[p].v[v] = hn::Load(d, channels + v * kSide);
  });
  const Vec3 way = center - from.center;
  const Four shift[3] = {hn::Set(d, way.x), hn::Set(d, way.y), hn::Set(d, way.z)};
  Move(d, shift, order, parts);
  std::fill_n(coefficients, kCoefficients, 0.0);
  ForParts(order, [&](std::size_t p, std::size_t c) {
    for (std::size_t v = 0; v < kVectors; ++v) hn::Store(parts[p].v[v], d, channels + v * kSide);
    for (std::size_t k = 0; k < 3; ++k) coefficients[c + 2 * k] = channels[k];
  });
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
