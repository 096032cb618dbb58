#include "innermap/io/cell_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using test::pathOf;
using test::write;

// A cube and two tetrahedra on its top, with fields of each kind.
CellMesh mixed() {
  CellMesh mesh;
  mesh.name = "mixed";
  mesh.vertices = {{0, 0, 0}, {1, 0, 0},           {1, 1, 0}, {0, 1, 0},     {0, 0, 1},
                   {1, 0, 1}, {1, 1, 1.0 / 3 * 3}, {0, 1, 1}, {0.1, 0.2, 2}, {1e-9, 7, 7e100}};
  mesh.hexahedra = {{0, 1, 2, 3, 4, 5, 6, 7}};
  mesh.tetrahedra = {{4, 5, 6, 8}, {4, 6, 7, 8}};
  const std::size_t n = mesh.vertices.size();
  CellField heat{"heat <&> \"it\"", 1, CellField::Kind::scalar, {}, false};
  CellField flow{"flow", 3, CellField::Kind::vector, {}, false};
  for (std::size_t v = 0; v < n; ++v) {
    heat.values.push_back(1.0 / (1 + static_cast<double>(v)));
    for (int k = 0; k < 3; ++k) flow.values.push_back(static_cast<double>(v) + 0.1 * k);
  }
  mesh.vertexFields = {heat, flow};
  mesh.cellFields = {{"part", 1, CellField::Kind::scalar, {7, 8, 9}, true}};
  return mesh;
}

void expectSame(const CellMesh& a, const CellMesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    for (int k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(a.vertices[v][k], b.vertices[v][k]);
  EXPECT_EQ(a.tetrahedra, b.tetrahedra);
  EXPECT_EQ(a.hexahedra, b.hexahedra);
}

void expectSameFields(const std::vector<CellField>& a, const std::vector<CellField>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t f = 0; f < a.size(); ++f) {
    EXPECT_EQ(a[f].components, b[f].components);
    EXPECT_EQ(a[f].kind, b[f].kind);
    EXPECT_EQ(a[f].values, b[f].values);
  }
}

template <class E = FileError>
void expectError(const std::string& path, const std::string& part) {
  test::expectRefused<E>([&] { readCells(path); }, part);
}

TEST(CellFile, VtuComesBackAsItWas) {
  const std::string path = pathOf("mixed.vtu");
  EXPECT_TRUE(writeCells(path, mixed()).empty());
  const CellFile file = readCells(path);
  expectSame(file.mesh, mixed());
  expectSameFields(file.mesh.vertexFields, mixed().vertexFields);
  expectSameFields(file.mesh.cellFields, mixed().cellFields);
  EXPECT_EQ(file.mesh.vertexFields[0].name, "heat <&> \"it\"");
  EXPECT_TRUE(file.mesh.cellFields[0].whole);
  EXPECT_TRUE(file.notes.empty());
}

TEST(CellFile, MshComesBackAsItWas) {
  CellMesh mesh = mixed();
  mesh.cellFields.push_back({"gmsh:physical", 1, CellField::Kind::scalar, {3, 5, 5}, true});
  mesh.vertexFields[0].values[4] = std::numeric_limits<double>::quiet_NaN();
  const std::string path = pathOf("mixed.msh");
  EXPECT_TRUE(writeCells(path, mesh).empty());
  const CellFile file = readCells(path);
  expectSame(file.mesh, mesh);
  ASSERT_EQ(file.mesh.vertexFields.size(), 2u);
  EXPECT_TRUE(std::isnan(file.mesh.vertexFields[0].values[4]));
  EXPECT_EQ(file.mesh.vertexFields[1].values, mesh.vertexFields[1].values);
  EXPECT_EQ(file.mesh.vertexFields[1].kind, CellField::Kind::vector);
  ASSERT_EQ(file.mesh.cellFields.size(), 3u);  // groups, their volumes, parts
  EXPECT_EQ(file.mesh.cellFields[0].name, "gmsh:physical");
  EXPECT_EQ(file.mesh.cellFields[0].values, mesh.cellFields[1].values);
  EXPECT_EQ(file.mesh.cellFields[2].values, mesh.cellFields[0].values);
}

