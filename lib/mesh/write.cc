#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>

#include "core/file.h"
#include "core/output_buffer.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {
namespace {

void writeProperty(OutputBuffer& out, const VertexProperty& property, std::size_t v) {
  if (const auto* integers = std::get_if<std::vector<std::int32_t>>(&property.values))
    out.number((*integers)[v]);
  else
    out.number(std::get<std::vector<double>>(property.values)[v]);
}

void writePlyTo(std::ostream& stream, const Mesh& mesh, const PlyExtras& extras) {
  OutputBuffer out(stream);
  const bool colours = !mesh.colours.empty();
  out.print("ply\nformat binary_little_endian 1.0\n");
  if (!extras.comment.empty()) out.print("comment {}\n", extras.comment);
  out.print("element vertex {}\n", mesh.vertices.size());
  out.print("property double x\nproperty double y\nproperty double z\n");
  if (colours) out.print("property uchar red\nproperty uchar green\nproperty uchar blue\n");
  for (const VertexProperty& p : extras.properties)
    out.print("property {} {}\n", p.values.index() == 0 ? "int" : "double", p.name);
  out.print("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int a = 0; a < 3; ++a) out.number(mesh.vertices[v][a]);
    for (int c = 0; colours && c < 3; ++c) {
      const double value = std::clamp(static_cast<double>(mesh.colours[v][c]), 0.0, 1.0);
      out.number(static_cast<std::uint8_t>(std::lround(255 * value)));
    }
    for (const VertexProperty& p : extras.properties) writeProperty(out, p, v);
  }
  for (const Triangle& t : mesh.triangles) {
    out.number(std::uint8_t{3});
    for (const std::int32_t v : t) out.number(v);
  }
}

void writeObj(std::ostream& stream, const Mesh& mesh) {
  OutputBuffer out(stream);
  // Shortest digits that read back to the same number.
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& p = mesh.vertices[v];
    out.print("v {} {} {}", p.x, p.y, p.z);
    if (!mesh.colours.empty()) {
      const std::array<float, 3>& c = mesh.colours[v];
      out.print(" {} {} {}", c[0], c[1], c[2]);
    }
    out.print("\n");
  }
  for (const Vec2& uv : mesh.uvs) out.print("vt {} {}\n", uv.x, uv.y);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    out.print("f");
    for (int c = 0; c < 3; ++c) {
      out.print(" {}", mesh.triangles[t][c] + 1);
      if (!mesh.uvTriangles.empty() && mesh.uvTriangles[t][c] >= 0)
        out.print("/{}", mesh.uvTriangles[t][c] + 1);
    }
    out.print("\n");
  }
}

}  // namespace

void writeMesh(const std::string& path, const Mesh& mesh) {
  const std::string extension = path.size() < 4 ? "" : path.substr(path.size() - 4);
  const bool ply = equalsIgnoringCase(extension, ".ply");
  if (!ply && !equalsIgnoringCase(extension, ".obj"))
    throw FileError(path, "meshes are written as .ply or .obj; give one of these extensions");
  writeWholeFile(path, [&](std::ostream& stream) {
    ply ? writePlyTo(stream, mesh, {}) : writeObj(stream, mesh);
  });
}

void writePly(const std::string& path, const Mesh& mesh, const PlyExtras& extras) {
  for (const VertexProperty& p : extras.properties) {
    const std::size_t count =
        std::visit([](const auto& values) { return values.size(); }, p.values);
    if (count != mesh.vertices.size())
      throw DataError(fmt::format("{}: property '{}' has {} values for {} vertices", path, p.name,
                                  count, mesh.vertices.size()));
  }
  writeWholeFile(path, [&](std::ostream& stream) { writePlyTo(stream, mesh, extras); });
}

}  // namespace innermap
