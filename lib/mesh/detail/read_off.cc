// OFF, with normals (N), colours (C) and texture coordinates (ST) at the vertices.
#include <fmt/format.h>

#include "mesh/detail/polygon_mesh.h"
#include "mesh/off_scanner.h"

namespace innermap {
namespace {

class OffReader {
 public:
  explicit OffReader(const FileBytes& file) : file_(file), off_(file) {}

  PolygonMesh read() {
    for (std::int64_t i = 0; i < off_.vertices; ++i) readVertex();
    for (std::int64_t i = 0; i < off_.faces; ++i) readFace();
    // Whole numbers count to 255, others to 1.
    const double scale = wholeColours_ ? 1 / 255.0 : 1.0;
    for (const Vec3& c : rawColours_)
      mesh_.colours.push_back(clampedColour(scale * c.x, scale * c.y, scale * c.z));
    if (off_.uvs) mesh_.uvCorners = mesh_.corners;
    return std::move(mesh_);
  }

 private:
  void readVertex() {
    TextScanner& scanner = off_.text();
    mesh_.vertices.push_back(off_.nextVertex());
    std::string_view text;
    for (int k = 0; off_.normals && k < 3; ++k)  // a normal may well be NaN
      if (!scanner.token(text)) scanner.fail("the line ends before its normal");
    if (!off_.colours && !off_.uvs) return;
    double rest[6];
    std::size_t have = 0;
    for (; have < 6 && scanner.token(text); ++have) {
      rest[have] = scanner.number(text);
      if (have < 3 && text.find_first_of(".eE") != text.npos) wholeColours_ = false;
    }
    if (off_.uvs) {
      if (have < 2) scanner.fail("the line ends before its texture coordinates");
      have -= 2;
      mesh_.uvs.push_back({rest[have], rest[have + 1]});
    }
    if (off_.colours) {
      if (have < 3) scanner.fail("the line ends before its colour");
      rawColours_.push_back({rest[0], rest[1], rest[2]});
    }
  }

  void readFace() {
    const std::vector<int>& corners = off_.nextFace();
    if (corners.size() < 3)
      off_.text().fail(
          fmt::format("a face needs three corners, here are {}; remove it", corners.size()));
    requireCountable(file_.path, mesh_.corners.size() + corners.size());
    mesh_.corners.insert(mesh_.corners.end(), corners.begin(), corners.end());
    mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
  }

  const FileBytes& file_;
  OffScanner off_;
  PolygonMesh mesh_;
  Points rawColours_;
  bool wholeColours_ = true;
};

}  // namespace

PolygonMesh readOff(const FileBytes& file) { return OffReader(file).read(); }

}  // namespace innermap
