#include "innermap/tetra/compare_fem.h"

#include <gtest/gtest.h>

#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(CompareFemRelease, OrdersOnKnownFunctions) {
  const Solid solid(shapes::icosphere(4));
  CompareFemSettings settings;
  settings.resolutions = {12, 24, 48};
  settings.charges = {1500};
  settings.samples = 4000;
  const CompareFem result = compareFemOnFunctions(solid, settings);
  ASSERT_EQ(result.rows.size(), 4u);
  // A charge is near to a ball: errors fall as they should on finer meshes only.
  EXPECT_NEAR(result.valueOrder, 2, 0.3);
  EXPECT_NEAR(result.gradientOrder, 1, 0.2);
  const ComparedRow &finest = result.rows[2], &charges = result.rows[3];
  EXPECT_TRUE(charges.charges);
  EXPECT_LT(charges.value, finest.value);
  EXPECT_LT(charges.gradient, 0.1 * finest.gradient);
  EXPECT_GT(finest.jump, 0.5 * finest.gradient);  // it is of the same kind
  EXPECT_GT(finest.jump, 0);
  EXPECT_LT(finest.jump, result.rows[0].jump);
  for (const ComparedRow& row : result.rows) {
    EXPECT_GT(row.seconds, 0);
    EXPECT_GT(row.memory, 0u);
    EXPECT_GE(row.largest, 0);
  }
}

TEST(CompareFem, OnAMap) {
  const Mesh source = shapes::icosphere(3);
  Mesh target = source;
  for (Vec3& p : target.vertices) p = {p.x + 0.3 * p.y * p.y, 1.2 * p.y, p.z + 0.2 * p.x};
  CompareFemSettings settings;
  settings.resolutions = {8, 16};
  settings.tolerances = {4e-3};
  settings.referenceTolerance = 2e-4;
  settings.samples = 1000;
  const CompareFem result = compareFemOnMap(makeBoundaryPair(source, target), settings);
  ASSERT_EQ(result.rows.size(), 3u);
  EXPECT_GT(result.referenceRms, 0);
  EXPECT_FALSE(result.notes.empty());
  for (const ComparedRow& row : result.rows) {
    EXPECT_LT(row.value, 0.01);
    EXPECT_LT(row.gradient, 0.2);
    EXPECT_EQ(row.inverted, 0u);
    EXPECT_NEAR(row.folded, 0, 1e-12);
    EXPECT_NEAR(row.harmonicEnergy, result.rows[2].harmonicEnergy, 0.05);
  }
  EXPECT_LT(result.rows[1].value, result.rows[0].value);
}

TEST(CompareFem, RefusesNonsense) {
  const Solid solid(shapes::icosphere(2));
  CompareFemSettings settings;
  settings.resolutions = {};
  EXPECT_THROW(compareFemOnFunctions(solid, settings), SettingError);
  settings.resolutions = {32, 16};
  EXPECT_THROW(compareFemOnFunctions(solid, settings), SettingError);
  settings.resolutions = {8};
  settings.charges = {1};
  EXPECT_THROW(compareFemOnFunctions(solid, settings), SettingError);
  settings.charges = {100};
  EXPECT_GT(compareFemMemory(solid, settings), 0u);
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(compareFemOnFunctions(solid, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
