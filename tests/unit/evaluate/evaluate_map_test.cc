#include "innermap/evaluate/evaluate_map.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "core/random.h"
#include "field/affine_map.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

using test::affineOf;
using test::chargedMap;
using test::kIdentity;

Vec3 turned(const Vec3& p) {
  const double a = 0.5, b = 0.8;
  const Vec3 q{std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
  return {q.x, std::cos(b) * q.y - std::sin(b) * q.z, std::sin(b) * q.y + std::cos(b) * q.z};
}

// The cube [-1, 1]^3 turned off the grid's axes.
Mesh cube() {
  Mesh mesh = shapes::box({-1, -1, -1}, {1, 1, 1});
  for (Vec3& v : mesh.vertices) v = turned(v);
  return mesh;
}

openvdb::FloatGrid::Ptr levelSet(const Solid& solid, int resolution) {
  return makeLevelSet(solid, {.resolution = resolution});
}

MapGrids evaluate(const HarmonicMap& map, const Solid& solid, int resolution,
                  const EvaluateSettings& settings = {}) {
  return evaluateMap(map, solid, *levelSet(solid, resolution), settings);
}

// Integral over the cube by 8 Gauss-Legendre points a side: the integrands are analytic there.
template <class Function>
double integral(const Function& f) {
  const double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                       0.9602898564975363};
  const double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                       0.1012285362903763};
  double sum = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 8; ++k) {
        const auto at = [&](int n) { return n < 4 ? x[n] : -x[n - 4]; };
        sum += w[i % 4] * w[j % 4] * w[k % 4] * f(turned({at(i), at(j), at(k)}));
      }
  return sum;
}

TEST(EvaluateMap, ReflectionIsFoldedEverywhere) {
  const MapGrids g =
      evaluate(test::affineMap({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}), Solid(cube()), 24);
  EXPECT_NEAR(g.foldedFraction, 1, 1e-12);
  EXPECT_NEAR(g.jacobianMin, -1, 1e-12);
}

TEST(EvaluateMap, TotalsConvergeAtSecondOrder) {
  const HarmonicMap map = chargedMap();
  const Solid solid(cube());
  const double harmonic =
      integral([&](const Vec3& p) { return harmonicEnergyDensity(map.jacobian(p)); }) / 8;
  const double deformation =
      integral([&](const Vec3& p) { return deformationEnergyDensity(map.jacobian(p)); });
  double harmonicError[2], deformationError[2];
  const int resolutions[2] = {24, 96};
  for (int level = 0; level < 2; ++level) {
    const MapGrids g = evaluate(map, solid, resolutions[level]);
    harmonicError[level] = std::abs(g.harmonicTotal - harmonic) / harmonic;
    deformationError[level] = std::abs(g.deformationTotal - deformation) / deformation;
  }
  // Two halvings at second order would give 16; grid alignment makes single figures noisy.
  EXPECT_LT(deformationError[1], deformationError[0] / 6) << deformationError[0];
  // A mean over the voxels' own volume, where what the rim misses cancels, is better than h^2.
  for (int level = 0; level < 2; ++level)
    EXPECT_LT(harmonicError[level], std::pow(resolutions[level], -2)) << level;
  EXPECT_LT(deformationError[1], 1e-2);
}

