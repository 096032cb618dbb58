#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

using openvdb::FloatGrid;

LevelSetSettings fogResolution(int n) { return {.resolution = n}; }

TEST(Fog, CellFractionAgreesWithCounting) {
  const CounterRandom random(6, 6);
  const int n = 40;
  for (int i = 0; i < 60; ++i) {
    Vec3 normal = shapes::randomPoint(random, i);
    if (i % 5 == 1) normal.x = 0;
    if (i % 5 == 2) normal.x = 1e-7, normal.y = 1e-5;
    if (i % 5 == 3) normal = {0, 0, -1};
    normal = normal / norm(normal);
    const double d = (2 * random.uniform(9000 + i) - 1) * 0.9;
    double below = 0;
    for (int x = 0; x < n; ++x) {
      for (int y = 0; y < n; ++y) {
        for (int z = 0; z < n; ++z) {
          const Vec3 p{(x + 0.5) / n - 0.5, (y + 0.5) / n - 0.5, (z + 0.5) / n - 0.5};
          // The share of a small cell is taken as a ramp.
          below += std::clamp(0.5 - (dot(normal, p) + d) * n, 0.0, 1.0);
        }
      }
    }
    EXPECT_NEAR(cellFraction(d, normal), below / (n * n * n), 2e-3);
    EXPECT_NEAR(cellFraction(d, normal) + cellFraction(-d, normal), 1, 1e-12);
  }
  EXPECT_DOUBLE_EQ(cellFraction(0, {1, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(cellFraction(0.2, {0, 1, 0}), 0.3);
  EXPECT_EQ(cellFraction(0.9, {0, 1, 0}), 0);
  EXPECT_EQ(cellFraction(-0.9, {0, 1, 0}), 1);
  // A corner cut off at one tenth of each edge: a tetrahedron.
  const double s = 1 / std::sqrt(3.0);
  EXPECT_NEAR(cellFraction((1.5 - 0.1) * s, {s, s, s}), 1e-3 / 6, 1e-15);
}

double fogVolume(const FloatGrid& fog) {
  double sum = 0;
  for (auto value = fog.cbeginValueOn(); value; ++value)
    sum += double(value.getValue()) * static_cast<double>(value.getVoxelCount());
  return sum * std::pow(fog.voxelSize()[0], 3);
}

TEST(FogRelease, VolumeConvergesAtSecondOrder) {
  for (const Mesh& mesh : {shapes::icosphere(6), shapes::torus(400, 200)}) {
    SCOPED_TRACE(mesh.name);
    const Solid solid(mesh);
    std::vector<double> errors;
    for (const int n : {20, 40, 80}) {
      const FloatGrid::Ptr levelSet = makeLevelSet(solid, fogResolution(n));
      const double volume = fogVolume(*makeFog(*levelSet));
      errors.push_back(std::abs(volume / solid.volume() - 1));
      EXPECT_NEAR(insideVolume(*levelSet), volume, 1e-7 * volume);  // a fog's values are floats
    }
    // A factor of 16 in theory for two halvings; the error of a lattice sum fluctuates.
    EXPECT_LT(errors[2], errors[0] / 10);
    EXPECT_LT(errors[2], 1e-3);
  }
}

TEST(Fog, IsAFogVolume) {
  const Solid solid(shapes::torus(60, 30));
  const FloatGrid::Ptr levelSet = makeLevelSet(solid, fogResolution(64));
  const FloatGrid::Ptr fog = makeFog(*levelSet);
  EXPECT_EQ(fog->getName(), "density");
  EXPECT_EQ(fog->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(fog->background(), 0);
  EXPECT_EQ(openvdb::tools::checkFogVolume(*fog, 9), "");
  for (auto value = fog->cbeginValueAll(); value; ++value) EXPECT_EQ(value.isValueOn(), *value > 0);
  // The level set is as it was.
  EXPECT_EQ(openvdb::tools::checkLevelSet(*levelSet, 9), "");
  FloatGrid::Ptr other = levelSet->deepCopy();
  other->setGridClass(openvdb::GRID_UNKNOWN);
  EXPECT_THROW(makeFog(*other), DataError);
}

}  // namespace
}  // namespace innermap
