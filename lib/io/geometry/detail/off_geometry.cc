// OFF as text, with vertices one to a line.
#include <algorithm>

#include "io/geometry/detail/geometry_formats.h"
#include "mesh/off_scanner.h"

namespace innermap {
namespace {

class OffGeometry : public GeometryFile {
 public:
  explicit OffGeometry(FileBytes file) : file_(std::move(file)) {
    geometry.splittable = false;
    OffScanner off(file_);
    if (off.normals) geometry.directions.push_back({"normals", DirectionKind::normal, {}, {}});
    for (int v = 0; v < off.vertices; ++v) {
      geometry.points.push_back(off.nextVertex());
      if (!off.normals) continue;
      geometry.directions[0].values.push_back(off.text().nextVec3("normal"));
      geometry.directions[0].points.push_back(v);
    }
    std::vector<Corner> corners;
    for (std::uint32_t f = 0; f < off.faces; ++f) {
      const std::vector<int>& points = off.nextFace();
      corners.assign(points.size(), {});
      for (std::size_t k = 0; k < points.size(); ++k) corners[k].point = points[k];
      geometry.elements.add(Elements::Kind::face, f, corners.data(), corners.size());
    }
    geometry.ownPoints = geometry.points.size();
  }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override {
    OutputBuffer out(stream);
    FileCopy copy(file_, out);
    OffScanner off(file_);
    const auto stay = [](int number) { return number >= 0; };
    copy.to(off.countsBegin);
    out.print("{} {} {}", std::count_if(carried.number.begin(), carried.number.end(), stay),
              std::count(carried.stays.begin(), carried.stays.end(), 1), off.edges);
    copy.skipTo(off.countsEnd);
    for (std::size_t v = 0; v < geometry.ownPoints; ++v) {
      off.nextVertex();
      if (off.normals) off.text().nextVec3("normal");
      copy.to(off.text().lineBegin());
      if (stay(carried.number[v])) {
        writeRow(out, carried.points.points[v]);
        if (off.normals) out.raw(" "), writeRow(out, carried.directions[0][v]);
      }
      skip(copy, off, stay(carried.number[v]));
    }
    for (std::size_t f = 0; f < carried.stays.size(); ++f) {
      const std::vector<int>& corners = off.nextFace();
      copy.to(off.text().lineBegin());
      if (carried.stays[f]) {
        out.print("{}", corners.size());
        for (const int point : corners)
          out.print(" {}", carried.number[static_cast<std::size_t>(point)]);
      }
      skip(copy, off, carried.stays[f]);
    }
    copy.to(file_.bytes.size());
    return {};
  }

 private:
  static void writeRow(OutputBuffer& out, const Vec3& p) { out.print("{} {} {}", p.x, p.y, p.z); }

  // What the line has behind what was read of it stays with it.
  static void skip(FileCopy& copy, OffScanner& off, bool stays) {
    copy.skipTo(stays ? off.text().position() : off.text().endLine());
  }

  FileBytes file_;
};

}  // namespace

std::unique_ptr<GeometryFile> readOffGeometry(FileBytes file) {
  return std::make_unique<OffGeometry>(std::move(file));
}

}  // namespace innermap
