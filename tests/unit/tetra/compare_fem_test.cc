#include "innermap/tetra/compare_fem.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(CompareFem, RefusesNonsense) {
  const Solid solid(shapes::icosphere(2));
  EXPECT_THROW(compareFemOnFunctions(solid, {.resolutions = {}}), SettingError);
  EXPECT_THROW(compareFemOnFunctions(solid, {.resolutions = {32, 16}}), SettingError);
  EXPECT_THROW(compareFemOnFunctions(solid, {.resolutions = {8}, .charges = {1}}), SettingError);
  EXPECT_GT(compareFemMemory(solid, {.resolutions = {8}, .charges = {100}}), 0u);
  test::expectCancels(
      [&] { compareFemOnFunctions(solid, {.resolutions = {8}, .charges = {100}}); });
}

}  // namespace
}  // namespace innermap
