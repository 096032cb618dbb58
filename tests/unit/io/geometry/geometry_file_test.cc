#include "innermap/io/geometry_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/io/cell_file.h"
#include "innermap/mesh/mesh_file.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using test::pathOf;
using test::written;

// x goes to twice itself, y to y + x^2; points beyond x = 5 are cut.
CarriedPoints warp(const Points& points, bool jacobians) {
  CarriedPoints out;
  for (const Vec3& p : points) {
    out.points.push_back({2 * p.x, p.y + p.x * p.x, p.z});
    if (jacobians) out.jacobians.push_back({{{2, 0, 0}, {2 * p.x, 1, 0}, {0, 0, 1}}});
    out.fates.push_back(p.x > 5 ? PointFate::cut : PointFate::carried);
    out.cut += p.x > 5;
  }
  return out;
}

std::string carriedBytes(const std::string& name, const std::string& text, double subdivide = 0,
                         const ReadGeometrySettings& read = {}) {
  const auto file = readGeometry(written(name, text), read);
  const CarriedGeometry carried = carryGeometry(file->geometry, warp, {.subdivide = subdivide});
  writeGeometry(pathOf("out_" + name), *file, carried);
  return test::contents(pathOf("out_" + name));
}

void expectError(const std::string& name, const std::string& text, const std::string& part) {
  const std::string path = written(name, text);
  test::expectRefused([&] { readGeometry(path); }, part);
}

TEST(GeometryFile, ObjKeepsAllElse) {
  EXPECT_EQ(
      carriedBytes("a.obj",
                   "# head\nmtllib a.mtl\no body\nv 1 0 0 0.5 0.25 1  # red\nv 0 1 0\n"
                   "v 0 0 1\nvt 0.5 0.5\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\ng part\nusemtl skin\n"
                   "s off\nf 1/1/1 2/1/2 -1/-1/-1\nl 1 2\np 3\n"),
      "# head\nmtllib a.mtl\no body\nv 2 1 0 0.5 0.25 1  # red\nv 0 1 0\nv 0 0 1\nvt 0.5 0.5\n"
      "vn 0 0 1\nvn 0 1 0\nvn 1 0 0\ng part\nusemtl skin\ns off\nf 1/1/1 2/1/2 -1/-1/-1\n"
      "l 1 2\np 3\n");
}

TEST(GeometryFile, ObjNormalOfTwoPointsIsSplit) {
  const std::string out =
      carriedBytes("b.obj", "v 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 1 0\ng x\nf 1//1 2//1 3//1\n");
  // A^-T (0, 1, 0) at x = 1: (-1, 1, 0); at x = 0 as it was.
  EXPECT_EQ(out.substr(0, 29), "v 2 1 0\nv 0 1 0\nv 0 0 1\nvn -0");
  EXPECT_NE(out.find("\nvn 0 1 0\nvn 0 1 0\ng x\nf 1//1 2//2 3//3\n"), std::string::npos) << out;
}

TEST(GeometryFile, ObjWithoutWhatIsCut) {
  EXPECT_EQ(carriedBytes("c.obj",
                         "v 9 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\ng b\nf 2 3 4\n"
                         "l -4 -3\np 1 2\n"),
            "v 2 1 0\nv 0 1 0\nv 0 0 1\ng b\nf 1 2 3\np 1\n");
}

TEST(GeometryFile, ObjSubdivided) {
  const std::string out =
      carriedBytes("d.obj",
                   "v 0 0 0 1 0 0\nv 4 0 0 0 0 1\nv 4 2 0 0 0 1\nv 0 2 0 1 0 0\nvt 0 0\nvt 1 0\n"
                   "vt 1 1\nvt 0 1\ng q\nf 1/1 2/2 3/3 4/4\nl 1 2\n",
                   0.5);
  const auto file = readGeometry(written("d2.obj", out));
  // The lines y = 0 and y = 2 want chords of at most sqrt(2): four of width 1.
  EXPECT_GE(file->geometry.points.size(), 10u);
  EXPECT_NE(out.find("v 4 4 0 0.5 0 0.5\n"), std::string::npos) << out;
  EXPECT_NE(out.find("vt 0.5 0\n"), std::string::npos) << out;
  EXPECT_NO_THROW(readMesh(pathOf("d2.obj")));
}

const char kPly[] =
    "ply\nformat ascii 1.0\ncomment an element of surprise\nelement vertex 4\nproperty float x\n"
    "property float y\nproperty double z\nproperty uchar red\nproperty float nx\nproperty float "
    "ny\n"
    "property float nz\nproperty float v_x\nproperty float v_y\nproperty float v_z\n"
    "element face 2\nproperty list uchar int vertex_indices\nproperty int label\nend_header\n"
    "1 0 0.125 10 0 1 0 1 0 0\n0 1 0 20 0 0 1 0 1 0\n0 0 1 30 0 0 1 0 0 1\n9 0 0 40 0 0 1 0 0 1\n"
    "3 0 1 2 7\n3 1 2 3 8\n";

