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

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/affine.h"
#include "innermap/solve/fast_sum.h"
#include "innermap/solve/kernel_sum.h"

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

}  // namespace innermap