TEST(CellFile, MeditSaysWhatItCannotHold) {
  CellMesh mesh = mixed();
  mesh.cellFields.push_back({"medit:ref", 1, CellField::Kind::scalar, {1, 2, 3}, true});
  const std::string path = pathOf("mixed.mesh");
  EXPECT_EQ(writeCells(path, mesh), (std::vector<std::string>{"heat <&> \"it\"", "flow", "part"}));
  const CellFile file = readCells(path);
  expectSame(file.mesh, mesh);
  ASSERT_EQ(file.mesh.cellFields.size(), 1u);
  EXPECT_EQ(file.mesh.cellFields[0].values, mesh.cellFields[1].values);
}

TEST(CellFile, AFileCutShortAnywhereIsAnError) {
  for (const char* name : {"mixed.vtu", "mixed.msh", "mixed.mesh"}) {
    const std::string whole = pathOf(name), cut = pathOf(std::string("cut_") + name);
    writeCells(whole, mixed());
    const std::string bytes = test::contents(whole);
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 60);
    for (std::size_t size = 0; size + 60 < bytes.size(); size += step) {
      write(cut, bytes.substr(0, size));
      // What is cut behind the last thing that matters may be read.
      test::refusalOf([&] { expectSame(readCells(cut).mesh, mixed()); });
    }
    write(cut, bytes.substr(0, bytes.size() / 2));
    EXPECT_THROW(readCells(cut), Error) << name;
  }
}

TEST(CellFile, DamagedBytesNeverCrash) {
  for (const char* name : {"mixed.vtu", "mixed.msh", "mixed.mesh"}) {
    const std::string whole = pathOf(name), damaged = pathOf(std::string("damaged_") + name);
    writeCells(whole, mixed());
    const std::string bytes = test::contents(whole);
    for (std::size_t i = 0; i < bytes.size(); i += 13)
      for (const char with : {'\xff', '9', '\0'}) {
        std::string changed = bytes;
        changed[i] = with;
        write(damaged, changed);
        test::refusalOf([&] { validate(readCells(damaged).mesh); });
      }
  }
}

std::string meditOf(const std::string& body) {
  return "MeshVersionFormatted 2\nDimension\n3\n" + body + "End\n";
}

const char kFourVertices[] = "Vertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n";

TEST(CellFile, CountsBeyondTheFileAreRefusedBeforeMemoryIsTaken) {
  const std::string path = pathOf("counts.mesh");
  write(path, meditOf("Vertices\n2000000000\n0 0 0 0\n"));
  expectError(path, "do not fit");
  write(pathOf("counts.msh"), "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4000000000 1 4\n");
  expectError(pathOf("counts.msh"), "do not fit");
  write(pathOf("counts.vtu"),
        "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt64\"><UnstructuredGrid>"
        "<Piece NumberOfPoints=\"100000000\" NumberOfCells=\"1\"><Points><DataArray "
        "type=\"Float64\" NumberOfComponents=\"3\" "
        "format=\"binary\">AACU1NQAAAA=</DataArray></Points></Piece></UnstructuredGrid></VTKFile>");
  expectError(pathOf("counts.vtu"), "cut short");
}

TEST(CellFile, BadNumbersAndIndicesAreNamed) {
  const std::string path = pathOf("bad.mesh");
  write(path, meditOf("Vertices 1\n0 nan 0 0\nTetrahedra 0\n"));
  expectError(path, "line 5");
  write(path, meditOf(std::string(kFourVertices) + "Tetrahedra 1\n1 2 3 5 0\n"));
  expectError(path, "uses vertex 4, the file has 4");
  write(path, meditOf(std::string(kFourVertices) + "Tetrahedra 1\n1 2 3 3 0\n"));
  expectError<DataError>(path, "a vertex twice");
  write(path, meditOf(std::string(kFourVertices) + "Prisms 1\n1 2 3 4 5 6 0\n"));
  expectError(path, "Prisms");
  write(path, meditOf(std::string(kFourVertices) + "Triangles 1\n1 2 3 0\n"));
  expectError(path, "no tetrahedra and no hexahedra, only triangles");
  write(path,
        meditOf(std::string(kFourVertices) + "Triangles 1\n1 2 3 0\nTetrahedra 1\n1 2 3 4 0\n"));
  const CellFile file = readCells(path);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_NE(file.notes[0].find("1 triangles"), std::string::npos);
  EXPECT_EQ(file.mesh.tetrahedra.size(), 1u);
}

