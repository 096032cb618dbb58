#include "innermap/texture/solid_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/memory_limit.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// Linear in space, so that it is its own continuation.
Vec3 linearColour(const Vec3& p) {
  return {0.5 + 0.3 * p.x, 0.4 - 0.2 * p.y + 0.1 * p.z, 0.5 + 0.25 * p.z};
}

Mesh colouredBall() {
  Mesh mesh = shapes::icosphere(2);
  for (const Vec3& v : mesh.vertices) {
    const Vec3 c = linearColour(v);
    mesh.colours.push_back(
        {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)});
  }
  return mesh;
}

// Coordinates (x, y), the same on both sides of every edge.
Mesh ballWithUvs() {
  Mesh mesh = shapes::icosphere(2);
  for (const Vec3& v : mesh.vertices) mesh.uvs.push_back({v.x, v.y});
  mesh.uvTriangles = mesh.triangles;
  return mesh;
}

// Each side of the cube is a chart of its own: a square, beside that of the side before.
Mesh cubeOfCharts() {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t square = t / 2;
    const auto side = static_cast<double>(square);
    Triangle uv;
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
      const int axis = t < 4 ? 2 : t < 8 ? 1 : 0;
      uv[k] = static_cast<int>(mesh.uvs.size());
      mesh.uvs.push_back({2 * side + p[(axis + 1) % 3], p[(axis + 2) % 3]});
    }
    mesh.uvTriangles.push_back(uv);
  }
  return mesh;
}

SolidTextureSettings coarse(TextureMode mode) {
  openvdb::initialize();
  SolidTextureSettings s;
  s.mode = mode;
  s.resolution = 24;
  s.sources = 300;
  return s;
}

const TextureLookup kGreen = [](const Vec2&, const Vec2&, const Vec2&) {
  return Vec3{0, 0.75, 0.25};
};
const TextureLookup kCoordinates = [](const Vec2& uv, const Vec2&, const Vec2&) {
  return Vec3{uv.x, uv.y, 0.5};
};

// expected: of a voxel's centre; inside the solid alone.
template <class Expected>
double largestError(const SolidTexture& made, const openvdb::Vec3fGrid& grid,
                    const Expected& expected) {
  double largest = 0;
  const auto surface = made.surface->getConstAccessor();
  for (auto it = grid.cbeginValueOn(); it; ++it) {
    if (!(surface.getValue(it.getCoord()) < 0)) continue;
    const openvdb::Vec3d p = grid.indexToWorld(it.getCoord());
    const Vec3 error = Vec3{(*it)[0], (*it)[1], (*it)[2]} - expected(Vec3{p.x(), p.y(), p.z()});
    largest = std::max(largest, norm(error));
  }
  return largest;
}

TEST(SolidTexture, LinearVertexColoursAreReproducedInside) {
  const SolidTexture made =
      makeSolidTexture(colouredBall(), {}, coarse(TextureMode::vertexColours));
  EXPECT_LT(largestError(made, *made.colour, linearColour), 2e-4);
  EXPECT_LT(made.colourError.max, 0.01);  // the skin has the colours of the closest point
  EXPECT_LT(made.fit.error.max, 2e-4);
  EXPECT_EQ(made.fit.channels, 3u);
  EXPECT_FALSE(made.uv);
  EXPECT_FALSE(made.seams);
  EXPECT_EQ(made.colourErrorAtSeams.samples, 0u);
  EXPECT_EQ(made.grids().size(), 3u);
  EXPECT_EQ(made.colour->getName(), "Cd");
  EXPECT_EQ(made.colour->metaValue<std::string>("innermap_texture_mode"), "colour");
  EXPECT_GE(made.fit.sources, 300u);
  EXPECT_GT(made.fit.collocation, 900u);
}

TEST(SolidTexture, VertexColoursAreDecoded) {
  SolidTextureSettings s = coarse(TextureMode::vertexColours);
  s.decode = [](double v) { return 1 - v; };
  const SolidTexture made = makeSolidTexture(colouredBall(), {}, s);
  EXPECT_LT(largestError(made, *made.colour,
                         [](const Vec3& p) {
                           return Vec3{1, 1, 1} - linearColour(p);
                         }),
            2e-4);
}

TEST(SolidTexture, CoordinatesAreContinuedAndLookedUp) {
  const SolidTexture made =
      makeSolidTexture(ballWithUvs(), kCoordinates, coarse(TextureMode::coordinates));
  const auto place = [](const Vec3& p) { return Vec3{p.x, p.y, 0}; };
  EXPECT_LT(largestError(made, *made.uv, place), 2e-4);
  EXPECT_LT(largestError(made, *made.colour,
                         [&](const Vec3& p) {
                           return place(p) + Vec3{0, 0, 0.5};
                         }),
            2e-4);
  ASSERT_TRUE(made.seams);
  EXPECT_EQ(made.seams->charts, 1);
  EXPECT_EQ(made.seams->edges, 0u);
  EXPECT_EQ(made.seams->areaShare, 0);
  EXPECT_EQ(made.colour->metaValue<std::string>("innermap_texture_seams"), "keep");
  const double volume = static_cast<double>(made.interiorVoxels) * std::pow(made.voxelSize, 3);
  EXPECT_NEAR(volume, 4.0, 0.15);
}

