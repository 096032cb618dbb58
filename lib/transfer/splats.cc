// Gaussian splats through a map: transfer/geometry.h says how.
#include <cmath>
#include <utility>

#include "innermap/transfer/geometry.h"
#include "transfer/detail/colour_harmonics.h"
#include "transfer/detail/ellipsoid_area.h"

namespace innermap {
namespace {

using Columns = std::array<Vec3, 3>;

// Thinner than the longest axis by this, as a logarithm, an axis no longer plays a part in the
// others.
constexpr double kThinnest = -150;
constexpr double kMostAlpha = 0.99;
constexpr double kNoise = 1e-5;  // of cross sections, by the Jacobians' errors
// Axes count as orthogonal whose cosine is below: a rigid motion that was fitted is to turn axes of
// equal scales and not to mix them. Floats of files tell no more.
constexpr double kOrthogonal = 1e-10;

// Turns the columns within their span until they are orthogonal, and those of `with` by the same
// rotation, by angles of at most 45 degrees, so that each stays the nearest to what it was.
// One-sided Jacobi: also columns of very unlike lengths keep all their digits (Demmel and Veselic,
// "Jacobi's method is more accurate than QR", 1992).
void makeOrthogonal(Columns& columns, double cosine, Columns* with) {
  const auto rotate = [](Vec3& a, Vec3& b, double c, double s) {
    const Vec3 before = a;
    a = c * a - s * b;
    b = s * before + c * b;
  };
  bool turned = true;
  for (int sweep = 0; turned && sweep < 30; ++sweep) {
    turned = false;
    for (const auto& [i, j] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      Vec3 &a = columns[static_cast<std::size_t>(i)], &b = columns[static_cast<std::size_t>(j)];
      const double aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
      if (!(std::abs(ab) > cosine * std::sqrt(aa * bb))) continue;
      const double zeta = (bb - aa) / (2 * ab);
      const double t = std::copysign(1 / (std::abs(zeta) + std::sqrt(1 + zeta * zeta)), zeta);
      const double c = 1 / std::sqrt(1 + t * t);
      rotate(a, b, c, c * t);
      if (with)
        rotate((*with)[static_cast<std::size_t>(i)], (*with)[static_cast<std::size_t>(j)], c,
               c * t);
      turned = true;
    }
  }
}

// Unit vectors of orthogonal columns, right-handed: the shortest one's sign, which noise may have
// set, gives way. False where two of them are too short to tell.
bool axesOf(const Columns& columns, const Vec3& lengths, Columns& axes) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (lengths[k] < lengths[least]) least = k;
  const auto i = static_cast<std::size_t>((least + 1) % 3), j = (i + 1) % 3;
  axes[i] = columns[i] / lengths[static_cast<int>(i)];
  axes[j] = columns[j] / lengths[static_cast<int>(j)];
  axes[static_cast<std::size_t>(least)] = cross(axes[i], axes[j]);
  return std::abs(dot(axes[i], axes[j])) < 1e-6;  // false for NaN
}

Mat3 matrixOf(const Columns& c) {
  return {{{c[0].x, c[1].x, c[2].x}, {c[0].y, c[1].y, c[2].y}, {c[0].z, c[1].z, c[2].z}}};
}

Columns columnsOf(const Mat3& m) {
  const Mat3 t = transposed(m);
  Columns out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = {t[k][0], t[k][1], t[k][2]};
  return out;
}

// The orthogonal factor of J = R P.
bool polarFactor(const Mat3& jacobian, Mat3& r) {
  Columns left = columnsOf(jacobian), right = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, axes;
  makeOrthogonal(left, 1e-14, &right);
  const Vec3 lengths{norm(left[0]), norm(left[1]), norm(left[2])};
  if (!axesOf(left, lengths, axes)) return false;
  // In axesOf() the shortest lost its sign.
  if (determinant(jacobian) < 0)
    for (std::size_t k = 0; k < 3; ++k)
      if (dot(axes[k], left[k]) < 0) axes[k] = -axes[k];
  r = product(matrixOf(axes), transposed(matrixOf(right)));
  return true;
}

Mat3 rotationOf(const std::array<double, 4>& q, double length) {
  const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

// By its largest component: Shepperd, "Quaternion from rotation matrix", 1978.
std::array<double, 4> quaternionOf(const Mat3& m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  const double squares[4] = {1 + trace, 1 + 2 * m[0][0] - trace, 1 + 2 * m[1][1] - trace,
                             1 + 2 * m[2][2] - trace};
  int k = 0;
  for (int i = 1; i < 4; ++i)
    if (squares[i] > squares[k]) k = i;
  const double root = std::sqrt(squares[k]), by = 0.5 / root;
  std::array<double, 4> q;
  if (k == 0) {
    q = {0, by * (m[2][1] - m[1][2]), by * (m[0][2] - m[2][0]), by * (m[1][0] - m[0][1])};
  } else if (k == 1) {
    q = {by * (m[2][1] - m[1][2]), 0, by * (m[0][1] + m[1][0]), by * (m[0][2] + m[2][0])};
  } else if (k == 2) {
    q = {by * (m[0][2] - m[2][0]), by * (m[0][1] + m[1][0]), 0, by * (m[1][2] + m[2][1])};
  } else {
    q = {by * (m[1][0] - m[0][1]), by * (m[0][2] + m[2][0]), by * (m[1][2] + m[2][1]), 0};
  }
  q[static_cast<std::size_t>(k)] = 0.5 * root;
  return q;
}

double lengthOf(const std::array<double, 4>& q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

// growth: by what the Jacobian was divided.
bool carryShape(const Mat3& jacobian, double growth, Splat& splat) {
  const double length = lengthOf(splat.quaternion);
  Columns columns = columnsOf(product(jacobian, rotationOf(splat.quaternion, length))), axes;
  const Vec3 s = splat.logScales;
  const double longest = std::max({s.x, s.y, s.z});
  Vec3 beyond, lengths;
  for (int k = 0; k < 3; ++k) {
    beyond[k] = std::min(0.0, s[k] - longest - kThinnest);
    columns[static_cast<std::size_t>(k)] =
        std::exp(s[k] - longest - beyond[k]) * columns[static_cast<std::size_t>(k)];
  }
  makeOrthogonal(columns, kOrthogonal, nullptr);
  for (int k = 0; k < 3; ++k)
    lengths[k] = std::max(norm(columns[static_cast<std::size_t>(k)]), 1e-300);
  if (!axesOf(columns, lengths, axes)) return false;
  for (int k = 0; k < 3; ++k)
    splat.logScales[k] = std::log(lengths[k]) + std::log(growth) + longest + beyond[k];
  std::array<double, 4> q = quaternionOf(matrixOf(axes));
  double side = 0;
  for (std::size_t k = 0; k < 4; ++k) side += q[k] * splat.quaternion[k];
  for (std::size_t k = 0; k < 4; ++k)
    splat.quaternion[k] = (side < 0 ? -length : length) / lengthOf(q) * q[k];
  return true;
}

// log(1 / (1 + e^-x))
double logSigmoid(double x) {
  return x < 0 ? x - std::log1p(std::exp(x)) : -std::log1p(std::exp(-x));
}

// The logit of `ratio` times alpha, at most that of the limit.
double grownOpacity(double logit, double logRatio, bool& capped) {
  const double limit = std::max(logit, std::log(kMostAlpha / (1 - kMostAlpha)));
  const double logAlpha = logSigmoid(logit) + logRatio, above = logAlpha - logSigmoid(limit);
  capped = above > kNoise;
  if (above > 0) return limit;
  if (!std::isfinite(logAlpha)) return logit;  // alpha is 0
  // 1 - ratio alpha without the digits that alpha near 1 costs.
  const double rest =
      std::exp(logSigmoid(-logit)) - std::expm1(logRatio) * std::exp(logSigmoid(logit));
  return logAlpha - std::log(rest);
}

double largestEntry(const Mat3& m) {
  double out = 0;
  for (const auto& row : m)
    for (const double value : row)
      out = std::isfinite(value) ? std::max(out, std::abs(value)) : INFINITY;
  return out;
}

}  // namespace

CarriedSplat carriedSplat(const Mat3& jacobian, const Splat& splat, SplatOpacity opacity) {
  CarriedSplat out{splat, false};
  const double growth = largestEntry(jacobian);
  if (!std::isfinite(growth) || !(growth > 0)) return out;
  Mat3 j = jacobian, r;
  for (auto& row : j)
    for (double& value : row) value /= growth;
  if (!polarFactor(j, r) || !carryShape(j, growth, out.splat)) return {splat, false};
  if (splat.degree > 0) {
    const HarmonicTurn turn(r, splat.degree);
    const int each = (splat.degree + 1) * (splat.degree + 1) - 1;
    for (int colour = 0; colour < 3; ++colour)
      turn.turn(&out.splat.harmonics[static_cast<std::size_t>(colour * each)]);
  }
  if (opacity == SplatOpacity::mass)
    out.splat.opacity = grownOpacity(
        splat.opacity, logEllipsoidArea(splat.logScales) - logEllipsoidArea(out.splat.logScales),
        out.capped);
  return out;
}

Setting splatsSetting(SplatOpacity* opacity) {
  return Setting(
      "splats", "OPACITY",
      choiceOf<SplatOpacity>(opacity, {{"look", SplatOpacity::look}, {"mass", SplatOpacity::mass}}),
      "opacity of Gaussian splats. look: it stays; mass: it falls as their cross section grows, as "
      "a fog of the same mass thins out");
}

}  // namespace innermap
