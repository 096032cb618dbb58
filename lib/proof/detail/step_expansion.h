// One step's map about a point: an expansion in regular solid harmonics that is exact up to
// kOrder for the charges it holds, and a list of those that it does not hold yet.
//
//   f(c + x) = sum_{n <= kOrder} sum_{|m| <= n} L_nm conj(R_nm(x)) + what is cut off + near charges
//   R_nm(x) = r^n P_n^m(cos theta) e^(i m phi) / (n + m)!,   L_n(-m) = (-1)^m conj(L_nm)
//
// (Hobson, "The Theory of Spherical and Ellipsoidal Harmonics", 1931; P_n^m without the sign
// (-1)^m. Moves: lane_moves.cc.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap::proof {

constexpr int kOrder = 9;
constexpr std::size_t kTerms = (kOrder + 1) * (kOrder + 2) / 2;  // pairs (n, m), 0 <= m <= n
// Places that are looked at together: the children of a cell.
constexpr std::size_t kLanes = 8;

constexpr std::size_t termOf(int n, int m) { return static_cast<std::size_t>(n * (n + 1) / 2 + m); }

// The squares of a degree's coefficients, times these, sum to that of its norm in Schmidt's basis.
inline constexpr std::array<double, kTerms> kSchmidt = [] {
  const auto factorial = [](int n) {
    double out = 1;
    for (int i = 2; i <= n; ++i) out *= i;
    return out;
  };
  std::array<double, kTerms> out{};
  for (int n = 0; n <= kOrder; ++n)
    for (int m = 0; m <= n; ++m)
      out[termOf(n, m)] = (m == 0 ? 1.0 : 2.0) / (factorial(n - m) * factorial(n + m));
  return out;
}();

// Real numbers of an expansion of three channels: place (2 (3 t + channel) + part).
constexpr std::size_t kCoefficients = 6 * kTerms;

// What holds on the whole set that an expansion is for.
struct Remainder {
  double gradient = 0, value = 0;  // at most: of what is cut off
  // Sums of the absolute values of all terms, which rounding errors are relative to.
  double gradientMagnitude = 0, valueMagnitude = 0;
};

struct StepExpansion {
  Vec3 center;
  std::vector<double> coefficients;  // kCoefficients
  Remainder remainder;
  std::vector<std::uint32_t> near;  // charges
};

}  // namespace innermap::proof
