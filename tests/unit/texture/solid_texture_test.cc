#include "innermap/texture/solid_texture.h"

#include <gtest/gtest.h>

#include <limits>

#include "innermap/core/error.h"
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

SolidTextureSettings coarse(TextureMode mode) {
  openvdb::initialize();
  return {.mode = mode, .resolution = 24, .sources = 300};
}

const TextureLookup kGreen = [](const Vec2&, const Vec2&, const Vec2&) {
  return Vec3{0, 0.75, 0.25};
};

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

}  // namespace
}  // namespace innermap
