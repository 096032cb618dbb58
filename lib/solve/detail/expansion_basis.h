// Far fields as numbers: how charges in a ball become a few proxy charges, and
// how potentials at a few points about a ball of targets become a harmonic polynomial inside it.
//
// Both stand on points of a Fibonacci spiral on the sphere, a twentieth or more above the number of
// harmonics, and on one least-squares matrix of those (kernel-independent in the sense of Ying,
// Biros and Zorin, "A Kernel-Independent Adaptive Fast Multipole Algorithm in Two and Three
// Dimensions", J. Comput. Phys. 2004, but with polynomials for one of the two spheres, whose
// condition does not grow with the order). Proxies and check points stand well inside their balls:
// that damps what the finite number of points cannot tell apart, at the price of a factor
// kSphere^-order in rounding.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "innermap/core/vec3.h"
#include "solve/detail/solid_harmonics.h"

namespace innermap {

class ExpansionBasis {
 public:
  // The basis of the order, built once. order in [0, kMostOrder].
  static std::shared_ptr<const ExpansionBasis> get(int order);

  explicit ExpansionBasis(int order);

  const SolidHarmonics& harmonics() const { return harmonics_; }
  // Points on the sphere, in units of the ball's radius; count a multiple of simd::kRows.
  std::size_t pointCount() const { return points_.size(); }
  const Points& points() const { return points_; }
  // Functions, padded with zeros to a multiple of simd::kRows.
  std::size_t paddedCount() const { return padded_; }

  // Coefficients (paddedCount() x 3) of the polynomial with these values (pointCount() x 3) at
  // points(). Adds.
  void coefficients(const double* values, double* out) const;

  // Weights (pointCount() x 3) of charges at points() with these moments (paddedCount() x 3): sums
  // of weight times N_nm(position / radius) over the charges they stand for. Adds.
  void proxyWeights(const double* moments, double* out) const;

  static constexpr int kMostOrder = 30;

 private:
  SolidHarmonics harmonics_;
  Points points_;
  std::size_t padded_ = 0;
  std::vector<double> toCoefficients_, toProxies_;
};

}  // namespace innermap
