#include <gtest/gtest.h>

#include <filesystem>

#include "core/expect.h"
#include "field/affine_map.h"
#include "innermap/core/error.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/io/pictures.h"
#include "innermap/io/solid_pictures.h"
#include "io/test_files.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// A square in the plane z = 0, its left half red and its right half green.
PictureSurface square(double z = 0) {
  PictureSurface s{.label = "square",
                   .vertices = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}},
                   .triangles = {{0, 1, 2}, {0, 2, 3}}};
  const Points at = s.vertices;
  const auto triangles = s.triangles;
  s.colours = [at, triangles](const std::vector<VisiblePoint>& points) {
    std::vector<Vec3> colours;
    for (const VisiblePoint& p : points) {
      double x = 0;
      for (int k = 0; k < 3; ++k) x += p.barycentric[k] * at[triangles[p.triangle][k]].x;
      colours.push_back(x < 0 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    }
    return colours;
  };
  return s;
}

MeshPictureSettings frontal(int pixels = 100) { return {.pixels = pixels, .from = {{0, 0, 1}}}; }

Vec3 pixel(const Pixels& p, int x, int y) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * p.width + x);
  return {p.rgb[i], p.rgb[i + 1], p.rgb[i + 2]};
}

TEST(MeshPicture, ShowsTheColoursWhereTheyAre) {
  const test::TemporaryFolder folder;
  writeMeshPicture(folder.file("a.png"), {square()}, frontal());
  const Pixels p = readImage(folder.file("a.png")).pixels;
  EXPECT_EQ(p.width, 148);
  EXPECT_EQ(p.height, 168);
  const int y = 44 + 50;
  EXPECT_GT(pixel(p, 24 + 25, y).x, 0.3);
  EXPECT_LT(pixel(p, 24 + 25, y).y, 0.01);
  EXPECT_GT(pixel(p, 24 + 75, y).y, 0.3);
  EXPECT_LT(pixel(p, 24 + 75, y).x, 0.01);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(p, 5, y)[c], 1, 1e-6);
}

TEST(MeshPicture, SeenFromBehindLeftAndRightAreExchanged) {
  const test::TemporaryFolder folder;
  MeshPictureSettings settings = frontal();
  settings.from = {{0, 0, -1}};
  writeMeshPicture(folder.file("a.png"), {square()}, settings);
  const Pixels p = readImage(folder.file("a.png")).pixels;
  EXPECT_GT(pixel(p, 24 + 25, 94).y, 0.3);
  EXPECT_GT(pixel(p, 24 + 75, 94).x, 0.3);
}

TEST(MeshPicture, TheNearestTriangleIsSeen) {
  PictureSurface s = square();
  const PictureSurface front = square(0.5);
  for (const Vec3& v : front.vertices) s.vertices.push_back(v);
  s.triangles.insert(s.triangles.begin(), {{4, 5, 6}, {4, 6, 7}});
  s.colours = [](const std::vector<VisiblePoint>& points) {
    std::vector<Vec3> colours;
    for (const VisiblePoint& p : points)
      colours.push_back(p.triangle < 2 ? Vec3{0, 0, 1} : Vec3{1, 0, 0});
    return colours;
  };
  const test::TemporaryFolder folder;
  writeMeshPicture(folder.file("a.png"), {s}, frontal());
  const Pixels p = readImage(folder.file("a.png")).pixels;
  EXPECT_GT(pixel(p, 74, 94).z, 0.3);
  EXPECT_LT(pixel(p, 74, 94).x, 0.01);
}

TEST(MeshPicture, HasAColumnForEachSurfaceAndARowForEachDirection) {
  const test::TemporaryFolder folder;
  MeshPictureSettings settings = frontal();
  settings.from = {{0, 0, 1}, {0, 0, -1}};
  settings.caption = "below";
  writeMeshPicture(folder.file("a.png"), {square(), square()}, settings);
  const Pixels p = readImage(folder.file("a.png")).pixels;
  EXPECT_EQ(p.width, 24 + 2 * 124);
  EXPECT_EQ(p.height, 44 + 2 * 124 + 40);
  EXPECT_GT(pixel(p, 24 + 124 + 25, 94).x, 0.3);
  EXPECT_GT(pixel(p, 24 + 124 + 25, 94 + 124).y, 0.3);
}

