#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "core/base64.h"
#include "core/markup.h"
#include "io/cells/detail/cell_formats.h"

namespace innermap {
namespace {

// `add` puts `count` values of type T.
template <class T>
void writeArray(std::ostream& stream, const std::string& attributes, std::uint64_t count,
                const std::function<void(Base64Writer&)>& add) {
  stream << "        <DataArray " << attributes << " format=\"binary\">";
  {
    Base64Writer out(stream);
    out.add<std::uint64_t>(count * sizeof(T));
    add(out);
  }
  stream << "</DataArray>\n";
}

const char* kindOf(const CellField& field) {
  if (field.kind == CellField::Kind::vector) return " Kind=\"vector\"";
  return field.kind == CellField::Kind::normal ? " Kind=\"normal\"" : "";
}

bool fitsIntegers(const CellField& field) {
  for (const double value : field.values)
    if (!(std::abs(value) < 9e15) || value != std::floor(value)) return false;
  return true;
}

void writeField(std::ostream& stream, const CellField& field) {
  const bool whole = field.whole && fitsIntegers(field);
  std::string attributes = fmt::format("type=\"{}\" Name=\"{}\"{}", whole ? "Int64" : "Float64",
                                       markupText(field.name), kindOf(field));
  // Without the number, readers know a scalar from a vector of one component.
  if (field.components > 1)
    attributes += fmt::format(" NumberOfComponents=\"{}\"", field.components);
  writeArray<double>(stream, attributes, field.values.size(), [&](Base64Writer& out) {
    for (const double value : field.values)
      if (whole)
        out.add<std::int64_t>(static_cast<std::int64_t>(value));
      else
        out.add(value);
  });
}

void writeFields(std::ostream& stream, const char* tag, const std::vector<CellField>& fields) {
  stream << "      <" << tag;
  const auto active = [&](const char* attribute, CellField::Kind kind) {
    for (const CellField& field : fields)
      if (field.kind == kind && (kind != CellField::Kind::scalar || field.components == 1)) {
        stream << ' ' << attribute << "=\"" << markupText(field.name) << '"';
        return;
      }
  };
  active("Scalars", CellField::Kind::scalar);
  active("Vectors", CellField::Kind::vector);
  active("Normals", CellField::Kind::normal);
  stream << ">\n";
  for (const CellField& field : fields) writeField(stream, field);
  stream << "      </" << tag << ">\n";
}

void writeCells(std::ostream& stream, const CellMesh& mesh) {
  const std::uint64_t tets = mesh.tetrahedra.size(), hexes = mesh.hexahedra.size();
  stream << "      <Cells>\n";
  writeArray<std::int64_t>(stream, "type=\"Int64\" Name=\"connectivity\"", 4 * tets + 8 * hexes,
                           [&](Base64Writer& out) {
                             for (const Tetrahedron& cell : mesh.tetrahedra)
                               for (const int v : cell) out.add<std::int64_t>(v);
                             for (const Hexahedron& cell : mesh.hexahedra)
                               for (const int v : cell) out.add<std::int64_t>(v);
                           });
  writeArray<std::int64_t>(stream, "type=\"Int64\" Name=\"offsets\"", tets + hexes,
                           [&](Base64Writer& out) {
                             for (std::uint64_t c = 1; c <= tets; ++c)
                               out.add(static_cast<std::int64_t>(4 * c));
                             for (std::uint64_t c = 1; c <= hexes; ++c)
                               out.add(static_cast<std::int64_t>(4 * tets + 8 * c));
                           });
  writeArray<std::uint8_t>(stream, "type=\"UInt8\" Name=\"types\"", tets + hexes,
                           [&](Base64Writer& out) {
                             for (std::uint64_t c = 0; c < tets + hexes; ++c)
                               out.add<std::uint8_t>(c < tets ? 10 : 12);
                           });
  stream << "      </Cells>\n";
}

}  // namespace

LostFields writeVtu(std::ostream& stream, const CellMesh& mesh) {
  stream << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n";
  stream << fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                        mesh.vertices.size(), mesh.tetrahedra.size() + mesh.hexahedra.size());
  writeFields(stream, "PointData", mesh.vertexFields);
  writeFields(stream, "CellData", mesh.cellFields);
  stream << "      <Points>\n";
  writeArray<double>(stream, "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"",
                     3 * mesh.vertices.size(), [&](Base64Writer& out) {
                       for (const Vec3& p : mesh.vertices)
                         for (int a = 0; a < 3; ++a) out.add(p[a]);
                     });
  stream << "      </Points>\n";
  writeCells(stream, mesh);
  stream << "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
  return {};
}

}  // namespace innermap
