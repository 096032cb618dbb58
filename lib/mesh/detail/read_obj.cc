// OBJ. Numbers are read exactly (correctly rounded doubles) and every index is checked with its
// line; tinyobjloader does neither: the packaged library holds floats, turns malformed numbers into
// zeros and lets negative indices run below the first vertex.
#include <fmt/format.h>

#include <array>

#include "innermap/core/run.h"
#include "mesh/detail/polygon_mesh.h"
#include "mesh/obj_scanner.h"

namespace innermap {
namespace {

class ObjReader {
 public:
  explicit ObjReader(const FileBytes& file) : path_(file.path), obj_(file, false) {}

  PolygonMesh read() {
    for (std::size_t lines = 0; obj_.next(); ++lines) {
      if (lines % 65536 == 0) reportProgress("reading", obj_.fraction());
      if (obj_.kind() == ObjLine::vertex)
        vertex();
      else if (obj_.kind() == ObjLine::texture)
        textureCoordinate();
      else if (obj_.kind() == ObjLine::face)
        face();
    }
    obj_.requireInRange();
    if (!anyUv_) {
      mesh_.uvCorners.clear();
      mesh_.uvs.clear();
    }
    if (!mesh_.colours.empty()) mesh_.colours.resize(mesh_.vertices.size(), {1, 1, 1});
    return std::move(mesh_);
  }

 private:
  void vertex() {
    const TextScanner& scanner = obj_.text();
    std::array<double, 6> values{};
    std::size_t count = 0;
    std::string_view text;
    for (; obj_.text().token(text); ++count)
      if (const double value = scanner.number(text); count < values.size()) values[count] = value;
    if (count < 3)
      scanner.fail(fmt::format("a vertex needs three coordinates, here are {}", count));
    requireCountable(path_, mesh_.vertices.size());
    // Six numbers or more: a colour follows the position. A fourth alone is a weight.
    if (count >= 6) {
      mesh_.colours.resize(mesh_.vertices.size(), {1, 1, 1});
      mesh_.colours.push_back(clampedColour(values[3], values[4], values[5]));
    }
    mesh_.vertices.push_back({values[0], values[1], values[2]});
  }

  void textureCoordinate() {
    const double u = obj_.text().nextNumber("texture coordinate");
    std::string_view text;
    const double v = obj_.text().token(text) ? obj_.text().number(text) : 0;
    requireCountable(path_, mesh_.uvs.size());
    mesh_.uvs.push_back({u, v});
  }

  void face() {
    for (const ObjCorner& corner : obj_.corners()) {
      mesh_.corners.push_back(corner.vertex);
      mesh_.uvCorners.push_back(corner.texture);
      anyUv_ = anyUv_ || corner.texture >= 0;
    }
    requireCountable(path_, mesh_.corners.size());
    mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
  }

  const std::string& path_;
  ObjScanner obj_;
  PolygonMesh mesh_;
  bool anyUv_ = false;
};

}  // namespace

PolygonMesh readObj(const FileBytes& file) { return ObjReader(file).read(); }

}  // namespace innermap
