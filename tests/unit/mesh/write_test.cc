#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::TemporaryFolder;

Mesh randomMesh(std::uint64_t seed) {
  const CounterRandom random(seed, 3);
  Mesh mesh = testing::cube();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double scale = std::pow(10.0, 600 * random.uniform(100 + v) - 300);
    mesh.vertices[v] = scale * shapes::randomPoint(random, v);
    mesh.colours.push_back({static_cast<float>(v) / 7, 0.1f, 1});
  }
  mesh.uvs = {{0.1, 0.2}, {1.0 / 3, 0}, {5, -1e-9}};
  mesh.uvTriangles.assign(mesh.triangles.size(), {0, 1, 2});
  mesh.uvTriangles[3] = {-1, 2, 0};
  return mesh;
}

void expectSamePositions(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(a.vertices[v][axis], b.vertices[v][axis]);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Write, ObjReadsBackToTheLastBit) {
  const TemporaryFolder folder;
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Mesh mesh = randomMesh(seed);
    writeMesh(folder.file("a.obj"), mesh);
    const Mesh back = readMesh(folder.file("a.obj"));
    expectSamePositions(mesh, back);
    EXPECT_EQ(mesh.colours, back.colours);
    EXPECT_EQ(mesh.uvTriangles, back.uvTriangles);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(mesh.uvs[k].x, back.uvs[k].x);
  }
}

TEST(Write, PlyReadsBackToTheLastBitColoursToEight) {
  const TemporaryFolder folder;
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Mesh mesh = randomMesh(seed);
    writeMesh(folder.file("a.PLY"), mesh);
    const Mesh back = readMesh(folder.file("a.PLY"));
    expectSamePositions(mesh, back);
    for (std::size_t v = 0; v < 8; ++v)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(mesh.colours[v][c], back.colours[v][c], 0.5 / 255);
  }
}

TEST(Write, RefusesOtherExtensionsAndPlaces) {
  const TemporaryFolder folder;
  EXPECT_THROW(writeMesh(folder.file("a.stl"), testing::cube()), FileError);
  EXPECT_THROW(writeMesh("a", testing::cube()), FileError);
  EXPECT_THROW(writeMesh(folder.file("none/a.ply"), testing::cube()), FileError);
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.stl")));
}

TEST(Write, PlyHasFurtherPropertiesOfTheVertices) {
  const TemporaryFolder folder;
  const std::string path = folder.file("extra.ply");
  const Mesh mesh = testing::cube();
  PlyExtras extras{.comment = "two properties"};
  std::vector<std::int32_t> integers;
  std::vector<double> numbers;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    integers.push_back(static_cast<std::int32_t>(v) - 3);
    numbers.push_back(0.1 * static_cast<double>(v));
  }
  extras.properties = {{"where", integers}, {"much", numbers}};
  writePly(path, mesh, extras);
  expectSamePositions(readMesh(path), mesh);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(bytes.find("1.0\ncomment two properties\nelement vertex 8\n"), std::string::npos);
  EXPECT_NE(bytes.find("property int where\nproperty double much\nelement face"),
            std::string::npos);
  const std::size_t row = 3 * 8 + 4 + 8, body = bytes.find("end_header\n") + 11;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    std::int32_t integer;
    double number;
    std::memcpy(&integer, &bytes[body + v * row + 24], 4);
    std::memcpy(&number, &bytes[body + v * row + 28], 8);
    EXPECT_EQ(integer, integers[v]);
    EXPECT_EQ(number, numbers[v]);
  }
  extras.properties[1].values = std::vector<double>{1, 2};
  EXPECT_THROW(writePly(path, mesh, extras), DataError);
}

}  // namespace
}  // namespace innermap
