// OFF, with normals (N), colours (C) and texture coordinates (ST) at the vertices.
#include <fmt/format.h>

#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

class OffReader {
 public:
  explicit OffReader(const FileBytes& file) : file_(file), scanner_(file, {true, false}) {}

  PolygonMesh read() {
    readHeader();
    for (std::int64_t i = 0; i < vertexCount_; ++i) readVertex(i);
    for (std::int64_t i = 0; i < faceCount_; ++i) readFace(i);
    scaleColours();
    return std::move(mesh_);
  }

 private:
  // The keyword, whose counts may follow in the same line, even without a space.
  void readHeader() {
    std::string_view text;
    if (!scanner_.nextFilledLine(text)) scanner_.fail("the file has no content; give an OFF file");
    const std::size_t off = text.substr(0, 8).find("OFF");
    if (off == text.npos) notOff();
    std::string_view prefix = text.substr(0, off);
    const auto strip = [&](std::string_view letter) {
      const bool has = prefix.substr(0, letter.size()) == letter;
      if (has) prefix.remove_prefix(letter.size());
      return has;
    };
    uvs_ = strip("ST");
    colours_ = strip("C");
    normals_ = strip("N");
    if (prefix == "4" || prefix == "n" || prefix == "4n")
      scanner_.fail("the file has four or n dimensions; export the mesh in three");
    if (!prefix.empty()) notOff();
    text.remove_prefix(off + 3);
    if (text.empty() && !scanner_.token(text) && !scanner_.nextFilledLine(text)) cutShort();
    if (text == "BINARY")
      scanner_.fail("binary OFF is not read; export the mesh as text OFF or binary PLY");
    vertexCount_ = count(text, normals_ ? 6 : 3);
    if (!scanner_.anyToken(text)) cutShort();
    faceCount_ = count(text, 4);
  }

  [[noreturn]] void notOff() const {
    scanner_.fail("an OFF file begins with OFF, COFF, NOFF or STOFF; give an OFF file");
  }

  [[noreturn]] void cutShort() const {
    scanner_.fail("the file is cut short or promises too much; export it again");
  }

  // Each promised item takes at least `numbers` numbers of two bytes.
  std::int64_t count(std::string_view text, std::int64_t numbers) const {
    const std::int64_t value = scanner_.integer(text);
    if (value < 0) scanner_.fail("a count is negative; export the mesh again");
    if (value > static_cast<std::int64_t>(scanner_.remainingBytes() + 1) / (2 * numbers))
      scanner_.fail(
          fmt::format("{} items do not fit in the {} bytes left; the file is cut short "
                      "or promises too much; export it again",
                      value, scanner_.remainingBytes()));
    requireCountable(file_.path, static_cast<std::size_t>(value));
    return value;
  }

  void poll(std::int64_t index) const {
    if (index % 65536 == 0) throwIfCancelled();
  }

  void readVertex(std::int64_t index) {
    poll(index);
    std::string_view text;
    if (!scanner_.nextFilledLine(text)) cutShort();
    const double x = scanner_.number(text);
    const double y = scanner_.nextNumber("y"), z = scanner_.nextNumber("z");
    mesh_.vertices.push_back({x, y, z});
    for (int k = 0; normals_ && k < 3; ++k)  // a normal may well be NaN
      if (!scanner_.token(text)) scanner_.fail("the line ends before its normal");
    if (!colours_ && !uvs_) return;
    double rest[6];
    std::size_t have = 0;
    for (; have < 6 && scanner_.token(text); ++have) {
      rest[have] = scanner_.number(text);
      if (have < 3 && text.find_first_of(".eE") != text.npos) wholeColours_ = false;
    }
    if (uvs_) {
      if (have < 2) scanner_.fail("the line ends before its texture coordinates");
      have -= 2;
      mesh_.uvs.push_back({rest[have], rest[have + 1]});
    }
    if (colours_) {
      if (have < 3) scanner_.fail("the line ends before its colour");
      rawColours_.push_back({rest[0], rest[1], rest[2]});
    }
  }

  void readFace(std::int64_t index) {
    poll(index);
    std::string_view text;
    if (!scanner_.nextFilledLine(text)) cutShort();
    const std::int64_t corners = scanner_.integer(text);
    if (corners < 3)
      scanner_.fail(fmt::format("a face needs three corners, here are {}; remove it", corners));
    if (corners > static_cast<std::int64_t>(scanner_.remainingBytes() + 1) / 2) cutShort();
    for (std::int64_t k = 0; k < corners; ++k) {
      if (!scanner_.token(text)) scanner_.fail("the line ends before its corners");
      const std::int64_t v = scanner_.integer(text);
      if (v < 0 || v >= vertexCount_)
        scanner_.fail(fmt::format("vertex {} is out of range, the file has {} (counted from 0)", v,
                                  vertexCount_));
      mesh_.corners.push_back(static_cast<int>(v));
    }
    requireCountable(file_.path, mesh_.corners.size());
    mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
  }

  // Whole numbers count to 255, others to 1.
  void scaleColours() {
    const double scale = wholeColours_ ? 1 / 255.0 : 1.0;
    for (const Vec3& c : rawColours_)
      mesh_.colours.push_back(clampedColour(scale * c.x, scale * c.y, scale * c.z));
    if (uvs_) mesh_.uvCorners = mesh_.corners;
  }

  const FileBytes& file_;
  TextScanner scanner_;
  PolygonMesh mesh_;
  Points rawColours_;
  std::int64_t vertexCount_ = 0, faceCount_ = 0;
  bool uvs_ = false, colours_ = false, normals_ = false, wholeColours_ = true;
};

}  // namespace

PolygonMesh readOff(const FileBytes& file) { return OffReader(file).read(); }

}  // namespace innermap
