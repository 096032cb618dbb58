#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/transfer/carry.h"
#include "solve/lapack_status.h"

namespace innermap {
namespace {

Vec3 mean(const Points& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

Mat3 rotationOf(double w, double x, double y, double z) {
  return {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

}  // namespace

Vec3 RigidMotion::operator()(const Vec3& p) const { return rotation * p + translation; }

bool isRigid(const RigidMotion& motion, double tolerance) {
  const Mat3 gram = product(motion.rotation, transposed(motion.rotation));
  double off = std::abs(determinant(motion.rotation) - 1);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(gram[r][c] - (r == c ? 1 : 0)));
  return off <= tolerance;
}

RigidMotion bestRigidMotion(const Points& from, const Points& to) {
  if (from.size() != to.size() || from.size() < 3)
    throw DataError("rigid motion: takes at least three pairs of points");
  const Vec3 a = mean(from), b = mean(to);
  Mat3 s{};
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 p = from[i] - a, q = to[i] - b;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) s[r][c] += p[r] * q[c];
  }
  // Horn's symmetric matrix; the quaternion is its eigenvector of the largest eigenvalue.
  double n[16] = {s[0][0] + s[1][1] + s[2][2],
                  s[1][2] - s[2][1],
                  s[2][0] - s[0][2],
                  s[0][1] - s[1][0],
                  0,
                  s[0][0] - s[1][1] - s[2][2],
                  s[0][1] + s[1][0],
                  s[2][0] + s[0][2],
                  0,
                  0,
                  s[1][1] - s[0][0] - s[2][2],
                  s[1][2] + s[2][1],
                  0,
                  0,
                  0,
                  s[2][2] - s[0][0] - s[1][1]};
  double values[4];
  if (!lapackSucceeded(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 4, n, 4, values)))
    throw DataError("rigid motion: the points are not finite");
  RigidMotion out;
  out.rotation = rotationOf(n[3], n[7], n[11], n[15]);
  out.translation = b - out.rotation * a;
  return out;
}

}  // namespace innermap
