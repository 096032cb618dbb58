// What expansions say at a point.
#pragma once

#include <algorithm>
#include <cmath>

#include "innermap/core/vec3.h"
#include "proof/detail/lane_kernels.h"

namespace innermap::testing {

struct ValueAndGradient {
  Vec3 value;
  Mat3 gradient{};
};

inline ValueAndGradient evaluate(const proof::StepExpansion& from, const Vec3& p) {
  double c[proof::kCoefficients];
  proof::moveExpansion(from, proof::kOrder, p, c);
  ValueAndGradient out;
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](int n, int m, int part) {
      return c[6 * proof::termOf(n, m) + 2 * k + part];
    };
    out.value[k] = at(0, 0, 0);
    out.gradient[k] = {at(1, 1, 0), at(1, 1, 1), at(1, 0, 0)};
  }
  return out;
}

// What coefficients for eight sets say at the centre of one of them.
inline ValueAndGradient inLane(const double* coefficients, proof::LaneSets sets, std::size_t lane) {
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) std::fill_n(sets.vertex[i][a], proof::kLanes, i == a ? 1.0 : 0.0);
  proof::LaneFindings found{};
  proof::examine(coefficients, {}, sets, found);
  ValueAndGradient out;
  for (int k = 0; k < 3; ++k) {
    out.value[k] = found.image.center[k][lane];
    for (int i = 0; i < 3; ++i) out.gradient[k][i] = found.image.vertex[i][k][lane];
  }
  return out;
}

inline double largestDifference(const Mat3& a, const Mat3& b) {
  double out = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out = std::max(out, std::abs(a[r][c] - b[r][c]));
  return out;
}

}  // namespace innermap::testing
