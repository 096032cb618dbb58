// A harmonic function with any number of channels: an affine part plus a sum of point charges.
//
//   f_k(p) = affine_k(p) + sum_j w_jk / |p - q_j|
//
// It satisfies Laplace's equation everywhere but at the sources q_j, so inside a solid that holds
// none of them its largest error is on the boundary (maximum principle).
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"

namespace innermap {

// Three columns of a matrix, from `first` on, as points: #rows.
inline Points pointsOf(const Matrix& m, std::size_t first = 0) {
  Points out(m.rows());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {m(i, first), m(i, first + 1), m(i, first + 2)};
  return out;
}

struct EvaluateFieldSettings {
  // Root mean square error of each channel's values, at most, in their units; of the charges' part
  // of the gradients, a hundred times that relative to them. 0: plain sums, whose error is a few
  // units of rounding times the number of sources. Not negative.
  double accuracy = 0;
  bool gradients = false;
};

// Immutable; copies share their data; safe from any number of threads. World units.
class HarmonicField {
 public:
  // sources: #N; weights: #N x #K; affine.coefficients: 4 x #K. Throws DataError when the sizes
  // disagree, K is 0, or a number is not finite.
  HarmonicField(Points sources, Matrix weights, Affine affine);

  std::size_t channels() const;
  const Points& sources() const;
  const Matrix& weights() const;
  const Affine& affine() const;

  // Values (#points x #K) and, if asked for, gradients (#points x 3 #K; column 3 k + axis) on all
  // threads. Throws SettingError for a negative accuracy, Cancelled; with fast sums as FastSum::at.
  FieldSamples evaluate(const Points& points, const EvaluateFieldSettings& settings = {}) const;

  // The same at the points of a lattice, block by block; see FastSum::onLattice.
  void onLattice(const LatticeBlocks& lattice, const BlockVisitor& visit,
                 const EvaluateFieldSettings& settings, std::string_view stage = {}) const;

  // By plain sums for a few points on the calling thread: values[k * count + i],
  // gradients[(3 * k + axis) * count + i]; gradients may be null. Overwrites.
  void evaluate(const Vec3* points, std::size_t count, double* values, double* gradients) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// A harmonic field of three channels read as a map of space, p -> f(p), and several of them one
// after the other.

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
