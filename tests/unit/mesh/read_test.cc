#include <gtest/gtest.h>

#include <clocale>
#include <cstring>
#include <filesystem>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::TemporaryFolder;

template <class T>
void append(std::string& out, T value, bool big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

class Read : public ::testing::Test {
 protected:
  Mesh read(const std::string& name, const std::string& content) {
    const Mesh mesh = readMesh(folder_.write(name, content));
    validate(mesh);
    return mesh;
  }
  TemporaryFolder folder_;
};

void expectPoint(const Vec3& p, double x, double y, double z) {
  EXPECT_EQ(p.x, x);
  EXPECT_EQ(p.y, y);
  EXPECT_EQ(p.z, z);
}

TEST_F(Read, ObjKeepsOrderColoursAndCornerUvs) {
  const Mesh mesh = read("a.OBJ",
                         "# comment\r\nmtllib none.mtl\r\nv +0.1 -2 -3e-1 1 0.5 0\r\n"
                         "v 1 0 0 0 0 2 # trailing\nv 1 1 0\nv 0 1 0 1 1 1\nv 9 9 9\n"
                         "vn 0 0 nan\nvt 0 0\nvt 1 0.25 0\nvt 1 1\ng group\nusemtl m\ns off\n"
                         "f 1/1/1 2/2/1 3/3/1 \\\n -2//1\n");
  ASSERT_EQ(mesh.vertices.size(), 5u);  // the loose one too
  expectPoint(mesh.vertices[0], 0.1, -2, -0.3);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.uvTriangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, -1}}));
  EXPECT_EQ(mesh.uvs[1].y, 0.25);
  ASSERT_EQ(mesh.colours.size(), 5u);
  EXPECT_EQ(mesh.colours[0], (std::array<float, 3>{1, 0.5f, 0}));
  EXPECT_EQ(mesh.colours[1], (std::array<float, 3>{0, 0, 1}));  // clamped
  EXPECT_EQ(mesh.colours[2], (std::array<float, 3>{1, 1, 1}));  // none given
  EXPECT_EQ(mesh.polygonStart, (std::vector<int>{0, 4}));
  EXPECT_EQ(mesh.polygonCorners, (std::vector<int>{0, 1, 2, 3}));
}

TEST_F(Read, ObjNegativeAndForwardIndices) {
  const Mesh mesh = read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nf 1 2 4\nv 0 0 1\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
  EXPECT_TRUE(mesh.polygonStart.empty());
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST_F(Read, ObjNumbersAreExact) {
  const Mesh mesh = read("a.obj",
                         "v 0.8405049999999999 0.1 123456789.123456789\nv 5e-324 1e-400 -0\n"
                         "v 1.7976931348623157e308 0 0\nf 1 2 3\n");
  expectPoint(mesh.vertices[0], 0.8405049999999999, 0.1, 123456789.123456789);
  expectPoint(mesh.vertices[1], 5e-324, 0, 0);
}

TEST_F(Read, NumbersDoNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (!std::setlocale(LC_ALL, "de_DE.UTF-8")) GTEST_SKIP() << "no German locale on this machine";
  const Mesh mesh = read("a.obj", "v 0.5 0 0\nv 1.5 0 0\nv 0 1 0\nf 1 2 3\n");
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(mesh.vertices[1].x, 1.5);
}

TEST_F(Read, PlyAsciiAnyOrderAndUnknownElements) {
  const Mesh mesh = read("a.ply",
                         "ply\nformat ascii 1.0\ncomment made by hand\nobj_info none\n"
                         "element face 2\nproperty uchar flags\n"
                         "property list uchar int vertex_index\n"
                         "element strange 2\nproperty list int float values\nproperty int n\n"
                         "element vertex 4\nproperty float quality\nproperty uchar blue\n"
                         "property uchar green\nproperty uchar red\nproperty double z\n"
                         "property double y\nproperty double x\nproperty float texture_u\n"
                         "property float texture_v\nend_header\n"
                         "7 3 0 1 2\n7 3 0 2 3\n3 1 2 3 5\n0 6\n"
                         "nan 255 0 51 3 2 1 0 0\n0 0 0 255 0 0 1 1 0\n"
                         "0 0 0 0 0 1 1 1 1\n0 0 0 0 0 1 0 0 1\n");
  ASSERT_EQ(mesh.vertices.size(), 4u);
  expectPoint(mesh.vertices[0], 1, 2, 3);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.colours[0], (std::array<float, 3>{0.2f, 0, 1}));
  EXPECT_EQ(mesh.uvTriangles, mesh.triangles);
  EXPECT_EQ(mesh.uvs[2].x, 1);
}

