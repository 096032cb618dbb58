#include "innermap/fit/fit_harmonic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/pi.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

struct Known {
  std::function<double(const Vec3&)> value;
  std::function<Vec3(const Vec3&)> gradient;
};

using IsFree = std::function<bool(const Vec3& centroid, const Vec3& normal)>;

const IsFree kNowhere = [](const Vec3&, const Vec3&) { return false; };

// cos(pi x) cosh(pi z): no flux through the sides of a unit cube.
const Known kInsulated{[](const Vec3& p) { return std::cos(kPi * p.x) * std::cosh(kPi * p.z); },
                       [](const Vec3& p) {
                         return kPi * Vec3{-std::sin(kPi * p.x) * std::cosh(kPi * p.z), 0,
                                           std::cos(kPi * p.x) * std::sinh(kPi * p.z)};
                       }};

// 1 / |p|, in a shell.
const Known kCharge{[](const Vec3& p) { return 1 / norm(p); },
                    [](const Vec3& p) { return (-1 / std::pow(norm(p), 3)) * p; }};

// J0(k r) cosh(k z), k r = 3.83 at r = 1: no flux through the side of a cylinder.
const Known kCylinder{
    [](const Vec3& p) {
      return std::cyl_bessel_j(0, 3.8317059702 * std::hypot(p.x, p.y)) *
             std::cosh(3.8317059702 * p.z) / 10;
    },
    [](const Vec3& p) {
      const double k = 3.8317059702, r = std::hypot(p.x, p.y);
      const double across = -k * std::cyl_bessel_j(1, k * r) * std::cosh(k * p.z) / 10;
      const double along = k * std::cyl_bessel_j(0, k * r) * std::sinh(k * p.z) / 10;
      return r > 0 ? Vec3{across * p.x / r, across * p.y / r, along} : Vec3{0, 0, along};
    }};

// r^1/2 sin(phi / 2): 0 on one half of a plane, no flux through the other.
const Known kRoot{[](const Vec3& p) {
                    return std::sqrt(std::hypot(p.x, p.y)) * std::sin(0.5 * std::atan2(p.y, p.x));
                  },
                  [](const Vec3&) { return Vec3{}; }};

const Known kPolynomial{
    [](const Vec3& p) { return p.x * p.x - p.y * p.y + p.x * p.y * p.z + 2 * p.z; },
    [](const Vec3& p) {
      return Vec3{2 * p.x + p.y * p.z, -2 * p.y + p.x * p.z, p.x * p.y + 2};
    }};

Mesh cylinder(int around) {
  Mesh mesh{.name = "cylinder"};
  const double half = 0.5;
  mesh.vertices = {{0, 0, -half}, {0, 0, half}};
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * kPi * i / around;
    for (const double z : {-half, half})
      mesh.vertices.push_back({std::cos(angle), std::sin(angle), z});
  }
  for (int i = 0; i < around; ++i) {
    const int a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % around);
    mesh.triangles.insert(mesh.triangles.end(),
                          {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return mesh;
}

BoundaryConditions conditionsOf(const Mesh& mesh, const Known& known, const IsFree& isFree) {
  BoundaryConditions out;
  out.function = [known](const Points& points) {
    Matrix m(points.size(), 1);
    for (std::size_t i = 0; i < points.size(); ++i) m(i, 0) = known.value(points[i]);
    return m;
  };
  out.fluxFunction = [known](const Points& points, const Points& normals) {
    Matrix m(points.size(), 1);
    for (std::size_t i = 0; i < points.size(); ++i)
      m(i, 0) = dot(known.gradient(points[i]), normals[i]);
    return m;
  };
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Vec3 area = areaVector(mesh, t);
    out.free.push_back(
        isFree(positionOf(mesh, {t, {1.0 / 3, 1.0 / 3, 1.0 / 3}}), area / norm(area)));
  }
  return out;
}

// The largest error at 2,000 points inside, fraction of the span.
double errorInside(const HarmonicFit& fit, const Solid& solid, const Known& known) {
  Points inside;
  const Box3 box = solid.box();
  for (int i = 1; inside.size() < 2000; ++i) {
    // Roberts' R3 sequence.
    const double u = std::fmod(0.8191725134 * i, 1.0), v = std::fmod(0.6710436067 * i, 1.0),
                 w = std::fmod(0.5497004779 * i, 1.0);
    const Vec3 d = box.upper - box.lower;
    const Vec3 p = box.lower + Vec3{u * d.x, v * d.y, w * d.z};
    if (solid.inside(p)) inside.push_back(p);
  }
  const Matrix found = fit.field.evaluate(inside).values;
  double worst = 0;
  for (std::size_t i = 0; i < inside.size(); ++i)
    worst = std::max(worst, std::abs(found(i, 0) - known.value(inside[i])) / fit.span);
  return worst;
}

