// A harmonic field of three channels read as a map of space: p -> f(p).
#pragma once

#include <utility>
#include <vector>

#include "innermap/field/harmonic_field.h"

namespace innermap {

// Immutable; safe from any number of threads. World units of the source in, of the target out.
class HarmonicMap {
 public:
  // Throws DataError unless the field has three channels.
  explicit HarmonicMap(HarmonicField field);

  const HarmonicField& field() const { return field_; }

  Vec3 operator()(const Vec3& p) const;

  // Row r is the gradient of component r: J[r][a] = d f_r / d p_a. Analytic.
  Mat3 jacobian(const Vec3& p) const;

  // Positions and Jacobians of a few points on the calling thread (either output may be null).
  void evaluate(const Vec3* points, std::size_t count, Vec3* positions, Mat3* jacobians) const;

 private:
  HarmonicField field_;
};

}  // namespace innermap
