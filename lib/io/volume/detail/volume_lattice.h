// Where the voxels of a volume texture stand: its dense box, and where each slice of that lies in
// an image.
#pragma once

#include <openvdb/openvdb.h>

#include <utility>

namespace innermap {

struct VolumeLattice {
  int axis = 2, columnAxis = 0, rowAxis = 1;
  bool rowsUp = false;                // the first row has the largest index along rowAxis
  openvdb::Coord origin{0, 0, 0};     // index of the box's least voxel
  openvdb::Coord size{0, 0, 0};       // voxels along x, y, z
  openvdb::Mat4d indexToWorld;        // row vectors: (i, j, k, 1) * indexToWorld
  int tileColumns = 1, tileRows = 1;  // 1, 1 but for an atlas

  void setAxis(int across);                       // columns and rows as those of slice.h
  int width() const { return size[columnAxis]; }  // of a slice, pixels
  int height() const { return size[rowAxis]; }
  int slices() const { return size[axis]; }
  std::uint64_t voxels() const;
  openvdb::Coord coord(int column, int row, int slice) const;
  openvdb::CoordBBox box() const;
  // Axis-aligned box of the voxels' outer faces in world space.
  openvdb::BBoxd worldBox() const;
  // The box as the unit cube of texture coordinates (along x, y, z) to world space; row vectors.
  openvdb::Mat4d textureToWorld() const;
};

// Columns and rows of tiles, each width x height pixels, that hold `slices` of them in a picture as
// near to a square as can be; with the fewest empty tiles among those.
std::pair<int, int> nearSquareTiles(int width, int height, int slices);

// The least power of two that is not below n; n in [1, 2^30].
int powerOfTwo(int n);

}  // namespace innermap
