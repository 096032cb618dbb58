#include "innermap/tetra/compare_fem.h"

#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

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