TEST(GeometryFile, PlyKeepsProperties) {
  const std::string out = carriedBytes("a.ply", kPly, 0, {.vectors = {"v"}});
  EXPECT_NE(out.find("element vertex 3\n"), std::string::npos);
  EXPECT_NE(out.find("element face 1\n"), std::string::npos);
  EXPECT_NE(out.find("comment an element of surprise\n"), std::string::npos);
  EXPECT_NE(out.find("2 1 0.125 10 -0.70710677 0.70710677 0 2 2 0\n"), std::string::npos) << out;
  EXPECT_NE(out.find("3 0 1 2 7\n"), std::string::npos) << out;
  EXPECT_EQ(out.find("40"), std::string::npos);
  EXPECT_THROW(carriedBytes("a.ply", kPly, 0, {.vectors = {"w"}}), FileError);
}

// Edges without ends stay as they are, and so do values of faces that are written anew, be they
// faces without corners.
TEST(GeometryFile, PlyKeepsWhatItDoesNotKnow) {
  const std::string out =
      carriedBytes("e.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\nelement void 9\nelement edge 1\nproperty int crease\n"
                   "element face 2\nproperty list uchar int vertex_indices\n"
                   "property list uchar float texcoord\nproperty float quality\nend_header\n"
                   "9 0 0\n0 1 0\n0 0 1\n7\n3 1 2 1 0 nan\n0 2 0.5 0.5 1\n");
  EXPECT_NE(out.find("element void 9\nelement edge 1\n"), std::string::npos) << out;
  EXPECT_NE(out.find(" 0 1 0\n 0 0 1\n7\n 3 0 1 0 0 nan\n 0 2 0.5 0.5 1\n"), std::string::npos)
      << out;
}

TEST(GeometryFile, TextIsAsStrictAsInMeshes) {
  for (const char* number : {"nan", "inf", "1e999", "1,5", "0x1", "1e"}) {
    SCOPED_TRACE(number);
    const std::string n = number;
    std::string ply = kPly;
    ply.replace(ply.find("0.125"), 5, n);
    expectError("n.ply", ply, "line 19");
    expectError("n.obj", "v 0 0 " + n + "\nf 1 1 1\n", "line 1");
    expectError("n.off", "OFF\n1 0 0\n0 0 " + n + "\n", "line 3");
    expectError("n.stl", "solid\nfacet normal 0 0 1\nvertex 0 0 " + n + "\n", "line 3");
  }
}

TEST(GeometryFile, PlySubdivided) {
  std::string text = kPly;
  text.replace(text.find("9 0 0 40"), 8, "2 0 0 40");
  const std::string out = carriedBytes("b.ply", text, 0.1);
  const auto file = readGeometry(written("b2.ply", out));
  EXPECT_GT(file->geometry.points.size(), 4u);
  EXPECT_GT(file->geometry.elements.size(), 2u);
  EXPECT_NO_THROW(readMesh(pathOf("b2.ply")));
}

TEST(GeometryFile, BinaryPlyBothWays) {
  for (const bool big : {false, true}) {
    std::string text = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                       "_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
                       "property double z\nproperty short id\nend_header\n";
    const auto put = [&](double value) {
      char bytes[8];
      std::memcpy(bytes, &value, 8);
      if (big) std::reverse(bytes, bytes + 8);
      text.append(bytes, 8);
    };
    std::string expected = text;
    put(1.0 / 3);
    put(1);
    put(-2);
    const std::string in = text + std::string("\x01\x02", 2);
    text = expected;
    put(2.0 / 3);
    put(1 + 1.0 / 9);
    put(-2);
    EXPECT_EQ(carriedBytes("c.ply", in), text + std::string("\x01\x02", 2));
  }
}

TEST(GeometryFile, OffAndStl) {
  EXPECT_EQ(
      carriedBytes("a.off",
                   "NOFF\n# by hand\n4 2 0\n1 0 0 0 0 1 255 0 0\n0 1 0 0 0 1\n"
                   "0 0 1 0 0 1\n7 0 0 0 0 1\n3 0 1 2 9 9 9\n3 1 2 3\n"),
      "NOFF\n# by hand\n3 1 0\n2 1 0 0 0 1 255 0 0\n0 1 0 0 0 1\n0 0 1 0 0 1\n3 0 1 2 9 9 9\n");
  EXPECT_EQ(carriedBytes("a.stl",
                         "solid s\n facet normal 0 0 1\n  outer loop\n   vertex 1 0 0\n"
                         "   vertex 0 1 0\n   vertex 0 0 0\n  endloop\n endfacet\n"
                         " facet normal 0 0 1\n  outer loop\n   vertex 9 0 0\n"
                         "   vertex 0 1 0\n   vertex 0 0 0\n  endloop\n endfacet\n"
                         "endsolid s\n"),
            "solid s\n facet normal 0 0 1\n  outer loop\n   vertex 2 1 0\n   vertex 0 1 0\n"
            "   vertex 0 0 0\n  endloop\n endfacet\nendsolid s\n");
  std::string binary(80, 'h');
  binary += std::string("\x01\0\0\0", 4);
  const float numbers[12] = {0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0};
  std::string expected = binary;
  binary.append(reinterpret_cast<const char*>(numbers), 48);
  const float moved[12] = {0, 0, 1, 2, 1, 0, 0, 1, 0, 0, 0, 0};
  expected.append(reinterpret_cast<const char*>(moved), 48);
  EXPECT_EQ(carriedBytes("b.stl", binary + "ab"), expected + "ab");
}

