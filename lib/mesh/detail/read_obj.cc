// OBJ. Numbers are read exactly (correctly rounded doubles) and every index is checked with its
// line; tinyobjloader does neither: the packaged library holds floats, turns malformed numbers into
// zeros and lets negative indices run below the first vertex.
#include <fmt/format.h>

#include <array>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

// Positive indices may point forward; whether they were in range is known at the end.
struct Highest {
  std::int64_t index = 0;
  std::size_t line = 0;
};

class ObjReader {
 public:
  explicit ObjReader(const FileBytes& file) : file_(file), scanner_(file, {true, true}) {}

  PolygonMesh read() {
    std::string_view keyword;
    for (std::size_t lines = 0; scanner_.nextLine(); ++lines) {
      if (lines % 65536 == 0) reportProgress("reading", fraction());
      if (!scanner_.token(keyword)) continue;
      if (keyword == "v")
        vertex();
      else if (keyword == "vt")
        textureCoordinate();
      else if (keyword == "f" || keyword == "fo")  // fo: faces in files before OBJ 3.0
        face();
    }
    requireInRange(highestVertex_, mesh_.vertices.size(), "vertex");
    requireInRange(highestUv_, mesh_.uvs.size(), "texture coordinate");
    if (!anyUv_) {
      mesh_.uvCorners.clear();
      mesh_.uvs.clear();
    }
    if (!mesh_.colours.empty()) mesh_.colours.resize(mesh_.vertices.size(), {1, 1, 1});
    return std::move(mesh_);
  }

 private:
  double fraction() const {
    return 1 -
           static_cast<double>(scanner_.remainingBytes()) / static_cast<double>(file_.bytes.size());
  }

  void vertex() {
    std::array<double, 6> values{};
    std::size_t count = 0;
    std::string_view text;
    for (; scanner_.token(text); ++count)
      if (const double value = scanner_.number(text); count < values.size()) values[count] = value;
    if (count < 3)
      scanner_.fail(fmt::format("a vertex needs three coordinates, here are {}", count));
    requireCountable(file_.path, mesh_.vertices.size());
    // Six numbers or more: a colour follows the position. A fourth alone is a weight.
    if (count >= 6) {
      mesh_.colours.resize(mesh_.vertices.size(), {1, 1, 1});
      mesh_.colours.push_back(clampedColour(values[3], values[4], values[5]));
    }
    mesh_.vertices.push_back({values[0], values[1], values[2]});
  }

  void textureCoordinate() {
    const double u = scanner_.nextNumber("texture coordinate");
    std::string_view text;
    const double v = scanner_.token(text) ? scanner_.number(text) : 0;
    requireCountable(file_.path, mesh_.uvs.size());
    mesh_.uvs.push_back({u, v});
  }

  void face() {
    std::string_view text;
    const std::size_t before = mesh_.corners.size();
    while (scanner_.token(text)) corner(text);
    const std::size_t count = mesh_.corners.size() - before;
    if (count < 3) scanner_.fail(fmt::format("a face needs three corners, here are {}", count));
    requireCountable(file_.path, mesh_.corners.size());
    mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
  }

  // v, v/vt, v//vn or v/vt/vn
  void corner(std::string_view text) {
    const std::size_t slash = text.find('/');
    mesh_.corners.push_back(
        index(text.substr(0, slash), mesh_.vertices.size(), "vertex", highestVertex_));
    int uv = -1;
    if (slash != text.npos) {
      const std::string_view rest = text.substr(slash + 1);
      const std::size_t second = rest.find('/');
      if (const std::string_view uvText = rest.substr(0, second); !uvText.empty())
        uv = index(uvText, mesh_.uvs.size(), "texture coordinate", highestUv_);
      if (second != rest.npos && second + 1 < rest.size())
        scanner_.integer(rest.substr(second + 1));
    }
    anyUv_ = anyUv_ || uv >= 0;
    mesh_.uvCorners.push_back(uv);
  }

  int index(std::string_view text, std::size_t count, const char* what, Highest& highest) {
    const std::int64_t value = scanner_.integer(text);
    const std::int64_t size = static_cast<std::int64_t>(count);
    if (value == 0) scanner_.fail(fmt::format("{} index 0; OBJ counts from 1", what));
    if (value < -size || value > std::numeric_limits<int>::max()) outOfRange(value, count, what);
    if (value > size && value > highest.index) highest = {value, scanner_.line()};
    return static_cast<int>(value > 0 ? value - 1 : size + value);
  }

  void outOfRange(std::int64_t value, std::size_t count, const char* what) {
    scanner_.fail(
        fmt::format("{} index {} is out of range, the file has {} there", what, value, count));
  }

  void requireInRange(const Highest& highest, std::size_t count, const char* what) const {
    if (highest.index > static_cast<std::int64_t>(count))
      throw FileError(file_.path,
                      fmt::format("line {}: {} index {} is out of range, the file has {}",
                                  highest.line, what, highest.index, count));
  }

  const FileBytes& file_;
  TextScanner scanner_;
  PolygonMesh mesh_;
  Highest highestVertex_, highestUv_;
  bool anyUv_ = false;
};

}  // namespace

PolygonMesh readObj(const FileBytes& file) { return ObjReader(file).read(); }

}  // namespace innermap
