#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/file_bytes.h"
#include "core/ply_body.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/geometry_file.h"
#include "mesh/obj_scanner.h"

namespace innermap {
namespace {

constexpr std::size_t kMostColumns = 1024;

// The triangles of one polygon after the other.
class PolygonTriangles {
 public:
  explicit PolygonTriangles(const Mesh& mesh) : mesh_(mesh) {}

  std::size_t polygons() const {
    return mesh_.polygonStart.empty() ? mesh_.triangles.size() : mesh_.polygonStart.size() - 1;
  }
  // How many the polygon has; they follow those of the polygon before it.
  int count(std::size_t polygon) const {
    return mesh_.polygonStart.empty()
               ? 1
               : mesh_.polygonStart[polygon + 1] - mesh_.polygonStart[polygon] - 2;
  }

 private:
  const Mesh& mesh_;
};

class Groups {
 public:
  void begin(const std::string& kind) { current_[kind].clear(); }
  void name(const std::string& kind, const std::string& name) {
    const auto [at, fresh] = numbers_.emplace(name, groups_.size());
    if (fresh) groups_.push_back({name, {}});
    current_[kind].push_back(at->second);
  }
  void add(int triangle) {
    for (const auto& [kind, numbers] : current_)
      for (const std::size_t number : numbers) {
        std::vector<int>& triangles = groups_[number].triangles;
        if (triangles.empty() || triangles.back() != triangle) triangles.push_back(triangle);
      }
  }
  std::vector<SurfaceGroup> take() { return std::move(groups_); }

 private:
  std::vector<SurfaceGroup> groups_;
  std::map<std::string, std::size_t> numbers_;
  std::map<std::string, std::vector<std::size_t>> current_;  // by keyword
};

std::size_t propertyNamed(const PlyElement& element, const std::string& name,
                          const std::string& path) {
  std::vector<std::string> known;
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    if (element.properties[p].list) continue;
    if (element.properties[p].name == name) return p;
    known.push_back(inQuotes(element.properties[p].name));
  }
  throw FileError(path, fmt::format("its vertices have no property {}; they have {}",
                                    inQuotes(name), fmt::join(known, ", ")));
}

Matrix valuesOf(PlyBody& body, const PlyElement& element, const std::vector<std::size_t>& wanted) {
  Matrix out(element.count, wanted.size());
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (row % 65536 == 0) throwIfCancelled();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (std::find(wanted.begin(), wanted.end(), p) == wanted.end()) {
        body.skip(property);
        continue;
      }
      const double value = body.nextValue(property.type);
      for (std::size_t k = 0; k < wanted.size(); ++k)
        if (wanted[k] == p) out(row, k) = value;
    }
  }
  return out;
}

std::vector<std::string_view> tokensOf(TextScanner& scanner) {
  std::vector<std::string_view> out;
  for (std::string_view token; scanner.token(token);) {
    if (out.size() == kMostColumns) scanner.fail("has more than 1024 columns");
    out.push_back(token);
  }
  return out;
}

}  // namespace

std::vector<SurfaceGroup> readGroups(const std::string& path, const Mesh& mesh) {
  if (!equalsIgnoringCase(extensionOf(path), ".obj"))
    throw FileError(path, "holds no groups; those of .obj files are read (g, o, usemtl)");
  const FileBytes file = readFileBytes(path, "a mesh file");
  ObjScanner obj(file, false);
  const PolygonTriangles polygons(mesh);
  Groups groups;
  std::size_t polygon = 0;
  int triangle = 0;
  for (std::size_t lines = 0; obj.next(); ++lines) {
    if (lines % 65536 == 0) throwIfCancelled();
    const std::string kind(obj.keyword());
    if (kind == "g" || kind == "o" || kind == "usemtl") {
      groups.begin(kind);
      for (std::string_view name; obj.text().token(name);) groups.name(kind, std::string(name));
    } else if (obj.kind() == ObjLine::face) {
      if (polygon < polygons.polygons())
        for (int left = polygons.count(polygon); left > 0; --left) groups.add(triangle++);
      ++polygon;
    }
  }
  if (polygon != polygons.polygons() || static_cast<std::size_t>(triangle) != mesh.triangles.size())
    throw FileError(path, "has other faces than the mesh that was read from it");
  return groups.take();
}

Matrix readVertexProperties(const std::string& path, const std::vector<std::string>& names,
                            const Mesh& mesh) {
  if (!equalsIgnoringCase(extensionOf(path), ".ply"))
    throw FileError(path, "holds no properties of vertices; those of .ply files are read");
  const FileBytes file = readFileBytes(path, "a mesh file");
  const PlyHeader header = readPlyHeader(file);
  PlyBody body(file, header);
  for (const PlyElement& element : header.elements) {
    const std::uint64_t rows = body.rows(element);
    if (element.name == "vertex") {
      if (element.count != mesh.vertices.size())
        throw FileError(path, "has other vertices than the mesh that was read from it");
      std::vector<std::size_t> wanted;
      for (const std::string& name : names) wanted.push_back(propertyNamed(element, name, path));
      return valuesOf(body, element, wanted);
    }
    for (std::uint64_t row = 0; row < rows; ++row) {
      if (row % 65536 == 0) throwIfCancelled();
      body.skipRow(element);
    }
  }
  throw FileError(path, "has no vertices");
}

VertexTable readVertexTable(const std::string& path, const Mesh& mesh) {
  FileBytes file = readFileBytes(path, "a table of vertices");
  std::replace_if(
      file.bytes.begin(), file.bytes.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  TextScanner scanner(file, {true, false});
  VertexTable out;
  std::vector<bool> given(mesh.vertices.size(), false);
  for (std::size_t lines = 0; scanner.nextLine(); ++lines) {
    if (lines % 65536 == 0) throwIfCancelled();
    const std::vector<std::string_view> tokens = tokensOf(scanner);
    if (tokens.empty()) continue;
    if (tokens.size() < 2) scanner.fail("a line needs a vertex and at least one value");
    const bool first = out.values.columns() == 0;
    if (first && out.names.empty() && !parseNumber(tokens[0])) {
      out.names.assign(tokens.begin() + 1, tokens.end());
      continue;
    }
    if (first) {
      out.values = Matrix(mesh.vertices.size(), tokens.size() - 1);
      std::fill_n(out.values.data(), out.values.rows() * out.values.columns(),
                  std::numeric_limits<double>::quiet_NaN());
    }
    if (tokens.size() != out.values.columns() + 1 ||
        (!out.names.empty() && out.names.size() + 1 != tokens.size()))
      scanner.fail(
          fmt::format("has {} columns, other lines have {}", tokens.size(),
                      out.names.empty() ? out.values.columns() + 1 : out.names.size() + 1));
    const std::int64_t vertex = scanner.integer(tokens[0]);
    if (vertex < 0 || static_cast<std::size_t>(vertex) >= mesh.vertices.size())
      scanner.fail(
          fmt::format("vertex {} of a mesh of {} (counted from 0)", vertex, mesh.vertices.size()));
    const auto row = static_cast<std::size_t>(vertex);
    if (given[row]) scanner.fail(fmt::format("vertex {} is given a second time", vertex));
    given[row] = true;
    for (std::size_t k = 0; k < out.values.columns(); ++k)
      out.values(row, k) = scanner.number(tokens[k + 1]);
  }
  if (out.values.columns() == 0) throw FileError(path, "has no line with a vertex and its values");
  return out;
}

}  // namespace innermap
