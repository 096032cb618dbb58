#include "innermap/solve/detail/dipole_moments.h"

#include <cmath>

#include "innermap/solve/detail/kernel_simd.h"

namespace innermap {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Gauss-Legendre nodes and weights on [0, 1], by Newton's method on the Legendre polynomial.
std::vector<std::array<double, 2>> gaussRule(int n) {
  std::vector<std::array<double, 2>> out;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double p = 1, before = 0;
      for (int k = 0; k < n; ++k) {
        const double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    out.push_back({0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)});
  }
  return out;
}

}  // namespace

// The square's product rule collapsed to the triangle: one degree goes into the determinant.
DipoleMoments::DipoleMoments(const SolidHarmonics& harmonics) : harmonics_(harmonics) {
  const auto line = gaussRule(harmonics.order() / 2 + 1);
  for (const auto& u : line)
    for (const auto& v : line) rule_.push_back({u[0], (1 - u[0]) * v[0], u[1] * v[1] * (1 - u[0])});
}

void DipoleMoments::add(const Corners* triangles, std::size_t count, const Ball& ball,
                        double* moments) const {
  const std::size_t points = rule_.size(), rows = simd::padded(points),
                    functions = harmonics_.count();
  std::vector<double> x(rows), y(rows), z(rows), h(rows * functions), sums(3 * functions, 0.0);
  for (std::size_t t = 0; t < count; ++t) {
    const Corners& c = triangles[t];
    const Vec3 area = cross(c[1] - c[0], c[2] - c[0]);
    for (std::size_t i = 0; i < points; ++i) {
      const Vec3 p = c[0] + rule_[i][0] * (c[1] - c[0]) + rule_[i][1] * (c[2] - c[0]) - ball.center;
      x[i] = p.x / ball.radius;
      y[i] = p.y / ball.radius;
      z[i] = p.z / ball.radius;
    }
    harmonics_.fill(x.data(), y.data(), z.data(), points, h.data(), rows);
    for (std::size_t f = 0; f < functions; ++f) {
      double mean = 0;
      for (std::size_t i = 0; i < points; ++i) mean += rule_[i][2] * h[f * rows + i];
      for (int a = 0; a < 3; ++a)
        sums[static_cast<std::size_t>(a) * functions + f] -= mean * area[a] / ball.radius;
    }
  }
  for (int a = 0; a < 3; ++a)
    harmonics_.addAdjointDerivative(a, sums.data() + static_cast<std::size_t>(a) * functions,
                                    moments);
}

}  // namespace innermap
