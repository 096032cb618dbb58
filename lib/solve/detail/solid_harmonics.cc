#include "solve/detail/solid_harmonics.h"

#include <algorithm>
#include <cmath>

#include "solve/detail/expansion_simd.h"
#include "solve/detail/kernel_simd.h"

namespace innermap {

SolidHarmonics::SolidHarmonics(int order)
    : order_(order), count_(static_cast<std::size_t>(order + 1) * (order + 1)) {
  setRecurrence();
  setDerivatives();
  parity_.resize(count_);
  for (int m = 0; m <= order; ++m)
    for (int n = m; n <= order; ++n) {
      const int z = (n - m) % 2 ? 4 : 0;
      parity_[index(n, m, false)] = z + (m % 2 ? 1 : 0);
      if (m > 0) parity_[index(n, m, true)] = z + 2 + (m % 2 ? 0 : 1);
    }
}

// Functions stand by m, then n, cosine before sine: the order of the recurrence.
std::size_t SolidHarmonics::index(int n, int m, bool sine) const {
  if (m == 0) return static_cast<std::size_t>(n);
  // m = 0 has order + 1 functions, every m' in 1..m-1 twice order + 1 - m'.
  const int before = order_ + 1 + (m - 1) * (2 * (order_ + 1) - m);
  return static_cast<std::size_t>(before + 2 * (n - m) + (sine ? 1 : 0));
}

// s_nm: root of the mean square over the unit sphere before normalisation.
double SolidHarmonics::scale(int n, int m) const {
  return std::sqrt((m > 0 ? 0.5 : 1.0) / (2 * n + 1)) *
         std::exp(-0.5 * (std::lgamma(n + m + 1) + std::lgamma(n - m + 1)));
}

// N_mm = a (x + i y) N_(m-1)(m-1); then N_(n+1)m = a z N_nm - b r^2 N_(n-1)m for n = m, m + 1, ...
void SolidHarmonics::setRecurrence() {
  for (int m = 0; m <= order_; ++m) {
    recurrence_.push_back(m == 0 ? 1 : scale(m - 1, m - 1) / (2 * m * scale(m, m)));
    recurrence_.push_back(0);
    for (int n = m; n < order_; ++n) {
      const double divisor = (n + 1.0) * (n + 1.0) - 1.0 * m * m;
      recurrence_.push_back((2 * n + 1) / divisor * scale(n, m) / scale(n + 1, m));
      recurrence_.push_back(n > m ? scale(n - 1, m) / (divisor * scale(n + 1, m)) : 0);
    }
  }
}

// With U = C + i S before normalisation: dU_n^m/dz = U_(n-1)^m, dU_n^m/dx = (U_(n-1)^(m-1) -
// U_(n-1)^(m+1)) / 2, dU_n^m/dy = i (U_(n-1)^(m-1) + U_(n-1)^(m+1)) / 2, where U^(-1) = -conj U^1.
void SolidHarmonics::setDerivatives() {
  const auto add = [&](int axis, int n, int m, bool sine, int toM, bool toSine, double factor) {
    if (toM > n - 1 || (toM == 0 && toSine)) return;
    derivative_[axis].push_back(
        {index(n, m, sine), index(n - 1, toM, toSine), factor * scale(n - 1, toM) / scale(n, m)});
  };
  for (int n = 1; n <= order_; ++n) {
    add(2, n, 0, false, 0, false, 1);
    add(0, n, 0, false, 1, false, -1);
    add(1, n, 0, false, 1, true, -1);
    for (int m = 1; m <= n; ++m)
      for (const bool sine : {false, true}) {
        add(2, n, m, sine, m, sine, 1);
        add(0, n, m, sine, m - 1, sine, 0.5);
        add(0, n, m, sine, m + 1, sine, -0.5);
        add(1, n, m, sine, m - 1, !sine, sine ? 0.5 : -0.5);
        add(1, n, m, sine, m + 1, !sine, sine ? 0.5 : -0.5);
      }
  }
}

void SolidHarmonics::fill(const double* x, const double* y, const double* z, std::size_t points,
                          double* out, std::size_t stride) const {
  simd::solidHarmonics(order_, recurrence_.data(), x, y, z, points, out, stride);
}

Matrix SolidHarmonics::at(const Points& points) const {
  const std::size_t padded = simd::padded(points.size());
  std::vector<double> x(padded), y(padded), z(padded), all(padded * count_);
  for (std::size_t i = 0; i < points.size(); ++i) {
    x[i] = points[i].x;
    y[i] = points[i].y;
    z[i] = points[i].z;
  }
  fill(x.data(), y.data(), z.data(), points.size(), all.data(), padded);
  Matrix out(points.size(), count_);
  for (std::size_t c = 0; c < count_; ++c)
    std::copy_n(all.data() + c * padded, points.size(), out.column(c));
  return out;
}

void SolidHarmonics::derivative(int axis, const double* coefficients, double* out) const {
  std::fill_n(out, count_, 0.0);
  for (const Term& t : derivative_[axis]) out[t.to] += t.factor * coefficients[t.from];
}

}  // namespace innermap
