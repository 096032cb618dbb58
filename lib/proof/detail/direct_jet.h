// A harmonic map about a point by plain sums over all its charges, one after the other, with bounds
// of what rounding and the rest of its series may be. It shares nothing with the trees of
// expansions that proofs are made with, so that it can check them.
//
// With d_j the distance of a charge q_j from c, phi = 1 / |. - q_j|: the n-th derivative of phi
// along a unit vector is n! P_n / d^(n+1) in size, at most n! / d^(n+1); as a symmetric multilinear
// form it is no larger (Banach, "Über homogene Polynome in (L^2)", 1938). Taylor's formula about c
// then has on the ball |t| <= R, with s_j = d_j - R,
//
//   |f_k(c + t) - f_k(c) - g_k t - t H_k t / 2|  <=  sum_j |w_jk| R^3 / s_j^4
//   |grad f_k(c + t) - g_k - H_k t|              <=  sum_j |w_jk| 3 R^2 / s_j^4
#pragma once

#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"

namespace innermap::proof {

// Symmetric: xx, xy, xz, yy, yz, zz.
using Hessian = std::array<double, 6>;
constexpr int kHessianPlace[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

// Of channel k: numbers as computed, and how far from them the exact ones are at most, by entry.
struct DirectJet {
  bool known = false;  // false where a charge lies in the ball, or a number is out of range
  std::array<double, 3> value{}, valueError{};
  Mat3 gradient{};
  std::array<double, 3> gradientError{};
  std::array<Hessian, 3> hessian{};
  std::array<double, 3> hessianError{};
  // What the series above leave out, on the ball.
  std::array<double, 3> valueRest{}, gradientRest{};
};

// About c, for the ball of that radius, 0 or more. World units.
DirectJet directJet(const HarmonicField& field, const Vec3& c, double radius);

}  // namespace innermap::proof