void expectWithin(const Mesh& mesh, const Known& known, const IsFree& isFree, double tolerance,
                  double inside) {
  SCOPED_TRACE(mesh.name);
  const SourceBoundary boundary = makeSourceBoundary(mesh);
  const HarmonicFit fit =
      fitHarmonic(boundary, conditionsOf(mesh, known, isFree), {.tolerance = tolerance});
  EXPECT_TRUE(fit.met);
  EXPECT_LE(fit.error.p99, tolerance);
  const double error = errorInside(fit, boundary.solid, known);
  EXPECT_LE(error, inside);
  EXPECT_LE(error, fit.bound);
  EXPECT_LE(fit.bound, 4 * tolerance);  // measured: 1.4 at most
}

TEST(FitHarmonicRelease, ValuesFromAFunctionAreMetToAMillionth) {
  for (const Mesh& mesh :
       {shapes::icosphere(2), shapes::torus(24, 12), shapes::box({-1, -0.7, -0.5}, {1, 0.7, 0.5})})
    expectWithin(mesh, kPolynomial, kNowhere, 1e-6, 1e-5);
}

TEST(FitHarmonicRelease, InsulatedSidesOfABox) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  expectWithin(
      mesh, kInsulated, [](const Vec3&, const Vec3& n) { return std::abs(n.z) < 0.5; }, 3e-4, 1e-3);
}

TEST(FitHarmonicRelease, InsulatedSideOfACylinder) {
  expectWithin(
      cylinder(48), kCylinder, [](const Vec3&, const Vec3& n) { return std::abs(n.z) < 0.5; }, 3e-4,
      1e-3);
}

TEST(FitHarmonicRelease, FluxThroughTheOuterSideOfAShell) {
  const Mesh inner = shapes::icosphere(2, 0.5);
  Mesh mesh = shapes::icosphere(2);
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const Triangle& t : inner.triangles)
    mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  expectWithin(
      mesh, kCharge, [](const Vec3& p, const Vec3&) { return norm(p) > 0.75; }, 3e-4, 1e-3);
}

// Half of a ring about the z axis, cut at y = 0.
Mesh halfRing(int along, int around) {
  Mesh mesh{.name = "half ring"};
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = kPi * j / along, b = 2 * kPi * i / around, r = 1 + 0.35 * std::cos(b);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), 0.35 * std::sin(b)});
    }
  const auto vertex = [&](int j, int i) { return j * around + i % around; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j)
      mesh.triangles.insert(mesh.triangles.end(),
                            {{vertex(j, i), vertex(j + 1, i), vertex(j + 1, i + 1)},
                             {vertex(j, i), vertex(j + 1, i + 1), vertex(j, i + 1)}});
    if (i == 0 || i + 1 == around) continue;
    mesh.triangles.insert(mesh.triangles.end(),
                          {{vertex(0, 0), vertex(0, i), vertex(0, i + 1)},
                           {vertex(along, 0), vertex(along, i + 1), vertex(along, i)}});
  }
  return mesh;
}

// The angle about the axis is harmonic, and nothing of it flows through the ring's side. Along the
// triangles' own normals something does, with a jump at each edge.
TEST(FitHarmonicRelease, FacetsOfASmoothSideTakeFewCharges) {
  const Mesh mesh = halfRing(32, 24);
  const SourceBoundary boundary = makeSourceBoundary(mesh);
  const Known angle{[](const Vec3& p) { return std::atan2(p.y, p.x) / kPi; },
                    [](const Vec3&) { return Vec3{}; }};
  BoundaryConditions conditions =
      conditionsOf(mesh, angle, [](const Vec3&, const Vec3& n) { return std::abs(n.y) < 0.9999; });
  conditions.values = Matrix(mesh.vertices.size(), 1);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    conditions.values(v, 0) = mesh.vertices[v].x > 0 ? 0 : 1;
  conditions.function = nullptr;
  HarmonicFitSettings settings{.tolerance = 3e-3, .maxSources = 6000};
  const HarmonicFit smooth = fitHarmonic(boundary, conditions, settings);
  EXPECT_TRUE(smooth.met);
  // The ring's triangles are off its surface by (pi / 32)^2 1.35 / 8 = 1.6e-3.
  EXPECT_LE(errorInside(smooth, boundary.solid, angle), 2 * settings.tolerance);
  conditions.creaseAngle = 0;
  EXPECT_FALSE(fitHarmonic(boundary, conditions, settings).met);
}

