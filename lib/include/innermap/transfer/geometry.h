// Geometry to be carried through a map, whatever file it comes from: points, directions at them,
// and what lies between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

// Vectors are turned by the Jacobian; normals by its inverse transpose and keep their lengths.
enum class DirectionKind { vector, normal };

struct Directions {
  std::string name;
  DirectionKind kind = DirectionKind::normal;
  Points values;            // #D
  std::vector<int> points;  // #D: the point that each is at
};

// A corner of an element: what it has of each channel, -1 for nothing. A channel is a list of
// things: points, a direction at points, texture coordinates.
struct Corner {
  int point = -1, direction = -1, texture = -1;
};

// Polygons, lines and points of a mesh; or cells, which are only looked at.
struct Elements {
  enum class Kind : std::uint8_t { face, line, points, cell };
  std::vector<Corner> corners;
  std::vector<std::size_t> start{0};  // #E + 1: element e has corners [start[e], start[e + 1])
  std::vector<Kind> kinds;            // #E
  std::vector<std::uint32_t> source;  // #E: the element of the file that it came from

  std::size_t size() const { return kinds.size(); }
  void add(Kind kind, std::uint32_t from, const Corner* begin, std::size_t count);
};

// Things in the middle of two others of their channel, in the order in which they were made; number
// i of them is the channel's thing `originals + i`.
class Midpoints {
 public:
  void begin(std::size_t originals) { originals_ = originals; }

  // The thing between a and b, made when there is none; -1 when either is.
  int between(int a, int b);
  // -1 when there is none.
  int find(int a, int b) const;

  std::size_t originals() const { return originals_; }
  const std::vector<std::array<int, 2>>& parents() const { return parents_; }

 private:
  std::size_t originals_ = 0;
  std::vector<std::array<int, 2>> parents_;
  std::unordered_map<std::uint64_t, int> made_;
};

struct Geometry {
  Points points;  // world units; new ones of split edges at the end
  // Points after these are not the file's: places at which cells' values are carried.
  std::size_t ownPoints = 0;
  std::vector<Directions> directions;  // the first is that of Corner::direction, where corners have
  bool cornerDirections = false;       // some; directions otherwise stand at points
  std::size_t textures = 0;            // of Corner::texture
  Elements elements;
  bool splittable = true;  // its edges may be split

  Midpoints pointMiddles, directionMiddles, textureMiddles;
};

// Splits all of these edges (pairs of points, in any order), so that each element that has one gets
// the new point: lines get more corners, a triangle becomes two to four, a polygon first its
// triangles where it has such an edge. So no corner comes to lie within another face's edge. Values
// of the new points' directions are the means of their ends'.
void splitEdges(Geometry& geometry, const std::vector<std::array<int, 2>>& edges);

// The edges of faces and lines, each once, lower point first.
std::vector<std::array<int, 2>> edgesOf(const Geometry& geometry);

// Meshes, point clouds, curves and cells carried through a map.

struct CarryGeometrySettings {
  // Edges of faces and lines are split in the middle, again and again, until their straight images
  // are nowhere (at a quarter, a half, three quarters) farther than this from where the map brings
  // them: world units of what is carried to; 0 splits none. Not negative.
  double subdivide = 0;
};

// Of `subdivide`, as a share of the diagonal of the solid that is carried to.
Setting subdivideSetting(double* share);

struct CarriedGeometry {
  CarriedPoints points;            // of geometry.points, those of cells' values included
  std::vector<Points> directions;  // as geometry.directions
  std::uint64_t ownPoints = 0;     // those of the file that were there before edges were split
  std::uint64_t added = 0;         // on split edges
  std::uint64_t folded = 0;        // points where the map turns space inside out, where Jacobians
                                   // were taken
  std::uint64_t cutElements = 0;   // elements with a point that is cut
  // New numbers of the points that stay, -1 for others; and whether each element stays.
  std::vector<int> number;
  std::vector<std::uint8_t> stays;
};

// Splits edges of `geometry` where that is asked for, then carries it. Jacobians are taken where
// there are directions. Throws what `carry` throws; MemoryError when edges are split beyond the
// limit; SettingError.
CarriedGeometry carryGeometry(Geometry& geometry, const PointCarry& carry,
                              const CarryGeometrySettings& settings = {});

// Peak need in bytes, beside the geometry itself, without splitting.
std::uint64_t carryGeometryMemory(const Geometry& geometry);

}  // namespace innermap
