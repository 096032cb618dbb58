// The page that people look at: report.html, one file that needs no network.
//
// A Page holds what there is to see; the numbers come from the report. assets/ is what shows
// both in a browser.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"
#include "report/page/encode.h"

namespace innermap {

// Where the vertices of a shape stand: at rest, in a frame.
struct PagePlace {
  std::string label;
  Points points;
};

// A value at each vertex of a shape, for each of its places but the first; or one list for all.
struct PageScalar {
  std::string name;  // "boundary_error", "stretch", which the page knows how to colour
  std::vector<std::vector<double>> values;
};

// A surface. With one place it is shown by itself, with more the first beside the others.
struct PageShape {
  std::vector<Triangle> triangles;
  std::vector<PagePlace> places;  // of as many points each
  std::vector<PageScalar> scalars;
  std::size_t givenVertices = 0;  // before simplify(); 0: as many as here
};

// A grid cut down to blocks of stride^3 voxels.
struct PageGrid {
  std::string name;
  std::string reduction;           // "mean", or "least" of each block
  std::array<int, 3> blocks{};     // along x, y, z
  int stride = 1;                  // voxels
  Vec3 origin;                     // of the first block's corner, world units
  std::array<Vec3, 3> axes;        // from block to block, world units
  double least = 0, greatest = 0;  // of the grid itself
  Quantised values;                // x fastest; none where the grid has none
  std::optional<std::int64_t> frame;
  // Of blocks of several voxels: planes through the middle, voxel by voxel.
  std::vector<PageGrid> planes;
  std::optional<int> across;  // of a plane: the axis that it is across
};

// A frame of an animation.
struct PageFrame {
  std::int64_t number = 0;
  std::size_t index = 0, of = 1;  // among those that are made
};

struct Page {
  std::vector<PageShape> shapes;
  std::vector<PageGrid> grids;
  std::vector<std::string> missing;  // what could not be shown, and why, a line each
  std::optional<PageFrame> frame;    // that is being made

  bool empty() const { return shapes.empty() && grids.empty(); }
};

// Keeps one vertex of each cell of a lattice through the shape, as fine as `mostVertices` allow; a
// shape that has no more stays as it is. shape: with one place and no scalars. Which vertices are
// kept: the vertices now are those of before at these indices.
std::vector<int> simplify(PageShape& shape, std::size_t mostVertices);

// Vertices that a shape of so many places may have in a page of reasonable size.
std::size_t verticesForPlaces(std::size_t places);

// The largest stretch of the triangles about each vertex on the way from one place to another: the
// larger singular value of each triangle's linear map, averaged by area. 1: as long as before.
std::vector<double> stretches(const Points& from, const Points& to,
                              const std::vector<Triangle>& triangles);

// Of so many frames, a page shows each such one.
std::size_t frameStep(std::size_t frames);

// Adds the grids whose values are numbers, and vectors by their components. Of several of one name
// the first stays; those of page.frame are that frame's, coarser the more frames there are.
void addGrids(Page& page, const openvdb::GridPtrVec& grids);

// The whole file. reportJson: as report.json has it.
std::string pageHtml(const Page& page, const std::string& reportJson);

// Throws FileError. The file appears whole or not at all.
void writePage(const std::string& path, const Page& page, const std::string& reportJson);

}  // namespace innermap
