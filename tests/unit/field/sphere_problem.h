// A unit ball with a harmonic function on its boundary, for the tests of field/.
#pragma once

#include "core/pi.h"
#include "innermap/field/fit.h"
#include "solve/points.h"

namespace innermap::testing {

inline Matrix harmonicMapValues(const Points& points) {
  Matrix v(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    v(i, 0) = p.x * p.x - p.y * p.y;
    v(i, 1) = p.x * p.y;
    v(i, 2) = p.x + 2 * p.y * p.z;
  }
  return v;
}

inline FitProblem ballProblem(std::size_t collocation) {
  FitProblem p;
  p.surface.points = randomPoints(collocation, 1);
  for (Vec3& q : p.surface.points) q = q / norm(q);
  p.surface.heldOut = spherePoints(400, 1, 2);
  p.surface.values = harmonicMapValues(p.surface.points);
  p.surface.heldOutValues = harmonicMapValues(p.surface.heldOut);
  p.diagonal = std::sqrt(12.0);
  p.area = 4 * kPi;
  p.placeSources = [](std::size_t count, double distance) {
    return spherePoints(count, 1 + distance * std::sqrt(12.0), 1);
  };
  return p;
}

inline HarmonicField someField() {
  Affine affine;
  affine.center = {0.1, 0.2, 1.0 / 3};
  affine.coefficients = Matrix(4, 3);
  for (std::size_t i = 0; i < 12; ++i) affine.coefficients.data()[i] = 1 / (1.0 + i);
  const Points sources = spherePoints(30, 2);
  Matrix weights(30, 3);
  for (std::size_t i = 0; i < 90; ++i) weights.data()[i] = std::sin(i + 1.0);
  return HarmonicField(sources, weights, affine);
}

inline EvaluateFieldSettings withGradients() {
  EvaluateFieldSettings settings;
  settings.gradients = true;
  return settings;
}

}  // namespace innermap::testing
