// PLY: all elements and properties stay, in their types.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/ply_body.h"
#include "io/geometry/detail/geometry_formats.h"

namespace innermap {

// What a property of the vertices moves with: the place (-1) or one of the directions.
struct PlyMoving {
  int direction = -1, axis = 0;
};

class PlyGeometry : public GeometryFile {
 public:
  PlyGeometry(FileBytes file, const ReadGeometrySettings& settings)
      : file_(std::move(file)), header_(readPlyHeader(file_)) {
    read(settings);
  }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override;

 private:
  void read(const ReadGeometrySettings& settings);
  void findMoving(const PlyElement& element, const ReadGeometrySettings& settings);
  bool findThree(const PlyElement& element, const std::vector<std::array<std::string, 3>>& names,
                 int direction);
  void readVertices(PlyBody& body, const PlyElement& element);
  void addElement(PlyRole role, const PlyFaces& face);

  double moved(const PlyMoving& what, std::size_t point, const CarriedGeometry& carried) const {
    const Points& of = what.direction < 0
                           ? carried.points.points
                           : carried.directions[static_cast<std::size_t>(what.direction)];
    return of[point][what.axis];
  }
  void writeHeader(OutputBuffer& out, const CarriedGeometry& carried) const;
  void writeVertices(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                     const CarriedGeometry& carried) const;
  void writeAdded(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                  const std::vector<std::size_t>& rows, const CarriedGeometry& carried) const;
  void writeElement(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                    std::size_t which) const;
  void copy(OutputBuffer& out, std::size_t begin, std::size_t end) const {
    out.raw(std::string_view(file_.bytes).substr(begin, end - begin));
  }
  std::vector<double> textureAt(int texture) const;

  FileBytes file_;
  PlyHeader header_;
  std::map<std::size_t, PlyMoving> moving_;  // of the vertices' properties, by their place
  std::vector<PlyRole> roles_;               // #elements of the file
  std::vector<double> textures_;             // two for each corner, where faces have them
  mutable const CarriedGeometry* carried_ = nullptr;
};

}  // namespace innermap
