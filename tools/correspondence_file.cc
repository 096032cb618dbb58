#include "correspondence_file.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <ostream>

#include "innermap/core/error.h"
#include "innermap/core/file.h"

namespace innermap::tool {
namespace {

class Bytes {
 public:
  explicit Bytes(std::ostream& stream) : stream_(stream) {}
  ~Bytes() { flush(); }

  void integer(std::int32_t value) { add(static_cast<std::uint32_t>(value), 4); }
  void byte(unsigned value) { add(value, 1); }
  void number(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits, 8);
  }

 private:
  void add(std::uint64_t bits, int count) {
    for (int k = 0; k < count; ++k) bytes_.push_back(static_cast<char>(bits >> (8 * k)));
    if (bytes_.size() > (1u << 20)) flush();
  }
  void flush() {
    stream_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

  std::ostream& stream_;
  std::string bytes_;
};

}  // namespace

void writeCorrespondence(const std::string& path, const Mesh& moved,
                         const std::vector<SurfacePoint>& onTarget) {
  writeWholeFile(path, [&](std::ostream& stream) {
    stream << fmt::format(
        "ply\nformat binary_little_endian 1.0\n"
        "comment triangle, b0, b1, b2: place of the vertex on the other mesh\n"
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "property int triangle\nproperty double b0\nproperty double b1\nproperty double b2\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        moved.vertices.size(), moved.triangles.size());
    Bytes out(stream);
    for (std::size_t v = 0; v < moved.vertices.size(); ++v) {
      for (int axis = 0; axis < 3; ++axis) out.number(moved.vertices[v][axis]);
      out.integer(onTarget[v].triangle);
      for (const double b : onTarget[v].barycentric) out.number(b);
    }
    for (const Triangle& t : moved.triangles) {
      out.byte(3);
      for (const int v : t) out.integer(v);
    }
  });
}

}  // namespace innermap::tool
