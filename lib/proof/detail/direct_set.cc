#include "proof/detail/direct_set.h"

#include "proof/detail/direct_jet.h"

namespace innermap::proof {
namespace {

Interval determinantOf(const Interval m[3][3]) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
         m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Interval lengthOf(const Interval v[3]) {
  return squareRoot(square(v[0]) + square(v[1]) + square(v[2]));
}

double radiusOf(const DirectSet& set) {
  Interval most;
  for (const Vec3& v : set.vertex) {
    const Interval all[3] = {v.x, v.y, v.z};
    most.upper = std::max(most.upper, lengthOf(all).upper);
  }
  return (most + set.slack).upper;
}

// How far the sum over b of second[b] y_b can be from 0 for y about the set's centre.
Interval reach(const Interval second[3], const DirectSet& set) {
  double most = 0;
  for (const Vec3& v : set.vertex)
    most = std::max(most, (second[0] * v.x + second[1] * v.y + second[2] * v.z).magnitude());
  return Interval(most) + Interval(lengthOf(second).upper) * set.slack;
}

// Of J on the set, times b from the left: near the unit matrix, so that no entry's width counts
// much (Krawczyk's way). b is any matrix.
Interval determinantOn(const DirectJet& jet, const DirectSet& set, double radius) {
  const Mat3 b = inverse(jet.gradient);
  Interval turned[3][3], left[3][3];
  for (int r = 0; r < 3; ++r)
    for (int a = 0; a < 3; ++a) {
      Interval entry, second[3], rest;
      for (int k = 0; k < 3; ++k) {
        entry += Interval(b[r][k]) * (Interval(jet.gradient[k][a]) + within(jet.gradientError[k]));
        for (int c = 0; c < 3; ++c)
          second[c] += Interval(b[r][k]) * jet.hessian[k][kHessianPlace[a][c]];
        rest += Interval(std::abs(b[r][k])) *
                (Interval(jet.gradientRest[k]) + Interval(2 * jet.hessianError[k]) * radius);
      }
      turned[r][a] = entry + within((reach(second, set) + rest).upper);
      left[r][a] = b[r][a];
    }
  return determinantOf(turned) / determinantOf(left);
}

// Of channel k beside its linear part: how far it can be from that.
Interval restOf(const DirectJet& jet, int k, double radius) {
  Interval squares;
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c)
      squares +=
          square(Interval(jet.hessian[k][kHessianPlace[a][c]]) + within(jet.hessianError[k]));
  return Interval(jet.valueError[k]) + Interval(2 * jet.gradientError[k]) * radius +
         Interval(0.5) * squareRoot(squares) * radius * radius + Interval(jet.valueRest[k]);
}

void takeImage(const DirectJet& jet, double radius, DirectSet& set) {
  Interval norm, rest[3];
  for (int k = 0; k < 3; ++k) {
    for (int a = 0; a < 3; ++a) norm += square(Interval(jet.gradient[k][a]));
    rest[k] = restOf(jet, k, radius);
  }
  double rounded = 0;
  for (Vec3& v : set.vertex) {
    Vec3 moved;
    Interval off[3];
    for (int k = 0; k < 3; ++k) {
      const auto& g = jet.gradient[k];
      const Interval exact = Interval(g[0]) * v.x + Interval(g[1]) * v.y + Interval(g[2]) * v.z;
      moved[k] = g[0] * v.x + g[1] * v.y + g[2] * v.z;
      off[k] = exact - moved[k];
    }
    rounded = std::max(rounded, lengthOf(off).upper);
    v = moved;
  }
  set.slack = (squareRoot(norm) * set.slack + Interval(rounded) + lengthOf(rest)).upper;
  set.center = {jet.value[0], jet.value[1], jet.value[2]};
}

}  // namespace

DirectSet directSet(const ProofCell& cube) {
  const Vec3& c = cube.center;
  const double off = std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  const double half = cube.halfEdge * (1 + 4e-16) + 4e-16 * off;
  return {
      c, {{{half, half, half}, {half, half, -half}, {half, -half, half}, {-half, half, half}}}, 0};
}

bool throughStep(const HarmonicField& step, DirectSet& set, Interval* determinant) {
  const double radius = radiusOf(set);
  if (!std::isfinite(radius)) return false;
  const DirectJet jet = directJet(step, set.center, radius);
  if (!jet.known) return false;
  if (determinant) *determinant = determinantOn(jet, set, radius);
  takeImage(jet, radius, set);
  return std::isfinite(set.slack);
}

std::size_t mostParts(const ComposedMap& map, std::uint64_t charges) {
  constexpr std::uint64_t kStep = 700;  // the intervals of a step cost as much as so many charges
  return 1 + charges / (map.sources() + kStep * map.steps().size());
}

}  // namespace innermap::proof
