// STL has no connectivity: corners are welded where they are equal.
#include <cstring>

#include "mesh/detail/polygon_mesh.h"
#include "mesh/stl_scanner.h"

namespace innermap {
namespace {

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

}  // namespace

PolygonMesh readStl(const FileBytes& file) {
  PolygonMesh mesh;
  Welder welder(file.path, mesh.vertices);
  StlScanner stl(file, false);
  mesh.corners.reserve(3 * stl.triangles());
  while (stl.next()) {
    for (int c = 1; c < 4; ++c) mesh.corners.push_back(welder.number(stl.rows[c]));
    requireCountable(file.path, mesh.corners.size());
    mesh.start.push_back(static_cast<int>(mesh.corners.size()));
  }
  return mesh;
}

}  // namespace innermap
