// MEDIT's .mesh files (Frey, "MEDIT: an interactive mesh visualization software", INRIA RT-0253,
// 2001).
#include <fmt/format.h>

#include <cmath>

#include "core/output_buffer.h"
#include "core/text_scanner.h"
#include "io/cells/detail/cell_formats.h"

namespace innermap {
namespace {

// Sections of lower cells: numbers a row, with the reference where there is one.
struct Section {
  const char* name;
  int numbers;
  const char* leftOut;  // as a note calls them
};

constexpr Section kSections[] = {{"Triangles", 4, "triangles"},
                                 {"Quadrilaterals", 5, "quadrilaterals"},
                                 {"Edges", 3, "edges"},
                                 {"Corners", 1, "marks of corners"},
                                 {"Ridges", 1, "marks of ridges"},
                                 {"RequiredVertices", 1, "marks of required vertices"},
                                 {"RequiredEdges", 1, "marks of required edges"},
                                 {"RequiredTriangles", 1, "marks of required triangles"},
                                 {"Normals", 3, "normals"},
                                 {"Tangents", 3, "tangents"},
                                 {"NormalAtVertices", 2, "normals at vertices"}};

class MeditReader {
 public:
  explicit MeditReader(const FileBytes& file)
      : collector_(file.path), scanner_(file, {true, false}) {}

  CellFile read() {
    std::string_view word;
    bool version = false;
    while (scanner_.anyToken(word) && !equalsIgnoringCase(word, "End")) {
      if (word == "MeshVersionFormatted" || word == "Dimension") {
        const std::int64_t value = scanner_.integer(next());
        if (word == "Dimension" && value != 3)
          scanner_.fail(fmt::format("the mesh has {} dimensions; give one of a solid", value));
        version = true;
      } else if (!version) {
        scanner_.fail(inQuotes(word) +
                      " is not how a MEDIT file begins (MeshVersionFormatted); give a text .mesh "
                      "file");
      } else {
        readSection(word);
      }
    }
    addReferences();
    return collector_.finish();
  }

 private:
  std::string_view next() {
    std::string_view token;
    if (!scanner_.anyToken(token)) scanner_.fail("the file ends too early; export it again");
    return token;
  }

  std::uint64_t rows(int numbers) {
    const std::int64_t count = scanner_.integer(next());
    const auto room = static_cast<std::int64_t>((scanner_.remainingBytes() + 1) / 2);
    if (count < 0 || count > room / numbers)
      scanner_.fail(
          fmt::format("{} rows do not fit in the {} bytes left; the file is cut short or "
                      "its counts are wrong",
                      count, scanner_.remainingBytes()));
    return static_cast<std::uint64_t>(count);
  }

  void readSection(std::string_view word) {
    if (word == "Vertices") return readVertices();
    if (word == "Tetrahedra") return readCells(CellUse::tetrahedron, 4, tetReferences_);
    if (word == "Hexahedra" || word == "Hexaedra")
      return readCells(CellUse::hexahedron, 8, hexReferences_);
    for (const Section& section : kSections)
      if (word == section.name) return leaveOut(section);
    scanner_.fail(
        "the section " + inQuotes(word) +
        " is not read: only Tetrahedra and Hexahedra of first order (prisms, pyramids and "
        "curved cells must be split first)");
  }

  void readVertices() {
    if (!collector_.file.mesh.vertices.empty()) scanner_.fail("there are two sections of vertices");
    const std::uint64_t count = rows(4);
    collector_.requireCountable(count);
    collector_.file.mesh.vertices.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
      collector_.poll(i);
      Vec3 p;
      for (int a = 0; a < 3; ++a) p[a] = scanner_.number(next());
      collector_.file.mesh.vertices.push_back(p);
      vertexReferences_.push_back(scanner_.number(next()));
    }
  }

  void readCells(CellUse use, int corners, std::vector<double>& references) {
    const std::uint64_t count = rows(corners + 1);
    collector_.requireCountable(count + references.size());
    for (std::uint64_t i = 0; i < count; ++i) {
      collector_.poll(i);
      std::int64_t cell[8];
      for (int k = 0; k < corners; ++k) cell[k] = scanner_.integer(next()) - 1;
      // Cells may come before the vertices.
      pending_.insert(pending_.end(), cell, cell + corners);
      pendingUses_.push_back(use);
      references.push_back(scanner_.number(next()));
    }
  }

  void leaveOut(const Section& section) {
    const std::uint64_t count = rows(section.numbers);
    for (std::uint64_t i = 0; i < count * static_cast<std::uint64_t>(section.numbers); ++i) {
      collector_.poll(i);
      scanner_.number(next());
    }
    collector_.leaveOut(section.leftOut, count);
  }

  void addReferences() {
    const std::int64_t* cell = pending_.data();
    for (const CellUse use : pendingUses_) {
      collector_.addCell(use, cell);
      cell += use == CellUse::tetrahedron ? 4 : 8;
    }
    tetReferences_.insert(tetReferences_.end(), hexReferences_.begin(), hexReferences_.end());
    const auto add = [](std::vector<CellField>& fields, std::vector<double>& values) {
      bool some = false;
      for (const double value : values) some = some || value != 0;
      if (some) fields.push_back({kMeditReference, 1, CellField::Kind::scalar, values, true});
    };
    add(collector_.file.mesh.vertexFields, vertexReferences_);
    add(collector_.file.mesh.cellFields, tetReferences_);
  }

  CellCollector collector_;
  TextScanner scanner_;
  std::vector<double> vertexReferences_, tetReferences_, hexReferences_;
  std::vector<std::int64_t> pending_;
  std::vector<CellUse> pendingUses_;
};

int referenceAt(const CellField* field, std::size_t row) {
  const double value = field ? field->values[row] : 0;
  return std::abs(value) < 2e9 ? static_cast<int>(std::lround(value)) : 0;
}

template <class Cells>
void writeCells(OutputBuffer& out, const char* section, const Cells& cells, const CellField* field,
                std::size_t firstRow) {
  if (cells.empty()) return;
  out.print("{}\n{}\n", section, cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (const int v : cells[c]) out.print("{} ", v + 1);
    out.print("{}\n", referenceAt(field, firstRow + c));
  }
}

}  // namespace

CellFile readMedit(const FileBytes& file) { return MeditReader(file).read(); }

LostFields writeMedit(std::ostream& stream, const CellMesh& mesh) {
  const CellField* ofVertices = findField(mesh.vertexFields, kMeditReference);
  const CellField* ofCells = findField(mesh.cellFields, kMeditReference);
  LostFields lost;
  for (const CellField& field : mesh.vertexFields)
    if (&field != ofVertices) lost.push_back(field.name);
  for (const CellField& field : mesh.cellFields)
    if (&field != ofCells) lost.push_back(field.name);
  OutputBuffer out(stream);
  out.print("MeshVersionFormatted 2\nDimension 3\nVertices\n{}\n", mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& p = mesh.vertices[v];
    out.print("{} {} {} {}\n", p.x, p.y, p.z, referenceAt(ofVertices, v));
  }
  writeCells(out, "Tetrahedra", mesh.tetrahedra, ofCells, 0);
  writeCells(out, "Hexahedra", mesh.hexahedra, ofCells, mesh.tetrahedra.size());
  out.print("End\n");
  return lost;
}

}  // namespace innermap
