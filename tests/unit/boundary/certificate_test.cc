#include "innermap/boundary/certificate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "boundary/test_pairs.h"
#include "innermap/boundary/fit_map.h"
#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/sample/surface_samples.h"

namespace innermap {
namespace {

using Function = std::function<Vec3(const Vec3&)>;

// A charge's potential times `size`, pushing along x, y and z unlike. `at` outside the solid.
Function charge(const Vec3& at, double size) {
  return [=](const Vec3& p) {
    const Vec3 d = p - at;
    const double r = norm(d);
    return p + size * Vec3{1 / r, -d.x / (r * r * r), 0.5 / r};
  };
}

Vec3 cubic(const Vec3& p) {
  return p + 0.1 * Vec3{p.x * p.x * p.x - 3 * p.x * p.y * p.y, p.x * p.y * p.z,
                        2 * p.z * p.z * p.z - 3 * p.z * (p.x * p.x + p.y * p.y)};
}

Vec3 wave(const Vec3& p) {
  return p + 0.05 * Vec3{std::exp(2 * p.x) * std::sin(2 * p.y), std::exp(3 * p.z) * std::cos(3 * p.x),
                         std::sin(2 * p.y) * std::sinh(2 * p.z)};
}

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

// All about the origin and about 2 across.
std::vector<NamedMesh> meshes() {
  Mesh bean = shapes::icosphere(4);
  for (Vec3& p : bean.vertices) p = {p.x, 0.5 * p.y + 0.3 * p.x * p.x, 0.6 * p.z};
  Mesh lumps = shapes::icosphere(4);
  for (Vec3& p : lumps.vertices)
    p = (0.8 + 0.15 * std::sin(5 * p.x) * std::cos(4 * p.y) + 0.05 * std::sin(9 * p.z)) * p;
  return {{"ball", shapes::icosphere(3)},
          {"fine ball", shapes::icosphere(4)},
          {"torus", shapes::torus(48, 24, 0.75, 0.3)},
          {"coarse torus", shapes::torus(24, 12, 0.75, 0.3)},
          {"bean", bean},
          {"lumps", lumps}};
}

struct NamedFunction {
  std::string name;
  Function f;
};

std::vector<NamedFunction> functions() {
  return {{"affine", affineMap},
          {"quadratic", harmonicPolynomial},
          {"cubic", cubic},
          {"wave", wave},
          {"far charge", charge({2.5, 1, 0.5}, 0.5)},
          {"near charge", charge({1.3, 0.3, 0.2}, 0.1)},
          {"pole", charge({1.12, 0.05, 0.02}, 0.03)}};
}

struct Place {
  double scale = 1;
  Vec3 offset;  // of the scaled mesh
};

struct Found {
  double inside = 0, surface = 0;  // errors against the function, at points inside and at the surface
  double triangles = 0;            // against the triangles
};

// Fractions of the target's diagonal.
Found measure(const MapFit& fit, const Function& f) {
  Found out;
  const Solid& solid = fit.solid();
  const double unit = fit.boundary.target.diagonal;
  SampleSettings sample;
  sample.seed = 987654;
  std::vector<SurfacePoint> places = randomSamples(solid.surface(), 60000, sample);
  // Beside the vertices.
  for (const SurfacePoint& p : vertexPlaces(solid.surface()))
    for (const double away : {1e-6, 0.02, 0.05, 0.1, 0.2, 0.3}) {
      SurfacePoint q = p;
      for (double& b : q.barycentric) b = (1 - 1.5 * away) * b + 0.5 * away;
      places.push_back(q);
    }
  const Mesh& mesh = solid.surface();
  const Points at = interpolate(mesh.vertices, mesh.triangles, places);
  const Points onTriangles = innermap::pointsOf(fit.boundary.targetsOf(places));
  const Points got = innermap::pointsOf(fit.map.evaluate(at).values);
  for (std::size_t i = 0; i < at.size(); ++i) {
    out.triangles = std::max(out.triangles, norm(got[i] - onTriangles[i]) / unit);
    out.surface = std::max(out.surface, norm(got[i] - f(at[i])) / unit);
  }
  Points inside;
  const Vec3 middle = solid.box().center();
  const CounterRandom random(5, 5);
  for (std::size_t i = 0; inside.size() < 20000; ++i) {
    Vec3 p = middle;
    for (int a = 0; a < 3; ++a) p[a] += (random.uniform(3 * i + a) - 0.5) * solid.diagonal();
    if (solid.inside(p)) inside.push_back(p);
  }
  const Points images = innermap::pointsOf(fit.map.evaluate(inside).values);
  for (std::size_t i = 0; i < inside.size(); ++i)
    out.inside = std::max(out.inside, norm(images[i] - f(inside[i])) / unit);
  return out;
}

struct Case {
  NamedMesh mesh;
  NamedFunction function;
  Place place;
  FitMapSettings settings;
};

void expectBound(const Case& c) {
  SCOPED_TRACE(c.function.name + " on " + c.mesh.name + " at scale " +
               std::to_string(std::log10(c.place.scale)) + " off by " +
               std::to_string(norm(c.place.offset)));
  const auto back = [&](const Vec3& p) { return (p - c.place.offset) / c.place.scale; };
  const auto there = [&](const Vec3& p) { return c.place.scale * p + c.place.offset; };
  const Function f = [&](const Vec3& p) { return there(c.function.f(back(p))); };
  Mesh source = moved(c.mesh.mesh, there);
  const MapFit fit = fitMap(source, moved(source, f), c.settings);
  const Found found = measure(fit, f);
  std::printf("%-12s %-12s s %2g o %7.1g %s | inside %.2e surface %.2e / %.2e = %.2f (in %.1f) | tri %.2e max %.2e bound %.2e | vmax %.2e trierr %.2e\n",
    c.function.name.c_str(), c.mesh.name.c_str(), std::log10(c.place.scale), norm(c.place.offset)/c.place.scale, fit.smooth ? "smooth":"linear",
    found.inside, found.surface, fit.smoothBound, fit.smoothBound/found.surface, fit.smoothBound/found.inside, found.triangles, fit.error.max, fit.error.bound, fit.verticesMax.value_or(0), fit.triangles.value_or(0));
  EXPECT_LE(found.triangles, fit.error.bound);
  EXPECT_LE(found.surface, fit.smoothBound);
  EXPECT_LE(found.inside, fit.smoothBound);
}

TEST(Certificate, HoldsForKnownFunctions) {
  FitMapSettings settings;
  settings.oneToOne = OneToOne::off;
  for (const NamedMesh& mesh : meshes())
    for (const NamedFunction& function : functions())
      for (const Interpolation interpolation : {Interpolation::linear, Interpolation::automatic}) {
        settings.interpolation = interpolation;
        expectBound({mesh, function, {}, settings});
      }
}

}  // namespace
}  // namespace innermap