TEST(EvaluateMap, GridsHoldTheMapInsideAndItsExtensionInTheSkin) {
  const HarmonicMap map = chargedMap();
  const Solid solid(cube());
  const auto surface = levelSet(solid, 32);
  const double voxel = surface->voxelSize()[0];
  const MapGrids g = evaluateMap(map, solid, *surface);
  std::size_t outside = 0;
  for (auto v = g.map->cbeginValueOn(); v; ++v) {
    const openvdb::Vec3d w = surface->transform().indexToWorld(v.getCoord());
    const Vec3 p{w.x(), w.y(), w.z()}, q = map(p);
    const double distance = solid.signedDistance(p);
    if (std::abs(distance) < 1e-6) continue;
    ASSERT_LE(distance, 2 * voxel * (1 + 1e-5));
    // The linear extension's error: second derivatives of the map are below 1 here.
    const double tolerance = distance < 0 ? 1e-6 : 1e-6 + distance * distance;
    for (int a = 0; a < 3; ++a) ASSERT_NEAR((*v)[a], q[a], tolerance);
    if (distance < 0) {
      ASSERT_NEAR(g.jacobian->tree().getValue(v.getCoord()), determinant(map.jacobian(p)), 1e-5);
      ASSERT_NEAR(g.harmonicEnergy->tree().getValue(v.getCoord()),
                  harmonicEnergyDensity(map.jacobian(p)), 1e-5);
    }
    outside += distance > 0;
  }
  EXPECT_GT(outside, g.interiorVoxels / 20);
  EXPECT_EQ(g.map->activeVoxelCount(), g.activeVoxels);
  EXPECT_EQ(g.jacobian->activeVoxelCount(), g.activeVoxels);
  EXPECT_EQ(g.map->getVectorType(), openvdb::VEC_INVARIANT);
  EXPECT_EQ(g.map->transform(), surface->transform());
  EXPECT_EQ(g.all().size(), 4u);
}

// Identity and thousands of charges on a sphere about the cube: the sums are hierarchical.
HarmonicMap manyCharges() {
  const std::size_t count = 4000;
  const CounterRandom random(5, 1);
  Points sources(count);
  Matrix weights(count, 3);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 2 * random.uniform(2 * i) - 1, angle = 6.283 * random.uniform(2 * i + 1),
                 r = std::sqrt(1 - z * z);
    sources[i] = 1.8 * Vec3{r * std::cos(angle), r * std::sin(angle), z};
    for (std::size_t k = 0; k < 3; ++k)
      weights(i, k) = 2e-3 * (random.uniform(1000000 + 3 * i + k) - 0.5);
  }
  return HarmonicMap(HarmonicField(sources, weights, affineOf(kIdentity)));
}

TEST(EvaluateMapRelease, ManyChargesAreSummedToTheAccuracy) {
  const HarmonicMap map = manyCharges();
  const Solid solid(cube());
  const openvdb::FloatGrid::Ptr surface = levelSet(solid, 48);
  for (const double accuracy : {1e-4, 1e-7}) {
    const MapGrids grids = evaluateMap(map, solid, *surface, {.accuracy = accuracy});
    double squared = 0, jacobian = 0;
    std::size_t count = 0;
    for (auto it = grids.map->cbeginValueOn(); it; ++it) {
      if (count++ % 7 || surface->tree().getValue(it.getCoord()) >= 0) continue;
      const openvdb::Vec3d p = grids.map->transform().indexToWorld(it.getCoord());
      const Vec3 exact = map({p.x(), p.y(), p.z()});
      const openvdb::Vec3f got = *it;
      squared += squaredNorm(Vec3{got.x(), got.y(), got.z()} - exact);
      jacobian = std::max(jacobian, std::abs(grids.jacobian->tree().getValue(it.getCoord()) -
                                             determinant(map.jacobian({p.x(), p.y(), p.z()}))));
    }
    const double extent = std::sqrt(12.0), rounding = 6e-8 * extent;
    EXPECT_LT(std::sqrt(7 * squared / static_cast<double>(count)),
              3 * (accuracy * extent + rounding));
    EXPECT_LT(jacobian, 1e-2);
  }
}

// A charge just outside a face of the cube pushes it in until it folds.
HarmonicMap foldedMap() {
  const Vec3 normal = turned({0, 0, 1});
  Matrix weights(1, 3);
  for (int r = 0; r < 3; ++r) weights(0, r) = -0.127 * normal[r];
  return HarmonicMap(HarmonicField({1.3 * normal}, weights, affineOf(kIdentity)));
}

