// Plane cuts of grids along an axis, voxel by voxel.
//
// A slice is a layer of voxels, not interpolated: its plane goes through voxel centres. Its image
// is upright: the second of its two axes points up, so row 0 holds the largest index of it.
//   axis x: columns z, rows y      axis y: columns x, rows z      axis z: columns x, rows y
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// 0, 1, 2 for "x", "y", "z" (either case); throws SettingError for other texts.
int parseAxis(const std::string& setting, const std::string& text);
char axisName(int axis);

struct SliceFrame {
  int axis = 2, columnAxis = 0, rowAxis = 1;
  openvdb::CoordBBox box;  // voxels, inclusive
  openvdb::math::Transform::ConstPtr transform;

  std::size_t columns() const { return static_cast<std::size_t>(box.dim()[columnAxis]); }
  std::size_t rows() const { return static_cast<std::size_t>(box.dim()[rowAxis]); }
  int layers() const { return box.dim()[axis]; }
  openvdb::Coord coord(std::size_t column, std::size_t row, int layer) const;
  // World position of a voxel's centre.
  Vec3 world(std::size_t column, std::size_t row, int layer) const;
  // World coordinate along the axis at the layer's middle; `layer` may lie between two.
  double position(double layer) const;
  double layerAt(double position) const;  // the other way round, for axis-aligned transforms
};

// The frame of all active voxels of the grids. Throws DataError when there is none, when the grids
// have different transforms or one that is not linear, or when the box has more than 65,536 voxels
// along a side.
SliceFrame sliceFrame(const openvdb::GridPtrVec& grids, int axis);

// `count` distinct layers, evenly spaced through the frame's box (the middles of `count` equal
// parts); all of them when there are not so many.
std::vector<int> sliceLayers(const SliceFrame& frame, int count);

// The axis along which a box of this extent is thinnest: a cut across it shows most.
int thinnestAxis(const Vec3& extent);

// The fraction along the axis of the layer nearest the middle that cuts nearly as much of the solid
// as any does. density: a fog volume with active voxels.
double fullLayer(const openvdb::FloatGrid& density, int axis);

struct SliceChannel {
  std::string name;           // "jacobian.V", "map.X", "Cd.R"
  std::vector<float> values;  // #rows * #columns, row by row
};

// Channels of a grid: one for scalars (V), three for vectors (X, Y, Z; R, G, B for `Cd` and
// `color`). Throws DataError for types that have no numbers.
std::vector<std::string> channelNames(const openvdb::GridBase& grid);

// Values of a layer. Inactive voxels are 0, but for level sets, whose inactive values tell inside
// from outside.
std::vector<SliceChannel> sliceGrid(const openvdb::GridBase& grid, const SliceFrame& frame,
                                    int layer);

// 1 where a voxel of any of the grids is active, else 0.
std::vector<float> sliceMask(const openvdb::GridPtrVec& grids, const SliceFrame& frame, int layer);

}  // namespace innermap
