// STL, binary and text. A triangle's normal is carried at its centre.
#include "io/geometry/detail/geometry_formats.h"
#include "mesh/stl_scanner.h"

namespace innermap {
namespace {

class StlGeometry : public GeometryFile {
 public:
  explicit StlGeometry(FileBytes file) : file_(std::move(file)) {
    geometry.splittable = false;
    geometry.directions.push_back({"normals", DirectionKind::normal, {}, {}});
    for (StlScanner stl(file_, true); stl.next();) addTriangle(stl);
    addCentres();
  }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override {
    OutputBuffer out(stream);
    FileCopy copy(file_, out);
    StlScanner stl(file_, true);
    if (stl.binary()) {
      std::uint32_t count = 0;
      for (const std::uint8_t stays : carried.stays) count += stays;
      copy.to(StlScanner::kHeader - sizeof count);
      out.number(count);
      copy.skipTo(StlScanner::kHeader);
    }
    for (std::size_t t = 0; stl.next(); ++t) {
      copy.to(stl.facet.begin);
      for (std::size_t k = 0; k < 4 && carried.stays[t]; ++k) {
        copy.to(stl.span(k).begin);
        const Vec3& p = k == 0 ? carried.directions[0][t] : carried.points.points[3 * t + k - 1];
        if (stl.binary())
          for (int a = 0; a < 3; ++a) out.number(static_cast<float>(p[a]));
        else
          out.print(" {} {} {}", p.x, p.y, p.z);
        copy.skipTo(stl.span(k).end);
      }
      carried.stays[t] ? copy.to(stl.facet.end) : copy.skipTo(stl.facet.end);
    }
    copy.to(file_.bytes.size());
    return {};
  }

 private:
  void addTriangle(const StlScanner& stl) {
    requireCountable(file_.path, geometry.points.size() + 3);
    Corner at[3];
    for (int k = 0; k < 3; ++k) {
      at[k].point = static_cast<int>(geometry.points.size());
      geometry.points.push_back(stl.rows[k + 1]);
    }
    geometry.elements.add(Elements::Kind::face,
                          static_cast<std::uint32_t>(geometry.elements.size()), at, 3);
    geometry.directions[0].values.push_back(stl.rows[0]);
  }

  void addCentres() {
    geometry.ownPoints = geometry.points.size();
    requireCountable(file_.path, geometry.ownPoints / 3 * 4);
    for (std::size_t t = 0; t < geometry.elements.size(); ++t) {
      const Points& p = geometry.points;
      geometry.directions[0].points.push_back(static_cast<int>(p.size()));
      geometry.points.push_back((p[3 * t] + p[3 * t + 1] + p[3 * t + 2]) / 3.0);
    }
  }

  FileBytes file_;
};

}  // namespace

std::unique_ptr<GeometryFile> readStlGeometry(FileBytes file) {
  return std::make_unique<StlGeometry>(std::move(file));
}

}  // namespace innermap
