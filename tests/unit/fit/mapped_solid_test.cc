#include "innermap/fit/mapped_solid.h"

#include <gtest/gtest.h>

#include "core/temporary_folder.h"
#include "fit/test_pairs.h"
#include "innermap/core/error.h"
#include "innermap/fit/fit_map.h"

namespace innermap {
namespace {

class MapFile : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(MapFile, GivesTheSameMapAndBoundaries) {
  const Mesh source = ball(2);
  const MapFit fit = fitMap(source, moved(source, harmonicPolynomial));
  writeMap(path("map.ply"), fit);
  const MappedSolid again = readMap(path("map.ply"));
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{0.3, -0.2, 0.5}})
    EXPECT_EQ(norm(again.map(p) - fit.map(p)), 0);
  EXPECT_EQ(again.facts, fit.facts);
  EXPECT_EQ(injectivityFacts(again.injectivity), injectivityFacts(fit.injectivity));
  EXPECT_GT(again.injectivity.inside.checked, 0u);
  EXPECT_EQ(again.boundary.source.mesh.name, "ball");
  EXPECT_EQ(again.boundary.targetMesh.name, "target");
  EXPECT_NEAR(again.boundary.target.volume, fit.boundary.target.volume, 1e-12);
}

TEST_F(MapFile, RefusesAFieldThatIsNoMap) {
  const Mesh source = ball(1);
  const HarmonicField one({{3, 0, 0}}, Matrix(1, 1), Affine{{}, Matrix(4, 1)});
  writeField(path("one.ply"), {{one}, {}, source.vertices, source.vertices, source.triangles});
  EXPECT_THROW(readMap(path("one.ply")), FileError);
  const HarmonicField three({{3, 0, 0}}, Matrix(1, 3), Affine{{}, Matrix(4, 3)});
  writeField(path("bare.ply"), {{three}, {}, {}, {}, {}});
  EXPECT_THROW(readMap(path("bare.ply")), FileError);
  EXPECT_THROW(readMap(path("missing.ply")), FileError);
}

TEST_F(MapFile, RefusesIndicesThatAreNotThere) {
  const Mesh source = ball(1);
  const HarmonicField three({{3, 0, 0}}, Matrix(1, 3), Affine{{}, Matrix(4, 3)});
  std::vector<Triangle> triangles = source.triangles;
  triangles[5][1] = 4000;
  EXPECT_THROW(
      {
        writeField(path("map.ply"), {{three}, {}, source.vertices, source.vertices, triangles});
        readMap(path("map.ply"));
      },
      Error);
}

TEST(SumAccuracy, FollowsTheMapsError) {
  EXPECT_DOUBLE_EQ(sumAccuracy(1e-4), 2e-6);
  EXPECT_DOUBLE_EQ(sumAccuracy(1), 1e-5);
  EXPECT_DOUBLE_EQ(sumAccuracy(0), 1e-9);
  const Mesh source = ball(2);
  const MapFit smooth = fitMap(source, moved(source, affineMap));
  EXPECT_LE(sumAccuracy(smooth), 1e-9);
}

}  // namespace
}  // namespace innermap