TEST_F(Read, PlyBinaryBothEndsAndAllTypes) {
  for (const bool big : {false, true}) {
    SCOPED_TRACE(big);
    std::string file = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                       "_endian 1.0\r\nelement vertex 3\r\nproperty char x\r\n"
                       "property ushort y\r\nproperty int z\r\nproperty float red\r\n"
                       "property float green\r\nproperty float blue\r\nproperty double s\r\n"
                       "property float t\r\nelement face 1\r\n"
                       "property list ushort uint vertex_indices\r\nend_header\r\n";
    for (int v = 0; v < 3; ++v) {
      append(file, static_cast<std::int8_t>(-v), big);
      append(file, static_cast<std::uint16_t>(300 * v * v), big);
      append(file, static_cast<std::int32_t>(10 + v), big);  // 10 is a line end: not the header's
      for (const float c : {0.25f, 0.5f, 2.0f}) append(file, c, big);
      append(file, 0.125 * v, big);
      append(file, 1.0f, big);
    }
    append(file, static_cast<std::uint16_t>(3), big);
    for (const unsigned i : {2u, 1u, 0u}) append(file, i, big);
    const Mesh mesh = read("a.ply", file);
    ASSERT_EQ(mesh.vertices.size(), 3u);
    expectPoint(mesh.vertices[2], -2, 1200, 12);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{2, 1, 0}}));
    EXPECT_EQ(mesh.colours[1], (std::array<float, 3>{0.25f, 0.5f, 1}));
    EXPECT_EQ(mesh.uvs[2].x, 0.25);
  }
}

TEST_F(Read, PlyTriangleStripsRestartAndTurn) {
  const Mesh mesh = read("a.ply",
                         "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
                         "property float y\nproperty float z\nelement tristrips 1\n"
                         "property list int int vertex_indices\nend_header\n"
                         "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0\n11 0 1 2 3 3 4 -1 2 3 4 -1\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}));
}

TEST_F(Read, PlyTextureCoordinatesOfFaceCorners) {
  const Mesh mesh = read("a.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                         "property float y\nproperty float z\nelement face 2\n"
                         "property list uchar int vertex_indices\n"
                         "property list uchar float texcoord\nend_header\n"
                         "0 0 0 1 0 0 0 1 0\n3 0 1 2 6 .1 .2 .3 .4 .5 .6\n3 0 2 1 0\n");
  EXPECT_EQ(mesh.uvTriangles, (std::vector<Triangle>{{0, 1, 2}, {-1, -1, -1}}));
  EXPECT_EQ(mesh.uvs[1].y, 0.4);
}

TEST_F(Read, OffInItsVariants) {
  const std::string body = "3 1 0\n0 0 0 $\n1 0 0 $\n\n# comment\n0 1 0 $ # here too\n3 0 1 2 9\n";
  const auto variant = [&](const std::string& keyword, const std::string& extra) {
    SCOPED_TRACE(keyword);
    std::string text = body;
    for (std::size_t at; (at = text.find('$')) != text.npos;) text.replace(at, 1, extra);
    const Mesh mesh = read("a.off", keyword + text);
    EXPECT_EQ(mesh.vertices.size(), 3u);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    return mesh;
  };
  EXPECT_TRUE(variant("OFF\n", "").colours.empty());
  variant("OFF ", "");
  variant("OFF", "");  // ModelNet's files
  EXPECT_EQ(variant("COFF\n", "255 0 51 255").colours[0], (std::array<float, 3>{1, 0, 0.2f}));
  EXPECT_EQ(variant("COFF\n", "0.5 0.25 1").colours[2], (std::array<float, 3>{0.5f, 0.25f, 1}));
  variant("NOFF\n", "0 0 nan");
  EXPECT_EQ(variant("STOFF\n", "0.5 0.75").uvs[1].y, 0.75);
  const Mesh all = variant("STCNOFF\n", "0 0 1 1 0 0 1 0.5 0.75");
  EXPECT_EQ(all.colours[1], (std::array<float, 3>{1.0f / 255, 0, 0}));
  EXPECT_EQ(all.uvs[1].x, 0.5);
}

TEST_F(Read, StlTextAndBinaryAreWelded) {
  const std::string text =
      "solid name\nfacet normal nan 0 0\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n"
      "  vertex 0 1 0\n endloop\nendfacet\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 1 0 -0.0\n"
      "vertex 1 1 0\nvertex -0 1 0\nendloop\nendfacet\nendsolid name\n";
  const std::vector<Triangle> expected{{0, 1, 2}, {1, 3, 2}};
  EXPECT_EQ(read("a.stl", text).triangles, expected);
  EXPECT_EQ(read("a.stl", text).vertices.size(), 4u);

  std::string binary = "solid in name only";
  binary.resize(80, ' ');
  append(binary, std::uint32_t(2));
  const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, 0, -0.0f, 1, 1, 0, -0.0f, 1, 0}};
  for (const auto& triangle : corners) {
    for (int k = 0; k < 3; ++k) append(binary, std::nanf(""));
    for (const float c : triangle) append(binary, c);
    append(binary, std::uint16_t(0));
  }
  EXPECT_EQ(read("a.stl", binary).triangles, expected);
}

