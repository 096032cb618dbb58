#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <ostream>

#include "core/file.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {
namespace {

// Collects output in pieces that are cheap to hand to a stream.
class Buffer {
 public:
  explicit Buffer(std::ostream& stream) : stream_(stream) {}
  ~Buffer() { flush(); }

  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    flushWhenLarge();
  }

  void littleEndian(std::uint64_t bits, int bytes) {
    for (int k = 0; k < bytes; ++k) text_.push_back(static_cast<char>(bits >> (8 * k)));
    flushWhenLarge();
  }

  void littleEndian(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    littleEndian(bits, 8);
  }

 private:
  void flushWhenLarge() {
    if (text_.size() > (1u << 20)) flush();
  }
  void flush() {
    stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
  }

  std::ostream& stream_;
  fmt::memory_buffer text_;
};

void writeProperty(Buffer& out, const VertexProperty& property, std::size_t v) {
  if (const auto* integers = std::get_if<std::vector<std::int32_t>>(&property.values))
    out.littleEndian(static_cast<std::uint32_t>((*integers)[v]), 4);
  else
    out.littleEndian(std::get<std::vector<double>>(property.values)[v]);
}

void writePlyTo(std::ostream& stream, const Mesh& mesh, const PlyExtras& extras) {
  Buffer out(stream);
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
    for (int a = 0; a < 3; ++a) out.littleEndian(mesh.vertices[v][a]);
    for (int c = 0; colours && c < 3; ++c) {
      const double value = std::clamp(static_cast<double>(mesh.colours[v][c]), 0.0, 1.0);
      out.littleEndian(static_cast<std::uint64_t>(std::lround(255 * value)), 1);
    }
    for (const VertexProperty& p : extras.properties) writeProperty(out, p, v);
  }
  for (const Triangle& t : mesh.triangles) {
    out.littleEndian(3, 1);
    for (const int v : t) out.littleEndian(static_cast<std::uint32_t>(v), 4);
  }
}

void writeObj(std::ostream& stream, const Mesh& mesh) {
  Buffer out(stream);
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
