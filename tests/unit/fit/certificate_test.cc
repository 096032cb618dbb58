#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>

#include "core/expect.h"
#include "fit/known_maps.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/surface_problem.h"

namespace innermap {
namespace {

struct Place {
  double scale = 1;
  double diagonals = 0;  // from the origin
};

struct Outcome {
  known::Found found;
  double triangles = 0, smooth = 0;  // the bounds
  double max = 0, floor = 0;         // and what rounding leaves, which is no error of the map
};

constexpr double kAtMost = 20;    // times the error inside
constexpr double kFloor = 1e-13;  // of the diagonal

Outcome fitKnown(const Mesh& mesh, const known::Function& function, const Place& place,
                 const FitMapSettings& settings) {
  const double far = place.scale * place.diagonals * boundingBox(mesh).diagonal();
  const Vec3 offset = far / norm(Vec3{1, -2, 0.5}) * Vec3{1, -2, 0.5};
  const auto there = [&](const Vec3& p) { return place.scale * p + offset; };
  const known::Function f = [&](const Vec3& p) {
    return there(function((p - offset) / place.scale));
  };
  const Mesh source = moved(mesh, there);
  const MapFit fit = fitMap(source, moved(source, f), settings);
  const double rounding = std::numeric_limits<double>::epsilon() * norm(source.vertices[0]) /
                          boundingBox(source).diagonal();
  return {known::measure(fit, f), fit.error.bound, fit.smoothBound, fit.error.max,
          kFloor + 20 * rounding};
}

void expectBounds(const Outcome& o) {
  EXPECT_LE(o.found.triangles, o.triangles);
  EXPECT_LE(o.found.surface, o.smooth);
  EXPECT_LE(o.found.inside, o.smooth);
  EXPECT_LE(o.found.triangles, 1.05 * o.max + o.floor);
  EXPECT_LE(o.smooth, kAtMost * o.found.inside + o.floor);
}

FitMapSettings quick() {
  FitMapSettings settings;
  settings.oneToOne = OneToOne::off;
  settings.maxSources = 3000;
  return settings;
}

constexpr Place kPlaces[] = {{1, 0},     {1e-6, 0}, {1e6, 0},    {1, 1e3},  {1e-6, 1e3},
                             {1e6, 1e3}, {1, 1e6},  {1e-6, 1e6}, {1e6, 1e6}};

// Fitted to a tolerance and to the triangles, to what is better, and with a number of charges.
constexpr int kWays = 3;
FitMapSettings wayOf(int way) {
  FitMapSettings settings = quick();
  if (way == 0) settings.interpolation = Interpolation::linear;
  if (way == 2) {
    settings.shell.emplace();
    settings.shell->sources = 300;
  }
  return settings;
}

// Some of seven functions on each of six meshes, of each size and at each place, and in each way.
void expectBoundsOfKnown(const std::function<bool(std::size_t, std::size_t)>& chosen) {
  std::size_t m = 0;
  for (const auto& [meshName, mesh] : known::meshes()) {
    std::size_t k = 0;
    for (const auto& [name, f] : known::functionsOn(mesh)) {
      if (!chosen(m, k)) {
        ++k;
        continue;
      }
      const std::size_t place = (4 * k + 7 * m) % 9;
      SCOPED_TRACE(name + " on " + meshName + " at place " + std::to_string(place));
      expectBounds(fitKnown(mesh, f, kPlaces[place], wayOf(static_cast<int>((k + m) % kWays))));
      ++k;
    }
    ++m;
  }
}

TEST(CertificateRelease, HoldsForKnownFunctions) {
  expectBoundsOfKnown([](std::size_t m, std::size_t k) { return k == m % 7; });
}

TEST(CertificateNightly, HoldsForMoreKnownFunctions) {
  expectBoundsOfKnown([](std::size_t m, std::size_t k) { return k != m % 7; });
}

std::vector<known::NamedMesh> allMeshes() {
  std::vector<known::NamedMesh> meshes = known::meshes();
  for (const known::NamedMesh& m : known::moreMeshes()) meshes.push_back(m);
  return meshes;
}

// By the number of the mesh: shards run them side by side, and tests/nightly a third a night.
class CertificateOnMeshNightly : public ::testing::TestWithParam<std::size_t> {};
// Not by allMeshes(), which would read the models whenever the program starts.
constexpr std::size_t kMostMeshes = 15;
INSTANTIATE_TEST_SUITE_P(All, CertificateOnMeshNightly,
                         ::testing::Range(std::size_t(0), kMostMeshes));

// All functions at all places, in each way at three of them: about a minute. Prints the largest
// share of `bound` and of `smoothBound` that errors take, and how many times the error inside the
// latter is at most.
TEST_P(CertificateOnMeshNightly, Holds) {
  const char* const night = std::getenv("INNERMAP_TEST_SEED");
  if (night && (GetParam() + std::strtoul(night, nullptr, 10)) % 3 != 0)
    GTEST_SKIP() << "on another night";
  const std::vector<known::NamedMesh> meshes = allMeshes();
  ASSERT_LE(meshes.size(), kMostMeshes);
  if (GetParam() >= meshes.size()) GTEST_SKIP() << "no models";
  const auto& [meshName, mesh] = meshes[GetParam()];
  int way = static_cast<int>(GetParam());
  for (const auto& [name, f] : known::functionsOn(mesh)) {
    double used = 0, over = 0, usedTriangles = 0;
    for (const Place& place : kPlaces) {
      way = (way + 1) % kWays;
      SCOPED_TRACE(fmt::format("{} on {}, scale {:g}, {:g} diagonals off, way {}", name, meshName,
                               place.scale, place.diagonals, way));
      const Outcome o = fitKnown(mesh, f, place, wayOf(way));
      expectBounds(o);
      usedTriangles = std::max(usedTriangles, o.found.triangles / o.triangles);
      used = std::max(used, std::max(o.found.surface, o.found.inside) / o.smooth);
      over = std::max(over, (o.smooth - o.floor) / o.found.inside);
    }
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.1f} |\n", meshName, name, usedTriangles, used,
               over);
    std::fflush(stdout);
    ++way;
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

TEST(CertificateRelease, IsTheSameForAnyNumberOfThreads) {
  FitMapSettings settings{.oneToOne = OneToOne::off};
  settings.shell.emplace();
  settings.shell->sources = 100;
  const Mesh source = ball();
  const auto fit = [&] { return fitMap(source, moved(source, known::wave), settings); };
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
  EXPECT_EQ(certify(solid, none).bound, 0);
  EXPECT_THROW(certify(solid, none, {.samples = 0}), SettingError);
  test::expectCancels([&] { certify(solid, none, {.samples = 1000}); });
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
