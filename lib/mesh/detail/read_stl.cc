// STL, text and binary. It has no connectivity: corners are welded where they are equal.
#include <fmt/format.h>

#include <cstring>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

constexpr std::size_t kHeader = 84, kRecord = 50;

// Numbers positions in order of first appearance. Open addressing on the bits.
class Welder {
 public:
  Welder(const std::string& path, Points& vertices) : path_(path), vertices_(vertices) {
    slots_.assign(1024, -1);
  }

  int number(Vec3 p) {
    for (int a = 0; a < 3; ++a) p[a] += 0.0;  // -0 becomes 0
    if (2 * vertices_.size() >= slots_.size()) grow();
    std::size_t slot = hash(p) & (slots_.size() - 1);
    for (; slots_[slot] >= 0; slot = (slot + 1) & (slots_.size() - 1)) {
      const Vec3& q = vertices_[slots_[slot]];
      if (p.x == q.x && p.y == q.y && p.z == q.z) return slots_[slot];
    }
    requireCountable(path_, vertices_.size());
    slots_[slot] = static_cast<int>(vertices_.size());
    vertices_.push_back(p);
    return slots_[slot];
  }

 private:
  static std::uint64_t hash(const Vec3& p) {
    std::uint64_t h = 0;
    for (int a = 0; a < 3; ++a) {
      std::uint64_t bits;
      std::memcpy(&bits, a == 0 ? &p.x : a == 1 ? &p.y : &p.z, sizeof bits);
      h = (h ^ bits) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
    return h;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), -1);
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      std::size_t slot = hash(vertices_[v]) & (slots_.size() - 1);
      while (slots_[slot] >= 0) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<int>(v);
    }
  }

  const std::string& path_;
  Points& vertices_;
  std::vector<int> slots_;
};

std::uint32_t littleEndian(const char* bytes) {
  std::uint32_t value = 0;
  for (int k = 0; k < 4; ++k)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k])) << (8 * k);
  return value;
}

float floatAt(const char* bytes) {
  const std::uint32_t bits = littleEndian(bytes);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void endTriangle(const std::string& path, PolygonMesh& mesh) {
  requireCountable(path, mesh.corners.size());
  mesh.start.push_back(static_cast<int>(mesh.corners.size()));
}

PolygonMesh readBinary(const FileBytes& file) {
  PolygonMesh mesh;
  Welder welder(file.path, mesh.vertices);
  const std::size_t count = (file.bytes.size() - kHeader) / kRecord;
  mesh.corners.reserve(3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    if (t % 65536 == 0) throwIfCancelled();
    const char* record = file.bytes.data() + kHeader + t * kRecord;
    for (int c = 0; c < 3; ++c) {
      const char* at = record + 12 * (c + 1);
      const Vec3 p{floatAt(at), floatAt(at + 4), floatAt(at + 8)};
      if (!isFinite(p))
        throw FileError(file.path, fmt::format("triangle {} has a corner that is not finite; "
                                               "export the mesh again",
                                               t));
      mesh.corners.push_back(welder.number(p));
    }
    endTriangle(file.path, mesh);
  }
  return mesh;
}

PolygonMesh readText(const FileBytes& file) {
  PolygonMesh mesh;
  Welder welder(file.path, mesh.vertices);
  TextScanner scanner(file, {});
  std::string_view keyword;
  int corners = 0;
  bool ended = false;
  while (scanner.nextFilledLine(keyword)) {
    if (scanner.line() % 65536 == 0) throwIfCancelled();
    if (equalsIgnoringCase(keyword, "vertex")) {
      const double x = scanner.nextNumber("x"), y = scanner.nextNumber("y");
      mesh.corners.push_back(welder.number({x, y, scanner.nextNumber("z")}));
      ++corners;
    } else if (equalsIgnoringCase(keyword, "endfacet")) {
      if (corners != 3) scanner.fail(fmt::format("a facet has three corners, here {}", corners));
      endTriangle(file.path, mesh);
      corners = 0;
    } else if (equalsIgnoringCase(keyword, "solid") || equalsIgnoringCase(keyword, "endsolid")) {
      ended = keyword.size() > 5;
    } else if (!equalsIgnoringCase(keyword, "facet") && !equalsIgnoringCase(keyword, "outer") &&
               !equalsIgnoringCase(keyword, "endloop") && !equalsIgnoringCase(keyword, "color")) {
      scanner.fail(inQuotes(keyword) + " is no keyword of STL; give an STL file");
    }
  }
  if (!ended || corners != 0)
    scanner.fail("the file ends without endsolid, it is cut short; export it again");
  return mesh;
}

}  // namespace

PolygonMesh readStl(const FileBytes& file) {
  const std::size_t size = file.bytes.size();
  const std::uint64_t promised = size >= kHeader ? littleEndian(file.bytes.data() + 80) : 0;
  // Many binary files begin with "solid" too, so the size decides.
  if (size >= kHeader && size == kHeader + promised * kRecord) return readBinary(file);
  const std::size_t first = file.bytes.find_first_not_of(" \t\r\n");
  if (first != file.bytes.npos && equalsIgnoringCase(file.bytes.substr(first, 5), "solid"))
    return readText(file);
  if (size < kHeader)
    throw FileError(file.path, "is neither text nor binary STL; give an STL file");
  throw FileError(
      file.path, fmt::format("a binary STL file of {} triangles, as its header says, has {} bytes, "
                             "this one {}; it is cut short or not STL; export it again",
                             promised, kHeader + promised * kRecord, size));
}

}  // namespace innermap