TEST(GeometryFile, CellsWithTheirFields) {
  CellMesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 0, 0}},
                .tetrahedra = {{0, 1, 2, 3}, {1, 4, 2, 3}, {0, 2, 1, 3}},
                .vertexFields = {{"fibre", 3, CellField::Kind::scalar, {}, false}}};
  for (int v = 0; v < 5; ++v)
    for (const double value : {1.0, 0.0, 0.0}) mesh.vertexFields[0].values.push_back(value);
  mesh.cellFields = {{"part", 1, CellField::Kind::scalar, {1, 2, 3}, true},
                     {"axis", 3, CellField::Kind::vector, {1, 0, 0, 1, 0, 0, 0, 0, 1}, false}};
  writeCells(pathOf("a.vtu"), mesh);
  const auto file = readGeometry(pathOf("a.vtu"), {.vectors = {"fibre"}});
  const CarriedGeometry carried = carryGeometry(file->geometry, warp);
  EXPECT_EQ(file->inverted(carried).cells, 2u);
  EXPECT_EQ(file->inverted(carried).before, 1u);
  EXPECT_EQ(file->inverted(carried).after, 1u);
  EXPECT_TRUE(writeGeometry(pathOf("a.msh"), *file, carried).empty());
  EXPECT_EQ(writeGeometry(pathOf("a.mesh"), *file, carried).size(), 3u);
  const CellMesh out = readCells(pathOf("a.msh")).mesh;
  ASSERT_EQ(out.vertices.size(), 4u);
  EXPECT_EQ(out.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {0, 2, 1, 3}}));
  ASSERT_EQ(out.vertexFields.size(), 1u);
  EXPECT_NEAR(out.vertexFields[0].values[3], 2, 1e-15);  // at x = 1: (2, 2, 0)
  EXPECT_NEAR(out.vertexFields[0].values[4], 2, 1e-15);
  ASSERT_EQ(out.cellFields.size(), 2u);
  EXPECT_EQ(out.cellFields[0].values, (std::vector<double>{1, 3}));
  EXPECT_NEAR(out.cellFields[1].values[1], 0.5, 1e-15);  // centre at x = 1/4
}

TEST(GeometryFile, BadInput) {
  expectError("x.obj", "v 0 0 0\nf 1 2 3\n", "out of range");
  expectError("x.obj", "v 0 0 nan\n", "line 1");
  expectError("x.obj", "v 0 0\n", "line 1");
  expectError("x.obj", "# nothing\n", "no points");
  expectError("x.ply", std::string(kPly).substr(0, sizeof kPly - 20), "cut short");
  std::string lying = kPly;
  lying.replace(lying.find("vertex 4"), 8, "vertex 4000000000");
  expectError("x.ply", lying, "do not fit");
  lying = kPly;
  lying.replace(lying.find("3 1 2 3 8"), 9, "3 1 2 4 8");
  expectError("x.ply", lying, "uses vertex 4");
  expectError("x.off", "OFF\n9 9 9\n0 0 0\n", "do not fit");
  expectError("x.stl", std::string(84, '\xff'), "cut short");
  const std::string facet = "facet normal 0 0 1\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  expectError("x.stl", "solid a\n" + facet, "cut short");
  expectError("x.stl", "solid a\n" + facet + facet + "endfacet\n", "within another");
  expectError("x.stl", "solid a\nendfacet\n", "three corners");
  expectError("x.xyz", "0 0 0\n", "unknown extension");
  EXPECT_THROW(requireWritableAs("a.obj", "b.ply"), FileError);
  EXPECT_THROW(requireWritableAs("a.vtu", "b.ply"), FileError);
  EXPECT_NO_THROW(requireWritableAs("a.VTU", "b.mesh"));
  test::expectOverLimit(1000, [&] { readGeometry(written("y.ply", kPly), {}); });
}

TEST(GeometryFile, DamagedBytesNeverCrash) {
  for (const char* name : {"z.ply", "z.obj"}) {
    const std::string text =
        name[2] == 'p'
            ? kPly
            : "v 1 0 0 1 1 1\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3//1\nl 1 2\n";
    for (std::size_t i = 0; i < text.size(); i += 3)
      for (const char with : {'\xff', '9', '\n', ' '}) {
        std::string changed = text;
        changed[i] = with;
        test::refusalOf([&] { carriedBytes(name, changed, 0.3); });
      }
  }
}

}  // namespace
}  // namespace innermap
