#include "transfer/detail/ellipsoid_area.h"

#include <algorithm>
#include <cmath>

#include "core/pi.h"

namespace innermap {
namespace {

// Axes thinner than this share of the longest, as a logarithm, add nothing.
constexpr double kThinnest = -150;

// R_F and R_D at once, both by duplication.
struct CarlsonIntegrals {
  double rf = 0, rd = 0;

  CarlsonIntegrals(double x, double y, double z) {
    double sum = 0, power = 1;
    const auto spread = [&] {
      const double mean = (x + y + 3 * z) / 5;
      return std::max({std::abs(mean - x), std::abs(mean - y), std::abs(mean - z)}) / mean;
    };
    for (int k = 0; k < 400 && spread() > 1e-3; ++k) {
      const double rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z);
      const double lambda = rx * ry + ry * rz + rz * rx;
      sum += power / (rz * (z + lambda));
      power /= 4;
      x = (x + lambda) / 4;
      y = (y + lambda) / 4;
      z = (z + lambda) / 4;
    }
    rf = lastF(x, y, z);
    rd = 3 * sum + power * lastD(x, y, z);
  }

 private:
  // Series of the fifth order, whose errors are below spread^6.
  static double lastF(double x, double y, double z) {
    const double a = (x + y + z) / 3, u = 1 - x / a, v = 1 - y / a, w = -u - v;
    const double e2 = u * v - w * w, e3 = u * v * w;
    return (1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44) / std::sqrt(a);
  }
  static double lastD(double x, double y, double z) {
    const double a = (x + y + 3 * z) / 5, u = 1 - x / a, v = 1 - y / a, w = -(u + v) / 3;
    const double e2 = u * v - 6 * w * w, e3 = (3 * u * v - 8 * w * w) * w,
                 e4 = 3 * (u * v - w * w) * w * w, e5 = u * v * w * w * w;
    return (1 - 3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 +
            3 * e5 / 26) /
           (a * std::sqrt(a));
  }
};

}  // namespace

double logEllipsoidArea(const Vec3& logAxes) {
  const double longest = std::max({logAxes.x, logAxes.y, logAxes.z});
  double squares[3];
  for (int k = 0; k < 3; ++k) squares[k] = std::exp(2 * std::max(logAxes[k] - longest, kThinnest));
  double products[3] = {squares[1] * squares[2], squares[2] * squares[0], squares[0] * squares[1]};
  std::sort(products, products + 3);
  // With the middle one last all terms are positive.
  const double x = products[0], y = products[2], z = products[1];
  const CarlsonIntegrals integrals(x, y, z);
  const double twice =
      z * integrals.rf + (z - x) * (y - z) / 3 * integrals.rd + std::sqrt(x * y / z);
  return std::log(2 * kPi * twice) + 2 * longest;
}

}  // namespace innermap