TEST(SolidTexture, ImageColoursComeWithTheirCoordinates) {
  const SolidTexture made =
      makeSolidTexture(ballWithUvs(), kCoordinates, coarse(TextureMode::imageColours));
  EXPECT_EQ(made.fit.channels, 6u);
  EXPECT_LT(largestError(made, *made.colour,
                         [](const Vec3& p) {
                           return Vec3{p.x, p.y, 0.5};
                         }),
            2e-4);
  EXPECT_LT(largestError(made, *made.uv, [](const Vec3& p) { return Vec3{p.x, p.y, 0}; }), 2e-4);
  EXPECT_EQ(made.grids().size(), 4u);
}

TEST(SolidTexture, SeamsAreCountedAndConstantColoursStayConstant) {
  SolidTextureSettings s = coarse(TextureMode::coordinates);
  s.seams = TextureSeams::blend;
  const SolidTexturePlan plan = planSolidTexture(cubeOfCharts(), s);
  EXPECT_EQ(plan.pieces, 6);
  EXPECT_EQ(plan.groups, 6);
  const SolidTexture made = makeSolidTexture(plan, kGreen);
  EXPECT_LT(largestError(made, *made.colour,
                         [](const Vec3&) {
                           return Vec3{0, 0.75, 0.25};
                         }),
            1e-6);
  ASSERT_TRUE(made.seams);
  EXPECT_EQ(made.seams->charts, 6);
  EXPECT_EQ(made.seams->edges, 12u);
  EXPECT_NEAR(made.seams->length, 12, 1e-9);
  EXPECT_NEAR(made.seams->lengthShare, 12 / (12 + 6 * std::sqrt(2.0)), 1e-9);
  EXPECT_EQ(made.seams->colourDifference.max, 0);
  // Two voxels to either side of each edge, 24 across.
  EXPECT_NEAR(made.seams->areaShare, 1 - std::pow(20.0 / 24, 2), 0.03);
  EXPECT_GT(made.seams->voxelShare, 0.03);
  EXPECT_LT(made.seams->voxelShare, 0.1);
  EXPECT_GT(made.colourErrorAtSeams.samples, 1000u);
  EXPECT_EQ(made.fit.channels, 18u);
  EXPECT_EQ(made.colour->metaValue<std::string>("innermap_texture_seams"), "blend");
}

TEST(SolidTexture, PlanSaysWhatItTakes) {
  SolidTextureSettings s = coarse(TextureMode::vertexColours);
  s.sources = 0;
  const SolidTexturePlan plan = planSolidTexture(colouredBall(), s);
  EXPECT_EQ(plan.sources, 1000u);  // the fewest
  EXPECT_NEAR(plan.voxelSize, 2.0 / 24, 0.01);
  EXPECT_GT(plan.memory, 1'000'000u);
  EXPECT_EQ(plan.mesh().vertices.size(), 162u);
  ASSERT_EQ(plan.seconds.size(), 1u);
  EXPECT_EQ(plan.seconds[0].first, "solid");
  const SolidTexture both =
      makeSolidTexture(colouredBall(), {}, coarse(TextureMode::vertexColours));
  ASSERT_EQ(both.seconds.size(), 8u);
  EXPECT_EQ(both.seconds.front().first, "solid");
  EXPECT_EQ(both.seconds.back().first, "figures");
}

TEST(SolidTexture, PartsWithoutCoordinatesAreNoted) {
  Mesh mesh = ballWithUvs();
  for (std::size_t t = 0; t < 32; ++t) mesh.uvTriangles[t] = {-1, -1, -1};
  const SolidTexture made = makeSolidTexture(mesh, kGreen, coarse(TextureMode::coordinates));
  ASSERT_EQ(made.notes.size(), 1u);
  EXPECT_NE(made.notes[0].find("10%"), std::string::npos) << made.notes[0];
}

TEST(SolidTexture, BadInputIsRefused) {
  SolidTextureSettings s = coarse(TextureMode::vertexColours);
  EXPECT_THROW(planSolidTexture(ballWithUvs(), s), DataError);
  Mesh mesh = colouredBall();
  mesh.colours[5][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(makeSolidTexture(mesh, {}, s), DataError);
  s.seams = TextureSeams::blend;
  EXPECT_THROW(planSolidTexture(colouredBall(), s), SettingError);

  s = coarse(TextureMode::coordinates);
  EXPECT_THROW(planSolidTexture(colouredBall(), s), DataError);
  EXPECT_THROW(makeSolidTexture(ballWithUvs(), {}, s), SettingError);
  mesh = ballWithUvs();
  mesh.uvs[7].x = 1e7;
  EXPECT_THROW(makeSolidTexture(mesh, kGreen, s), DataError);
  mesh = ballWithUvs();
  mesh.uvTriangles.assign(mesh.triangles.size(), {-1, -1, -1});
  EXPECT_THROW(makeSolidTexture(mesh, kGreen, s), DataError);
  s.resolution = 2;
  EXPECT_THROW(planSolidTexture(ballWithUvs(), s), SettingError);
  s = coarse(TextureMode::coordinates);
  s.sources = 2'000'000;
  EXPECT_THROW(planSolidTexture(ballWithUvs(), s), SettingError);
}

TEST(SolidTexture, MemoryAndCancellingAreMinded) {
  SolidTextureSettings s = coarse(TextureMode::vertexColours);
  {
    const MemoryLimit limit(1000);
    EXPECT_THROW(makeSolidTexture(colouredBall(), {}, s), MemoryError);
  }
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(makeSolidTexture(colouredBall(), {}, s), Cancelled);
}

}  // namespace
}  // namespace innermap
