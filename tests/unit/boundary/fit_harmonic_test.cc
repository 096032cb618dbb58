#include "innermap/boundary/fit_harmonic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "innermap/core/detail/pi.h"

namespace innermap {
namespace {

using Function = std::function<double(const Vec3&)>;
using Gradient = std::function<Vec3(const Vec3&)>;

// nx x ny x nz squares a side of two triangles each.
Mesh box(const Vec3& low, const Vec3& high, int n) {
  Mesh m;
  m.name = "box";
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const int base = static_cast<int>(m.vertices.size());
          for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            Vec3 p;
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            p[axis] = side ? high[axis] : low[axis];
            p[u] = low[u] + (high[u] - low[u]) * (i + a) / n;
            p[v] = low[v] + (high[v] - low[v]) * (j + b) / n;
            m.vertices.push_back(p);
          }
          if (side) {
            m.triangles.push_back({base, base + 1, base + 2});
            m.triangles.push_back({base, base + 2, base + 3});
          } else {
            m.triangles.push_back({base, base + 2, base + 1});
            m.triangles.push_back({base, base + 3, base + 2});
          }
        }
  return m;
}

struct Outcome {
  HarmonicFit fit;
  double inside;
};

Outcome fitted(const Mesh& mesh, const std::function<bool(const Vec3&, const Vec3&)>& isFree,
            const Function& f, const Gradient& g, double tolerance) {
  BoundaryConditions c;
  c.function = [&](const Points& p) {
    Matrix out(p.size(), 1);
    for (std::size_t i = 0; i < p.size(); ++i) out(i, 0) = f(p[i]);
    return out;
  };
  c.fluxFunction = [&](const Points& p, const Points& n) {
    Matrix out(p.size(), 1);
    for (std::size_t i = 0; i < p.size(); ++i) out(i, 0) = dot(g(p[i]), n[i]);
    return out;
  };
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Vec3 a = areaVector(mesh, t);
    c.free.push_back(isFree(positionOf(mesh, {t, {1. / 3, 1. / 3, 1. / 3}}), a / norm(a)));
  }
  const SourceBoundary boundary = makeSourceBoundary(mesh);
  HarmonicFitSettings s;
  s.tolerance = tolerance;
  s.maxSources = 20000;
  Outcome out{fitHarmonic(boundary, c, s), 0};
  // inside
  Points inside;
  const Box3 b = boundary.solid.box();
  for (int i = 0; i < 5000; ++i) {
    const double h = 0.5 + 0.7548776662 * i, k = 0.5 + 0.5698402910 * i, l = 0.5 + 0.4301597 * i;
    const Vec3 p{b.lower.x + (h - std::floor(h)) * (b.upper.x - b.lower.x),
                 b.lower.y + (k - std::floor(k)) * (b.upper.y - b.lower.y),
                 b.lower.z + (l - std::floor(l)) * (b.upper.z - b.lower.z)};
    if (boundary.solid.inside(p)) inside.push_back(p);
  }
  const Matrix v = out.fit.field.evaluate(inside).values;
  for (std::size_t i = 0; i < inside.size(); ++i)
    out.inside = std::max(out.inside, std::abs(v(i, 0) - f(inside[i])) / out.fit.span);
  std::printf("tol %.0e: sources %zu p99 %.2e max %.2e inside %.2e bound %.2e met %d seconds ", tolerance,
              out.fit.sources, out.fit.error.p99, out.fit.error.max, out.inside, out.fit.bound, out.fit.met);
  for (const auto& [n, t] : out.fit.seconds) std::printf("%s %.1f ", n.c_str(), t);
  std::printf("\n");
  return out;
}

TEST(FitHarmonic, InsulatedSides) {
  const Function f = [](const Vec3& p) { return std::cos(kPi * p.x) * std::cosh(kPi * p.z); };
  const Gradient g = [](const Vec3& p) {
    return Vec3{-kPi * std::sin(kPi * p.x) * std::cosh(kPi * p.z), 0,
                kPi * std::cos(kPi * p.x) * std::sinh(kPi * p.z)};
  };
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5})
    fitted(box({0, 0, 0}, {1, 1, 1}, 4), [](const Vec3&, const Vec3& n) { return std::abs(n.z) < 0.5; },
           f, g, tolerance);
}

TEST(FitHarmonic, Singular) {
  const Function f = [](const Vec3& p) {
    return std::sqrt(std::hypot(p.x, p.y)) * std::sin(0.5 * std::atan2(p.y, p.x));
  };
  const Gradient g = [](const Vec3&) { return Vec3{}; };
  for (const double tolerance : {3e-2, 1e-2, 3e-3, 1e-3})
    fitted(box({-1, 0, 0}, {1, 1, 1}, 8),
           [](const Vec3& p, const Vec3& n) { return n.y < -0.5 && p.x < 0; }, f, g, tolerance);
}

}  // namespace
}  // namespace innermap
