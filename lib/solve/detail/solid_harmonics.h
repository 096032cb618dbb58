// Real regular solid harmonics, the harmonic polynomials that expansions are
// written in, up to a given order.
//
//   N_nm(x) = r^n P_n^m(cos theta) {cos, sin}(m phi) / ((n + m)! s_nm),
//
// where s_nm makes the mean square over the unit sphere 1 (Hobson, "The Theory of Spherical and
// Ellipsoidal Harmonics", 1931; the derivatives as in Epton and Dembart, "Multipole Translation
// Theory for the Three-Dimensional Laplace and Helmholtz Equations", SIAM J. Sci. Comput. 1995).
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap {

class SolidHarmonics {
 public:
  explicit SolidHarmonics(int order);  // in [0, 40]

  int order() const { return order_; }
  std::size_t count() const { return count_; }  // (order + 1)^2 functions

  // out[c * stride + i]: function c at point i. `x`, `y`, `z`: readable up to the next multiple of
  // simd::kPadding points, `out` writable as far; stride at least that.
  void fill(const double* x, const double* y, const double* z, std::size_t points, double* out,
            std::size_t stride) const;

  // #points x #functions.
  Matrix at(const Points& points) const;

  // Coefficients of the derivative along `axis` of the polynomial with these ones.
  void derivative(int axis, const double* coefficients, double* out) const;

  // Bit a is set when function c is odd along axis a.
  int parity(std::size_t c) const { return parity_[c]; }

 private:
  struct Term {
    std::size_t from, to;
    double factor;
  };
  std::size_t index(int n, int m, bool sine) const;
  void setRecurrence();
  void setDerivatives();
  double scale(int n, int m) const;

  int order_;
  std::size_t count_;
  std::vector<double> recurrence_;  // two numbers for each (m, n), in the order they are needed
  std::vector<Term> derivative_[3];
  std::vector<int> parity_;
};

}  // namespace innermap
