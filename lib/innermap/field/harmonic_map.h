// A harmonic field of three channels read as a map of space, p -> f(p), and several of them one
// after the other.
#pragma once

#include <cstddef>
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

// Harmonic maps one after the other: f = f_k o ... o f_1.
//
// In space a harmonic map onto a solid need not be one-to-one (Laugesen, "Injectivity can fail for
// higher-dimensional harmonic extensions", 1996). Small harmonic steps through intermediate shapes
// are, each by itself, and so is what they compose to: Schneider and Hormann, "Smooth bijective
// maps between arbitrary planar polygons" (CAGD 2015), who do so in the plane. The whole is no
// longer harmonic; each step is.
//
// Immutable, cheap to copy, safe from any number of threads. World units of the source in, of the
// target out.
class ComposedMap {
 public:
  // One step: the harmonic map itself. Implicit, as it is one in every respect.
  ComposedMap(HarmonicMap map) : steps_{std::move(map)} {}
  // Throws DataError when there is none.
  explicit ComposedMap(std::vector<HarmonicMap> steps);

  const std::vector<HarmonicMap>& steps() const { return steps_; }
  std::size_t sources() const;  // charges of all steps

  Vec3 operator()(const Vec3& p) const;

  // J[r][a] = d f_r / d p_a. Analytic: the product of the steps'.
  Mat3 jacobian(const Vec3& p) const;

  // Positions and Jacobians of a few points on the calling thread, by plain sums (either output may
  // be null).
  void evaluate(const Vec3* points, std::size_t count, Vec3* positions, Mat3* jacobians) const;

  // Values (#points x 3) and, if asked for, gradients (#points x 9, column 3 r + a) on all threads;
  // the accuracy is that of each step. Throws as HarmonicField::evaluate.
  FieldSamples evaluate(const Points& points, const EvaluateFieldSettings& settings = {}) const;

  // What the first step gives becomes what all give: values #points x 3, gradients #points x 9 or
  // empty. Throws as above.
  void finish(FieldSamples& firstStep, const EvaluateFieldSettings& settings) const;

 private:
  std::vector<HarmonicMap> steps_;
};

}  // namespace innermap
