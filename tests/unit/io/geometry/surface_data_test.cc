#include <gtest/gtest.h>

#include <cmath>

#include "core/temporary_folder.h"
#include "innermap/core/error.h"
#include "innermap/io/geometry_file.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {
namespace {

class SurfaceData : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    return folder_.write(name, text);
  }
  test::TemporaryFolder folder_;
};

const char kObj[] =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n"
    "o all\ng low flat\nusemtl steel\nf 1 2 3 4\n"
    "g up\nf 1 2 5\nf 2 3 5\ng low\nf 3 4 5\ng empty\n";

TEST_F(SurfaceData, GroupsObjectsAndMaterials) {
  const std::string path = write("groups.obj", kObj);
  const Mesh mesh = readMesh(path);
  const std::vector<SurfaceGroup> groups = readGroups(path, mesh);
  ASSERT_EQ(groups.size(), 6u);
  EXPECT_EQ(groups[0].name, "all");
  EXPECT_EQ(groups[0].triangles, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(groups[1].name, "low");
  EXPECT_EQ(groups[1].triangles, (std::vector<int>{0, 1, 4}));  // a square is two triangles
  EXPECT_EQ(groups[2].triangles, (std::vector<int>{0, 1}));
  EXPECT_EQ(groups[3].name, "steel");
  EXPECT_EQ(groups[3].triangles, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(groups[4].triangles, (std::vector<int>{2, 3}));
  EXPECT_EQ(groups[5].name, "empty");
  EXPECT_TRUE(groups[5].triangles.empty());
}

TEST_F(SurfaceData, GroupsOfAnotherMeshAreRefused) {
  const std::string path = write("groups.obj", kObj);
  Mesh mesh = readMesh(path);
  mesh.polygonStart.clear();
  mesh.polygonCorners.clear();
  mesh.triangles.resize(3);
  EXPECT_THROW(readGroups(path, mesh), FileError);
  EXPECT_THROW(readGroups(write("a.off", "OFF\n"), mesh), FileError);
}

const char kFacesFirst[] =
    "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar label\nproperty double heat\nend_header\n"
    "3 0 1 2\n0 0 0 7 0.1\n1 0 0 8 0.2\n0 1 0 9 -3e2\n";

TEST_F(SurfaceData, PropertiesOfVertices) {
  const std::string path = write("data.ply", kFacesFirst);
  Mesh mesh;
  mesh.vertices.resize(3);
  const Matrix values = readVertexProperties(path, {"heat", "label"}, mesh);
  ASSERT_EQ(values.rows(), 3u);
  EXPECT_DOUBLE_EQ(values(2, 0), -300);
  EXPECT_DOUBLE_EQ(values(1, 1), 8);
  EXPECT_THROW(readVertexProperties(path, {"cold"}, mesh), FileError);
  mesh.vertices.resize(4);
  EXPECT_THROW(readVertexProperties(path, {"heat"}, mesh), FileError);
}

TEST_F(SurfaceData, TablesOfVertices) {
  Mesh mesh;
  mesh.name = "mesh";
  mesh.vertices.resize(4);
  const VertexTable table =
      readVertexTable(write("a.csv", "vertex,depth,side\n2,0.5,1\n\n0;1;-1 # note\n"), mesh);
  EXPECT_EQ(table.names, (std::vector<std::string>{"depth", "side"}));
  EXPECT_DOUBLE_EQ(table.values(2, 0), 0.5);
  EXPECT_DOUBLE_EQ(table.values(0, 1), -1);
  EXPECT_TRUE(std::isnan(table.values(1, 0)) && std::isnan(table.values(3, 1)));
  for (const char* bad : {"", "vertex,a\n", "0 1\n0 2\n", "4 1\n", "-1 1\n", "0 1\n1 2 3\n",
                          "0 x\n", "v,a,b\n0,1\n", "0 nan\n", "0\n"}) {
    SCOPED_TRACE(bad);
    EXPECT_THROW(readVertexTable(write("b.csv", bad), mesh), FileError);
  }
}

}  // namespace
}  // namespace innermap