TEST(CellFile, Msh2IsReadAndOtherCellsRefused) {
  const std::string path = pathOf("old.msh");
  const std::string nodes =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n10 0 0 0\n20 1 0 0\n5 0 1 0\n7 0 0 1\n"
      "$EndNodes\n$Elements\n2\n1 2 2 1 1 10 20 5\n9 4 2 6 1 10 20 5 7\n$EndElements\n";
  write(path, nodes + "$ElementData\n1\n\"heat\"\n0\n3\n0\n1\n1\n9 2.5\n$EndElementData\n");
  const CellFile file = readCells(path);
  EXPECT_EQ(file.mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  ASSERT_EQ(file.mesh.cellFields.size(), 2u);
  EXPECT_EQ(file.mesh.cellFields[0].values, std::vector<double>{6});
  EXPECT_EQ(file.mesh.cellFields[1].values, std::vector<double>{2.5});
  std::string other = nodes;
  other.replace(other.find("9 4 2"), 5, "9 11 2");
  write(path, other);
  expectError(path, "higher order");
  write(path, "$MeshFormat\n4 0 8\n$EndMeshFormat\n");
  expectError(path, "version '4'");
}

TEST(CellFile, VtuAsTextAndItsOtherCells) {
  const auto text = [](const std::string& type, const std::string& extra) {
    return "<?xml version=\"1.0\"?>\n<!-- <a> -->\n<VTKFile type=\"UnstructuredGrid\">\n"
           "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n"
           "<PointData Vectors='v'><DataArray type=\"Float32\" Name=\"v\" "
           "NumberOfComponents=\"3\">1 0 0 0 1 0 0 0 1 1 1 1</DataArray></PointData>\n"
           "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n"
           "0 0 0 1 0 0 0 1 0 0 0 " +
           extra +
           "</DataArray></Points>\n<Cells>"
           "<DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 0 1 2 3</DataArray>"
           "<DataArray type=\"Int32\" Name=\"offsets\">3 7</DataArray>"
           "<DataArray type=\"UInt8\" Name=\"types\">5 " +
           type +
           "</DataArray>"
           "</Cells></Piece></UnstructuredGrid></VTKFile>\n";
  };
  const std::string path = pathOf("text.vtu");
  write(path, text("10", "1"));
  const CellFile file = readCells(path);
  EXPECT_EQ(file.mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_EQ(file.mesh.vertexFields[0].kind, CellField::Kind::vector);
  ASSERT_EQ(file.notes.size(), 1u);
  const char* const cases[][3] = {{"14", "1", "pyramids"},      {"24", "1", "higher order"},
                                  {"12", "1", "has 4 corners"}, {"10", "nan", "not finite"},
                                  {"10", "x", "line 7"},        {"10", "1 1", "13 numbers"}};
  for (const auto& [type, extra, says] : cases) {
    write(path, text(type, extra));
    expectError(path, says);
  }
}

TEST(CellFile, HangingVerticesAreCounted) {
  // A tetrahedron and two that share half of its face each.
  CellMesh mesh{.name = "hanging",
                .vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 1}, {0, 0, -1}, {1, 1, 0}},
                .tetrahedra = {{0, 1, 2, 3}, {0, 5, 1, 4}, {0, 2, 5, 4}}};
  const std::string path = pathOf("hanging.vtu");
  writeCells(path, mesh);
  const CellFile file = readCells(path);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_NE(file.notes[0].find(" 1 vertices"), std::string::npos) << file.notes[0];
}

TEST(CellFile, MemoryIsLimited) {
  const std::string path = pathOf("mixed.vtu");
  writeCells(path, mixed());
  test::expectOverLimit(1000, [&] { readCells(path); });
  EXPECT_THROW(readCells("nowhere.vtu"), FileError);
  EXPECT_THROW(readCells("nowhere.vtk"), FileError);
}

}  // namespace
}  // namespace innermap
