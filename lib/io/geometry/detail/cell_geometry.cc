// Tetrahedra and hexahedra with their fields.
#include <algorithm>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "io/cells/detail/cell_formats.h"
#include "io/geometry/detail/geometry_formats.h"
#include "lattice/cell_signs.h"

namespace innermap {
namespace {

Vec3 rowOf(const CellField& field, std::size_t row) {
  return {field.values[3 * row], field.values[3 * row + 1], field.values[3 * row + 2]};
}

class CellGeometry : public GeometryFile {
 public:
  CellGeometry(CellFile file, const ReadGeometrySettings& settings) : mesh_(std::move(file.mesh)) {
    notes = std::move(file.notes);
    geometry.splittable = false;
    geometry.points = mesh_.vertices;
    geometry.ownPoints = mesh_.vertices.size();
    declare(settings.vectors, CellField::Kind::vector);
    declare(settings.normals, CellField::Kind::normal);
    addCells(mesh_.tetrahedra);
    addCells(mesh_.hexahedra);
    for (std::size_t f = 0; f < mesh_.vertexFields.size(); ++f)
      addDirections(mesh_.vertexFields[f], 0, mesh_.vertices.size());
    addCellDirections();
  }

  InvertedCells inverted(const CarriedGeometry& carried) const override {
    InvertedCells out;
    std::size_t e = 0;
    const auto count = [&](const auto& cells) {
      for (const auto& cell : cells) {
        if (!carried.stays[e++]) continue;
        ++out.cells;
        out.before += isInverted(mesh_.vertices, cell);
        out.after += isInverted(carried.points.points, cell);
      }
    };
    count(mesh_.tetrahedra);
    count(mesh_.hexahedra);
    return out;
  }

  std::vector<std::string> write(const std::string& path, const CarriedGeometry& carried,
                                 std::ostream& stream) const override;

 private:
  void declare(const std::vector<std::string>& names, CellField::Kind kind) {
    for (const std::string& name : names) {
      bool found = false;
      for (auto* fields : {&mesh_.vertexFields, &mesh_.cellFields})
        for (CellField& field : *fields)
          if (field.name == name) {
            if (field.components != 3)
              throw FileError(mesh_.name, fmt::format("field {} has {} components, a direction "
                                                      "three",
                                                      inQuotes(name), field.components));
            field.kind = kind;
            field.whole = false;
            found = true;
          }
      if (!found) throw FileError(mesh_.name, "has no field " + inQuotes(name));
    }
  }

  template <class Cells>
  void addCells(const Cells& cells) {
    std::vector<Corner> corners;
    for (const auto& cell : cells) {
      corners.assign(cell.size(), {});
      for (std::size_t k = 0; k < cell.size(); ++k) corners[k].point = cell[k];
      geometry.elements.add(Elements::Kind::cell,
                            static_cast<std::uint32_t>(geometry.elements.size()), corners.data(),
                            corners.size());
    }
  }

  void addDirections(const CellField& field, std::size_t firstPoint, std::size_t rows) {
    if (field.kind == CellField::Kind::scalar) return;
    Directions directions;
    directions.name = field.name;
    directions.kind =
        field.kind == CellField::Kind::normal ? DirectionKind::normal : DirectionKind::vector;
    for (std::size_t row = 0; row < rows; ++row) {
      directions.values.push_back(rowOf(field, row));
      directions.points.push_back(static_cast<int>(firstPoint + row));
    }
    geometry.directions.push_back(std::move(directions));
  }

  // Directions of cells are carried at their centres.
  void addCellDirections() {
    const auto moves = [](const CellField& field) { return field.kind != CellField::Kind::scalar; };
    if (std::none_of(mesh_.cellFields.begin(), mesh_.cellFields.end(), moves)) return;
    const std::size_t first = geometry.points.size(), cells = geometry.elements.size();
    if (first + cells > 2147483646)
      throw FileError(mesh_.name, "has over 2147483646 vertices and cells; cut it into parts");
    for (std::size_t e = 0; e < cells; ++e) {
      Vec3 sum;
      const std::size_t begin = geometry.elements.start[e], end = geometry.elements.start[e + 1];
      for (std::size_t k = begin; k < end; ++k)
        sum += mesh_.vertices[static_cast<std::size_t>(geometry.elements.corners[k].point)];
      geometry.points.push_back(sum / static_cast<double>(end - begin));
    }
    for (const CellField& field : mesh_.cellFields) addDirections(field, first, cells);
  }

  CellMesh mesh_;
};

// Rows of those that stay, with the directions that were carried in place of the old ones.
void keepFields(const std::vector<CellField>& from, const std::vector<std::uint8_t>& stays,
                const CarriedGeometry& carried, std::size_t& direction,
                std::vector<CellField>& to) {
  for (const CellField& field : from) {
    const Points* moved =
        field.kind == CellField::Kind::scalar ? nullptr : &carried.directions[direction++];
    CellField kept{field.name, field.components, field.kind, {}, field.whole};
    const auto width = static_cast<std::size_t>(field.components);
    for (std::size_t row = 0; row < stays.size(); ++row) {
      if (!stays[row]) continue;
      for (std::size_t k = 0; k < width; ++k)
        kept.values.push_back(moved ? (*moved)[row][static_cast<int>(k)]
                                    : field.values[row * width + k]);
    }
    to.push_back(std::move(kept));
  }
}

std::vector<std::string> CellGeometry::write(const std::string& path,
                                             const CarriedGeometry& carried,
                                             std::ostream& stream) const {
  CellMesh out;
  out.name = path;
  std::vector<std::uint8_t> pointStays(carried.number.size());
  for (std::size_t i = 0; i < carried.number.size(); ++i) {
    pointStays[i] = carried.number[i] >= 0;
    if (pointStays[i]) out.vertices.push_back(carried.points.points[i]);
  }
  std::size_t e = 0;
  const auto keep = [&](const auto& cells, auto& kept) {
    for (auto cell : cells) {
      if (!carried.stays[e++]) continue;
      for (int& v : cell) v = carried.number[static_cast<std::size_t>(v)];
      kept.push_back(cell);
    }
  };
  keep(mesh_.tetrahedra, out.tetrahedra);
  keep(mesh_.hexahedra, out.hexahedra);
  std::size_t direction = 0;
  keepFields(mesh_.vertexFields, pointStays, carried, direction, out.vertexFields);
  keepFields(mesh_.cellFields, carried.stays, carried, direction, out.cellFields);
  return writeCellsTo(path, out, stream);
}

}  // namespace

std::unique_ptr<GeometryFile> readCellGeometry(const std::string& path,
                                               const ReadGeometrySettings& settings) {
  return std::make_unique<CellGeometry>(readCells(path), settings);
}

}  // namespace innermap