TEST(MeshPicture, RefusesWhatCannotBeShown) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  EXPECT_THROW(writeMeshPicture(path, {}, frontal()), DataError);
  PictureSurface empty = square();
  empty.triangles.clear();
  EXPECT_THROW(writeMeshPicture(path, {empty}, frontal()), DataError);
  EXPECT_THROW(writeMeshPicture(path, {square()}, frontal(10)), SettingError);
  MeshPictureSettings settings = frontal();
  settings.from = {{0, 0, 0}};
  EXPECT_THROW(writeMeshPicture(path, {square()}, settings), SettingError);
  settings = frontal();
  test::expectCancels([&] { writeMeshPicture(path, {square()}, settings); });
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THROW(writeMeshPicture("/nowhere/a.png", {square()}, frontal()), FileError);
}

// Corresponding points have one colour: a ball on itself looks alike on both sides.
TEST(CorrespondencePicture, ShowsPlacesByColour) {
  Mesh ball = shapes::icosphere(2);
  for (Vec3& p : ball.vertices) p = {1.3 * p.x, p.y * (1 + 0.3 * p.x), 0.8 * p.z};
  ball.name = "ball.obj";
  const MeshCorrespondence map = correspondMeshes(ball, ball, {.aligned = true, .candidates = 1});
  const test::TemporaryFolder folder;
  writeCorrespondencePicture(folder.file("a.png"), map, frontal(200));
  const Pixels p = readImage(folder.file("a.png")).pixels;
  const int half = (p.width - 24) / 2;  // one margin before, one between, one after
  double difference = 0;
  int compared = 0, coloured = 0;
  for (int y = p.height / 3; y < 2 * p.height / 3; ++y)
    for (int x = half / 3; x < 2 * half / 3; ++x, ++compared) {
      difference += norm(pixel(p, x, y) - pixel(p, x + half, y));
      coloured += norm(pixel(p, x, y) - pixel(p, half / 2, y)) > 0.02;
    }
  EXPECT_GT(coloured, compared / 2);
  EXPECT_LT(difference / compared, 0.02);
}

// A cube that each step moves by a little.
MappedSolid inSteps(int steps) {
  const HarmonicMap step = test::affineMap(test::kIdentity, {0.1, 0, 0});
  const Mesh cube = shapes::box({-1, -1, -1}, {1, 1, 1});
  return {ComposedMap(std::vector<HarmonicMap>(static_cast<std::size_t>(steps), step)),
          makeBoundaryPair(cube, cube),
          {},
          {}};
}

TEST(StepsPicture, ShowsSourceAndStepsSideBySideButNoMoreThanSeven) {
  const test::TemporaryFolder folder;
  const auto widthOf = [&](int steps) {
    writeStepsPicture(folder.file("a.png"), inSteps(steps), frontal());
    return readImage(folder.file("a.png")).pixels.width;
  };
  const int two = widthOf(1), seven = widthOf(6);
  EXPECT_GT(seven, 2 * two);
  EXPECT_EQ(widthOf(20), seven);
}

TEST(StepsPicture, ColoursSayWhereThePointsComeFrom) {
  const test::TemporaryFolder folder;
  writeStepsPicture(folder.file("a.png"), inSteps(1), frontal());
  const Pixels p = readImage(folder.file("a.png")).pixels;
  const int y = 44 + 50, half = p.width / 2;
  for (int x = 24 + 10; x < half - 24 - 10; x += 7) {
    const Vec3 source = pixel(p, x, y), moved = pixel(p, x + half - 12, y);
    EXPECT_LT(norm(source - moved), 0.1) << x;
  }
}

}  // namespace
}  // namespace innermap