TEST_F(Read, LikeTakesOverTheTriangulation) {
  // Convex in the first frame, concave at vertex 1 in the second: alone it would be cut otherwise.
  const std::string faces = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
  const std::string first = folder_.write("0.obj", "v 0 0 0\nv 2 -1 0\nv 3 0 0\nv 2 1 0\n" + faces);
  const std::string second =
      folder_.write("1.obj", "v 0 0 0\nv 1 0.5 0\nv 3 0 0\nv 2 1 0\n" + faces);
  const Mesh reference = readMesh(first);
  EXPECT_NE(readMesh(second).triangles, reference.triangles);
  const Mesh frame = readMeshLike(second, reference);
  EXPECT_EQ(frame.triangles, reference.triangles);
  EXPECT_EQ(frame.uvTriangles, reference.uvTriangles);
  EXPECT_EQ(frame.vertices[1].y, 0.5);
}

TEST_F(Read, LikeNamesTheFirstDifference) {
  const Mesh reference =
      readMesh(folder_.write("0.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"));
  const auto message = [&](const std::string& content) {
    const std::string path = folder_.write("1.obj", content);
    return test::refusalOf<DataError>([&] { readMeshLike(path, reference); });
  };
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(message(v + "f 1 2 3\nf 1 3 4\n"), "accepted");  // same triangles, no polygons
  EXPECT_NE(message(v + "f 2 3 4 1\n").find("polygon 0"), std::string::npos);
  EXPECT_NE(message(v + "f 1 2 3 4\nf 1 2 3\n").find("2 polygons"), std::string::npos);
  EXPECT_NE(message(v + "v 0 0 0\nf 1 2 3 4\n").find("5 vertices"), std::string::npos);
  EXPECT_NE(message(v + "f 1 2 4\nf 1 2 3\n").find("triangle 0"), std::string::npos);
}

TEST_F(Read, ATargetIsRelatedOrAStranger) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const Mesh source = readMesh(folder_.write("0.obj", v + "f 1 2 3 4\n"));
  EXPECT_TRUE(readTarget(folder_.write("1.obj", v + "f 1 2 3 4\n"), source).related);
  const TargetMesh stranger = readTarget(folder_.write("2.obj", v + "f 2 3 4 1\n"), source);
  EXPECT_FALSE(stranger.related);
  EXPECT_EQ(stranger.mesh.triangles.size(), 2u);
  EXPECT_THROW(readTarget(folder_.write("3.obj", "v 0 0\n"), source), FileError);
}

TEST_F(Read, CancelledReadsThrow) {
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  const std::string path = folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THROW(readMesh(path), Cancelled);
}

TEST(ReadModels, AllOfThemWithTheirCounts) {
  const std::string folder = INNERMAP_MODELS;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const Mesh bunny = readMesh(folder + "/stanford-bunny.obj");
  EXPECT_EQ(bunny.vertices.size(), 35947u);
  EXPECT_EQ(bunny.triangles.size(), 69451u);
  const Mesh spot = readMesh(folder + "/spot.obj");
  EXPECT_EQ(spot.vertices.size(), 2930u);
  EXPECT_EQ(spot.uvTriangles.size(), spot.triangles.size());
  const Mesh horse = readMesh(folder + "/horse-poses/reference.obj");
  EXPECT_EQ(readMeshLike(folder + "/horse-poses/pose-03.obj", horse).triangles, horse.triangles);
  EXPECT_THROW(readMeshLike(folder + "/spot.obj", horse), DataError);
}

}  // namespace
}  // namespace innermap
