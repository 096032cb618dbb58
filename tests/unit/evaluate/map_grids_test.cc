#include "innermap/evaluate/map_grids.h"

#include <gtest/gtest.h>

#include <cmath>

#include "boundary/test_pairs.h"
#include "innermap/boundary/fit_map.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

MapFit affineFit() {
  const Mesh source = ball(2);
  return fitMap(source, moved(source, affineMap));
}

TEST(MapGrids, HoldTheMapAndItsTotals) {
  const MapFit fit = affineFit();
  MapGridSettings settings;
  settings.resolution = 24;
  const SolidGrids grids = evaluateOnGrid(fit, settings);
  std::vector<std::string> names;
  for (const auto& grid : grids.all()) names.push_back(grid->getName());
  EXPECT_EQ(names, (std::vector<std::string>{"surface", "density", "map", "jacobian",
                                             "harmonic_energy", "deformation_energy"}));
  const double det = determinant(fit.map.jacobian({0, 0, 0}));
  EXPECT_NEAR(grids.values.jacobianMin, det, 1e-5 * det);
  EXPECT_NEAR(grids.values.jacobianMax, det, 1e-5 * det);
  EXPECT_EQ(grids.values.foldedFraction, 0);
  const openvdb::Coord origin =
      grids.surface->transform().worldToIndexNodeCentered(openvdb::Vec3d(0));
  const openvdb::Vec3d centre = grids.surface->indexToWorld(origin);
  const openvdb::Vec3f mapped = grids.values.map->tree().getValue(origin);
  EXPECT_LT(norm(Vec3{mapped.x(), mapped.y(), mapped.z()} -
                 affineMap({centre.x(), centre.y(), centre.z()})),
            1e-5);
}

TEST(MapGrids, CarryTheFactsInTheirMetadata) {
  const MapFit fit = affineFit();
  MapGridSettings settings;
  settings.resolution = 16;
  for (const auto& grid : evaluateOnGrid(fit, settings).all()) {
    EXPECT_EQ(grid->metaValue<std::string>("innermap_tolerance_met"), "true");
    EXPECT_EQ(grid->metaValue<double>("innermap_folded_fraction"), 0);
    EXPECT_EQ(grid->metaValue<double>("innermap_lame_mu"), settings.lame.mu);
  }
}

TEST(MapGrids, VoxelSizeStandsInForTheResolution) {
  MapGridSettings settings;
  settings.voxelSize = 0.2;
  EXPECT_DOUBLE_EQ(evaluateOnGrid(affineFit(), settings).voxelSize, 0.2);
}

TEST(MapGrids, CountTheirMemory) {
  const Solid solid(ball(2));
  MapGridSettings settings;
  const std::uint64_t coarse = mapGridMemory(solid, settings);
  settings.resolution = 512;
  EXPECT_GT(mapGridMemory(solid, settings), 10 * coarse);
  settings.maxMemory = 1000;
  EXPECT_THROW(evaluateOnGrid(affineFit(), settings), MemoryError);
}

}  // namespace
}  // namespace innermap
