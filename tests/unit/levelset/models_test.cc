// Real meshes, dirty ones among them, where they are at hand.
#include <gtest/gtest.h>

#include <filesystem>

#include "innermap/levelset/level_set.h"
#include "innermap/mesh/mesh_file.h"
#include "levelset/offset_surface.h"

namespace innermap {
namespace {

class Models : public testing::TestWithParam<const char*> {};

TEST_P(Models, LevelSetHoldsTheSolid) {
  const std::string path = (std::filesystem::path(INNERMAP_MODELS) / GetParam()).string();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Solid solid(readMesh(path));
  const LevelSetCheck check = checkLevelSet(*makeLevelSet(solid, {.resolution = 128}), solid);
  EXPECT_LT(check.volumeError, 0.01);
  EXPECT_LT(check.lostSurface, 0.001);
  for (const std::string& warning : check.warnings) ADD_FAILURE() << warning;

  const double d = 0.0125;
  const Mesh offset = offsetSurface(solid, {d});
  for (std::size_t v = 0; v < offset.vertices.size(); v += 17) {
    EXPECT_FALSE(solid.inside(offset.vertices[v]));
    EXPECT_NEAR(solid.distance(offset.vertices[v]), d * solid.diagonal(),
                0.05 * d * solid.diagonal());
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, Models,
                         testing::Values("horse-poses/reference.obj", "horse-poses/pose-03.obj",
                                         "spot.obj", "homer.obj", "fandisk.obj", "teapot.obj",
                                         "suzanne.obj", "stanford-bunny.obj", "rocker-arm.obj",
                                         "cheburashka.obj"));

}  // namespace
}  // namespace innermap