// Where values and fluxes meet the field goes as the root of the distance: its error is largest
// there, and the bound knows.
TEST(FitHarmonicRelease, TheBoundHoldsWhereTheFieldIsSingular) {
  const Mesh mesh = shapes::box({-1, 0, -0.5}, {1, 1, 0.5});
  // The lower side is split where values end.
  Mesh split;
  split.name = "box split at x = 0";
  for (const Triangle& t : mesh.triangles) {
    Points corners{mesh.vertices[static_cast<std::size_t>(t[0])],
                   mesh.vertices[static_cast<std::size_t>(t[1])],
                   mesh.vertices[static_cast<std::size_t>(t[2])]};
    for (const bool left : {true, false}) {
      Points part;
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 a = corners[c], b = corners[(c + 1) % 3];
        if ((a.x < 0) == left) part.push_back(a);
        if ((a.x < 0) != (b.x < 0)) part.push_back(a + (a.x / (a.x - b.x)) * (b - a));
      }
      for (std::size_t c = 1; c + 1 < part.size(); ++c) {
        const int first = static_cast<int>(split.vertices.size());
        for (const std::size_t corner : {std::size_t(0), c, c + 1})
          split.vertices.push_back(part[corner]);
        split.triangles.push_back({first, first + 1, first + 2});
      }
    }
  }
  const IsFree isFree = [](const Vec3& p, const Vec3& n) { return n.y < -0.5 && p.x < 0; };
  const SourceBoundary boundary = makeSourceBoundary(split);
  const HarmonicFit fit =
      fitHarmonic(boundary, conditionsOf(split, kRoot, isFree), {.tolerance = 3e-2});
  const double error = errorInside(fit, boundary.solid, kRoot);
  EXPECT_TRUE(fit.met);
  EXPECT_LE(error, fit.bound);
  EXPECT_LE(fit.bound, 15 * error);        // measured: 5.6
  EXPECT_NEAR(fit.freeShare, 0.1, 0.001);  // 1 of 10
}

// Of corners: values jump from triangle to triangle.
TEST(FitHarmonicRelease, ChannelsOfGroupsSumUpToOne) {
  const Mesh mesh = shapes::box({-1, -0.5, -0.5}, {1, 0.5, 0.5});
  BoundaryConditions conditions{.values = Matrix(3 * mesh.triangles.size(), 2)};
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Vec3 area = areaVector(mesh, t);
    const double along = area.x / norm(area);
    conditions.free.push_back(std::abs(along) < 0.5);
    for (int c = 0; c < 3; ++c)
      conditions.values(static_cast<std::size_t>(3 * t + c), along > 0 ? 0 : 1) = 1;
  }
  const SourceBoundary boundary = makeSourceBoundary(mesh);
  const HarmonicFit fit = fitHarmonic(boundary, conditions);
  const Points points{{0, 0, 0}, {0.9, 0.4, -0.3}, {-0.5, 0.1, 0.2}};
  // Nothing flows through the sides: linear from end to end.
  const Matrix found = fit.field.evaluate(points).values;
  // Values that lack something: both channels take half of it.
  conditions.unitSum = true;
  for (std::size_t i = 0; i < conditions.values.rows(); ++i) conditions.values(i, 0) -= 0.02;
  const Matrix exact = fitHarmonic(boundary, conditions).field.evaluate(points).values;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(found(i, 0), 0.5 * (1 + points[i].x), fit.bound + 1e-12);
    EXPECT_NEAR(exact(i, 0) + exact(i, 1), 1, 1e-12);
    EXPECT_NEAR(exact(i, 0), found(i, 0) - 0.01, fit.bound + 1e-12);
  }
}

// The cap of a hole has no triangle of the input, and so no corners of its own.
TEST(FitHarmonic, CornersOfAnOpenMeshHaveValues) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  mesh.triangles.pop_back();
  BoundaryConditions conditions{.values = Matrix(3 * mesh.triangles.size(), 1)};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      conditions.values(3 * t + c, 0) = mesh.vertices[mesh.triangles[t][c]].x;
  const HarmonicFit fit = fitHarmonic(makeSourceBoundary(mesh), conditions);
  EXPECT_NEAR(fit.field.evaluate({{0.3, 0.5, 0.6}}, {0, false}).values(0, 0), 0.3, 1e-6);
}

// 0 on a box, 1 on another that stands in it: no harmonic field meets that along the line where
// they cross.
TEST(FitHarmonicRelease, SaysWhereValuesJump) {
  const Mesh mesh = shapes::joined(shapes::box({-1, -1, -1}, {1, 1, 1}),
                                   shapes::box({-0.4, -0.3, 0.5}, {0.4, 0.3, 2}));
  BoundaryConditions conditions{.values = Matrix(mesh.vertices.size(), 1)};
  for (std::size_t v = mesh.vertices.size() / 2; v < mesh.vertices.size(); ++v)
    conditions.values(v, 0) = 1;
  const HarmonicFit fit =
      fitHarmonic(makeSourceBoundary(mesh), conditions, {.tolerance = 5e-2, .maxSources = 4000});
  ASSERT_EQ(fit.notes.size(), 1u);
  EXPECT_NE(fit.notes.front().find("differ by up to 1 of"), std::string::npos) << fit.notes.front();
}

}  // namespace
}  // namespace innermap
