// Maps made for the tests of proof/, and what plain sums in long double say of them.
#pragma once

#include <array>
#include <cmath>

#include "core/random.h"
#include "field/affine_map.h"
#include "innermap/field/harmonic_field.h"
#include "solve/points.h"

namespace innermap::testing {

using test::affineOf;
using test::kIdentity;

struct Charge {
  Vec3 place, weight;
};

inline HarmonicMap mapOf(const Affine& affine, const std::vector<Charge>& charges) {
  Points places;
  Matrix weights(charges.size(), 3);
  for (std::size_t i = 0; i < charges.size(); ++i) {
    places.push_back(charges[i].place);
    for (int k = 0; k < 3; ++k) weights(i, k) = charges[i].weight[k];
  }
  return HarmonicMap(HarmonicField(places, weights, affine));
}

// On a sphere, weights up to `strength`.
inline std::vector<Charge> chargesAbout(std::size_t count, double radius, double strength,
                                        std::uint64_t seed) {
  const Points places = spherePoints(count, radius, static_cast<double>(seed));
  const Matrix weights = randomWeights(count, 3, seed);
  std::vector<Charge> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back({places[i], strength * Vec3{weights(i, 0), weights(i, 1), weights(i, 2)}});
  return out;
}

using LongMat3 = std::array<std::array<long double, 3>, 3>;

inline LongMat3 longJacobian(const HarmonicMap& map, const Vec3& p) {
  LongMat3 j{};
  const HarmonicField& f = map.field();
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) j[k][a] = f.affine().coefficients(1 + a, k);
  for (std::size_t i = 0; i < f.sources().size(); ++i) {
    long double d[3], square = 0;
    for (int a = 0; a < 3; ++a) {
      d[a] = static_cast<long double>(p[a]) - f.sources()[i][a];
      square += d[a] * d[a];
    }
    const long double cube = square * std::sqrt(square);
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a) j[k][a] -= f.weights()(i, k) * d[a] / cube;
  }
  return j;
}

inline long double longDeterminant(const LongMat3& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
         m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

inline long double longDeterminant(const HarmonicMap& map, const Vec3& p) {
  return longDeterminant(longJacobian(map, p));
}

// The charge at `place` that makes the determinant at p -margin times what it was.
inline Charge foldingCharge(const HarmonicMap& map, const Vec3& p, const Vec3& place,
                            double margin) {
  const Vec3 d = p - place;
  const double r = norm(d);
  const Vec3 g = (-1 / (r * r * r)) * d;  // the gradient of 1/|x - place|
  return {place, (-(1 + margin) / squaredNorm(g)) * (map.jacobian(p) * g)};
}

}  // namespace innermap::testing
