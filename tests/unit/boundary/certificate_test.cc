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
  return p + 0.05 * Vec3{std::exp(2 * p.x) * std::sin(2 * p.y),
                         std::exp(3 * p.z) * std::cos(3 * p.x),
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
  double inside = 0,
         surface = 0;    // errors against the function, at points inside and at the surface
  double triangles = 0;  // against the triangles
};

// Fractions of the target's diagonal.
Found measure(const MapFit& fit, const Function& f) {
  Found out;
  const Solid& solid = fit.solid();
  const double unit = fit.boundary.target.diagonal;
  SampleSettings sample;
  sample.seed = 987654;
  std::vector<SurfacePoint> places = randomSamples(solid.surface(), 20000, sample);
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
  // Under the surface, where harmonic errors are largest, and anywhere.
  Points inside;
  for (std::size_t i = 0; i < 5000; ++i) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(places[i].triangle)];
    const Vec3 a = mesh.vertices[t[0]];
    const Vec3 normal = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    const Vec3 p = at[i] - (0.005 * solid.diagonal() / norm(normal)) * normal;
    if (solid.inside(p)) inside.push_back(p);
  }
  const Vec3 middle = solid.box().center();
  const CounterRandom random(5, 5);
  for (std::size_t i = 0; inside.size() < 8000; ++i) {
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

constexpr double kAtMost = 20;    // times the error inside
constexpr double kFloor = 1e-13;  // of the diagonal

// Of positions, of the diagonal.
double rounding(const Mesh& mesh) {
  return std::numeric_limits<double>::epsilon() * norm(mesh.vertices[0]) /
         boundingBox(mesh).diagonal();
}

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
  EXPECT_LE(found.triangles, fit.error.bound);
  EXPECT_LE(found.surface, fit.smoothBound);
  EXPECT_LE(found.inside, fit.smoothBound);
  EXPECT_LE(found.triangles, 1.05 * fit.error.max + kFloor);
  // What rounding leaves is no error of the map.
  EXPECT_LE(fit.smoothBound, kAtMost * found.inside + kFloor + 20 * rounding(source));
}

// 84: every function on every mesh, fitted to triangles and, where they are smooth,
// to vertices; each third elsewhere and of another size.
TEST(Certificate, HoldsForKnownFunctions) {
  const Place places[] = {{1, {}},
                          {1e-6, {}},
                          {1e6, {}},
                          {1, {1e3, -2e3, 500}},
                          {1e-3, {-30, 10, 1e3}},
                          {1e3, {1e8, 3e8, -1e8}}};
  FitMapSettings settings;
  settings.oneToOne = OneToOne::off;
  settings.maxSources = 3000;
  std::size_t place = 0;
  for (const NamedMesh& mesh : meshes())
    for (const NamedFunction& function : functions())
      for (const Interpolation interpolation : {Interpolation::linear, Interpolation::automatic}) {
        settings.interpolation = interpolation;
        settings.shell.reset();
        if (place % 4 == 1) {
          settings.shell.emplace();
          settings.shell->sources = 300;
        }
        expectBound({mesh, function, places[place++ % 6], settings});
      }
}

// A needle of an error at a place that no random point is likely to fall near: beside a vertex.
TEST(Certificate, FindsWhatStandsOutBesideAVertex) {
  const Solid solid(shapes::icosphere(3));
  const Mesh& mesh = solid.surface();
  const Vec3 peak = mesh.vertices[100] + Vec3{2e-3, -1e-3, 1e-3};
  const auto errors = [&](const std::vector<SurfacePoint>& places) {
    std::vector<double> out;
    for (const Vec3& p : interpolate(mesh.vertices, mesh.triangles, places))
      out.push_back(1 + 9 * std::exp(-std::pow(norm(p - peak) / 5e-3, 2)));
    return out;
  };
  const BoundaryError found = certify(solid, errors);
  const double largest = 1 + 9 * std::exp(-std::pow(solid.distance(peak) / 5e-3, 2));
  EXPECT_GT(found.max, 0.98 * largest);
  EXPECT_LE(found.max, (1 + 1e-12) * largest);
  EXPECT_GE(found.bound, largest);
  EXPECT_LT(found.p99, 1.01);
  EXPECT_EQ(found.samples, kFreshSamples);
  EXPECT_LT(found.searched, kFreshSamples);
}

TEST(Certificate, IsTheSameForAnyNumberOfThreads) {
  FitMapSettings settings;
  settings.oneToOne = OneToOne::off;
  settings.shell.emplace();
  settings.shell->sources = 100;
  const Mesh source = ball();
  const auto fit = [&] { return fitMap(source, moved(source, wave), settings); };
  const MapFit all = fit();
  const ThreadLimit limit(1);
  const MapFit one = fit();
  EXPECT_EQ(all.error.max, one.error.max);
  EXPECT_EQ(all.smoothBound, one.smoothBound);
}

TEST(Certificate, RefusesAndCancels) {
  const Solid solid(shapes::icosphere(1));
  const auto none = [](const std::vector<SurfacePoint>& places) {
    return std::vector<double>(places.size(), 0.0);
  };
  CertificateSettings settings;
  EXPECT_EQ(certify(solid, none).bound, 0);
  settings.samples = 0;
  EXPECT_THROW(certify(solid, none, settings), SettingError);
  Progress progress;
  progress.cancel();
  settings.samples = 1000;
  settings.progress = &progress;
  EXPECT_THROW(certify(solid, none, settings), Cancelled);
}

TEST(Certificate, VerticesOnceEach) {
  const Mesh mesh = shapes::icosphere(2);
  const std::vector<SurfacePoint> places = vertexPlaces(mesh);
  ASSERT_EQ(places.size(), mesh.vertices.size());
  for (const Vec3& p : interpolate(mesh.vertices, mesh.triangles, places))
    EXPECT_NEAR(norm(p), 1, 1e-14);
}

}  // namespace
}  // namespace innermap