TEST(EvaluateMap, FoldsAreRepairedAndNothingElse) {
  const Solid solid(cube());
  const MapGrids folded = evaluate(foldedMap(), solid, 64, {});
  ASSERT_GT(folded.foldedVoxels, 10u);
  EXPECT_EQ(folded.foldedVoxelsLeft, folded.foldedVoxels);
  EXPECT_LT(folded.jacobianMin, 0);
  EXPECT_FALSE(folded.repaired);
  ASSERT_TRUE(folded.folded);
  EXPECT_EQ(folded.folded->activeVoxelCount(), folded.foldedVoxels);
  for (auto v = folded.folded->cbeginValueOn(); v; ++v)
    EXPECT_LE(folded.jacobian->tree().getValue(v.getCoord()), 0);
  const double share =
      static_cast<double>(folded.foldedVoxels) / static_cast<double>(folded.interiorVoxels);
  EXPECT_FALSE(evaluate(foldedMap(), solid, 64, {.repairUpTo = 0.9 * share}).repaired);
  const MapGrids grids = evaluate(foldedMap(), solid, 64, {.repairUpTo = 1.1 * share});
  EXPECT_EQ(grids.foldedVoxels, folded.foldedVoxels);
  EXPECT_EQ(grids.foldedVoxelsLeft, 0u);
  EXPECT_GT(grids.jacobianMin, 0);
  ASSERT_TRUE(grids.repaired);
  EXPECT_EQ(grids.folded->activeVoxelCount(), folded.foldedVoxels);  // the map's own, still
  EXPECT_EQ(grids.all().size(), folded.all().size() + 1);
  double farthest = 0;
  for (auto v = grids.map->cbeginValueOn(); v; ++v) {
    const openvdb::Coord at = v.getCoord();
    const double way = (*v - folded.map->tree().getValue(at)).length();
    if (grids.repaired->tree().isValueOn(at))
      EXPECT_NEAR(grids.repaired->tree().getValue(at), way, 1e-5);
    else
      EXPECT_EQ(way, 0);
    farthest = std::max(farthest, way);
  }
  EXPECT_NEAR(grids.repairedFarthest, farthest, 1e-5);
  // The cap that folds is shallower than a tenth of the cube, and so is what is done about it.
  EXPECT_LT(farthest, 0.2);
  EXPECT_LT(static_cast<double>(grids.repaired->activeVoxelCount()),
            0.05 * static_cast<double>(grids.interiorVoxels));
}

TEST(EvaluateMap, NoRepairWithoutFoldsNorForTheCallersGridsAlone) {
  const Solid solid(cube());
  EvaluateSettings settings{.repairUpTo = 1};
  EXPECT_FALSE(evaluate(chargedMap(), solid, 40, settings).repaired);
  settings.map = settings.jacobian = false;
  const MapGrids grids = evaluate(foldedMap(), solid, 64, settings);
  EXPECT_FALSE(grids.map);
  EXPECT_FALSE(grids.jacobian);
  EXPECT_EQ(grids.foldedVoxelsLeft, 0u);
}

TEST(EvaluateMap, RefusesBadSettingsAndStopsWhenCancelled) {
  const Solid solid(cube());
  const auto surface = levelSet(solid, 16);
  EvaluateSettings settings;
  settings.lame.mu = -1;
  EXPECT_THROW(evaluateMap(chargedMap(), solid, *surface, settings), SettingError);
  settings = {};
  settings.skin = 7;
  EXPECT_THROW(evaluateMap(chargedMap(), solid, *surface, settings), SettingError);
  settings = {};
  test::expectOverLimit(1000, [&] { evaluateMap(chargedMap(), solid, *surface, settings); });
  settings = {};
  test::expectCancels([&] { evaluateMap(chargedMap(), solid, *surface, settings); });
}

}  // namespace
}  // namespace innermap
