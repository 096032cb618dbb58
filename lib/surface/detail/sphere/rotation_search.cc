#include "surface/detail/sphere/rotation_search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/pi.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kNormalWeight = 2, kRotationLandmarkWeight = 10;

Mat3 fromQuaternion(double x, double y, double z, double w) {
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

Mat3 superFibonacci(std::size_t i, std::size_t n) {
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;
  const double s = static_cast<double>(i) + 0.5, t = s / static_cast<double>(n);
  const double d = 2 * kPi * s;
  const double r = std::sqrt(t), q = std::sqrt(1 - t);
  return fromQuaternion(r * std::sin(d / phi), r * std::cos(d / phi), q * std::sin(d / psi),
                        q * std::cos(d / psi));
}

double angleBetween(const Mat3& a, const Mat3& b) {
  double trace = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) trace += a[r][c] * b[r][c];
  return std::acos(std::clamp(0.5 * (trace - 1), -1.0, 1.0));
}

double costOf(const Mat3& rotation, const std::vector<MapSample>& samples,
              const TargetMetric& target, const RotationSearchSettings& settings) {
  const Points* normals = settings.targetNormals;
  double sum = 0;
  for (const MapSample& s : samples) {
    const Vec3 x = rotation * s.x;
    Locator::Weights weights;
    const Located where = target.locator().find(x, weights);
    const TargetMetric::Plane p = target.project(where, weights, rotation * s.e, rotation * s.f);
    const Stretch stretch{p.e.x * p.e.x + p.e.y * p.e.y + p.f.x * p.f.x + p.f.y * p.f.y, p.det()};
    sum += stretch.logSquared();
    if (normals) sum += kNormalWeight * (1 - dot(s.normal, (*normals)[where.triangle]));
  }
  sum /= static_cast<double>(samples.size());
  double missed = 0;
  for (std::size_t i = 0; i < settings.from.size(); ++i)
    missed += squaredNorm(rotation * settings.from[i] - settings.to[i]);
  if (!settings.from.empty())
    sum += kRotationLandmarkWeight * missed / static_cast<double>(settings.from.size());
  return sum;
}

void descend(RotationCandidate& c, const std::vector<MapSample>& samples,
             const TargetMetric& target, const RotationSearchSettings& settings) {
  for (double angle = 0.12; angle > 0.01;) {
    RotationCandidate best = c;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        Vec3 w;
        w[axis] = sign * angle;
        const Mat3 r = product(rotationAbout(w), c.rotation);
        const double cost = costOf(r, samples, target, settings);
        if (cost < best.cost) best = {r, cost};
      }
    if (best.cost < c.cost)
      c = best;
    else
      angle *= 0.5;
  }
}

}  // namespace

Mat3 rotationAbout(const Vec3& v) {
  const double angle = norm(v);
  if (!(angle > 0)) return fromQuaternion(0, 0, 0, 1);
  const Vec3 a = (std::sin(0.5 * angle) / angle) * v;
  return fromQuaternion(a.x, a.y, a.z, std::cos(0.5 * angle));
}

Mat3 bestRotation(const Points& a, const Points& b) {
  double m[3][3] = {};
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m[r][c] += a[i][r] * b[i][c];
  Eigen::Matrix4d n;
  n << m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0],
      m[1][2] - m[2][1], m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2],
      m[2][0] - m[0][2], m[0][1] + m[1][0], m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1],
      m[0][1] - m[1][0], m[2][0] + m[0][2], m[1][2] + m[2][1], m[2][2] - m[0][0] - m[1][1];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(n);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);
  return fromQuaternion(q[1], q[2], q[3], q[0]);
}

double rotationMisfit(const Mat3& rotation, const Points& a, const Points& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += squaredNorm(rotation * a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

std::vector<RotationCandidate> searchRotations(const std::vector<MapSample>& samples,
                                               const TargetMetric& target,
                                               const RotationSearchSettings& settings) {
  std::vector<RotationCandidate> all(settings.rotations);
  parallelBlocks(
      all.size(), 32,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          all[i].rotation = superFibonacci(i, all.size());
          all[i].cost = costOf(all[i].rotation, samples, target, settings);
        }
      },
      "trying rotations");
  const auto better = [](const RotationCandidate& x, const RotationCandidate& y) {
    return x.cost < y.cost;
  };
  std::stable_sort(all.begin(), all.end(), better);
  all.resize(std::min(all.size(), settings.refined));
  parallelBlocks(
      all.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) descend(all[i], samples, target, settings);
      },
      "turning the best");
  std::stable_sort(all.begin(), all.end(), better);
  std::vector<RotationCandidate> kept;
  for (const RotationCandidate& c : all) {
    if (kept.size() == settings.kept) break;
    if (std::all_of(kept.begin(), kept.end(), [&](const RotationCandidate& k) {
          return angleBetween(k.rotation, c.rotation) > settings.apart;
        }))
      kept.push_back(c);
  }
  return kept;
}

}  // namespace innermap
