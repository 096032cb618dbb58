// PLY: all elements and properties stay, in their types.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/ply_body.h"
#include "io/geometry/detail/geometry_formats.h"
#include "io/geometry/detail/ply_splats.h"

namespace innermap {

// What a property of the vertices moves with: the place (-1) or one of the directions; or which
// part of a splat it is.
struct PlyMoving {
  static constexpr int kSplat = -2;
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
  std::uint64_t cappedOpacities(const CarriedGeometry& carried) const override;

 private:
  void read(const ReadGeometrySettings& settings);
  void findMoving(const PlyElement& element, const ReadGeometrySettings& settings);
  void findSplats(const PlyElement& element);
  bool findThree(const PlyElement& element, const std::vector<std::array<std::string, 3>>& names,
                 int direction);
  void readVertices(PlyBody& body, const PlyElement& element);
  void addElement(PlyRole role, const PlyFaces& face);

  // Of the row at the body's position, which stays there.
  CarriedSplat carrySplat(PlyBody& body, const PlyElement& element, std::size_t row,
                          const CarriedGeometry& carried) const;
  // Calls use(body at the first, first row, last row, number of the part) for parts of rows [begin,
  // end), at the first of which `body` is; it is behind them afterwards. Side by side, each with a
  // body of its own, where all rows are as long; one part otherwise.
  template <class Use>
  void forRows(PlyBody& body, const PlyElement& element, std::size_t begin, std::size_t end,
               const Use& use) const;

  double moved(const PlyMoving& what, std::size_t point, const CarriedGeometry& carried) const {
    const Points& of = what.direction < 0
                           ? carried.points.points
                           : carried.directions[static_cast<std::size_t>(what.direction)];
    return of[point][what.axis];
  }
  void writeHeader(OutputBuffer& out, const CarriedGeometry& carried) const;
  void writeVertices(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                     const CarriedGeometry& carried) const;
  void writeVertex(OutputBuffer& out, PlyBody& body, const PlyElement& element, std::size_t row,
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
  std::vector<std::optional<PlyMoving>> moving_;  // #properties of the vertices
  PlySplats splats_;
  const PlyElement* vertices_ = nullptr;
  std::size_t vertexBody_ = 0;    // where the body has them
  std::vector<PlyRole> roles_;    // #elements of the file
  std::vector<double> textures_;  // two for each corner, where faces have them
  mutable const CarriedGeometry* carried_ = nullptr;
};

}  // namespace innermap
