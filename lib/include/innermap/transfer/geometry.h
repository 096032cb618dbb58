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

// Gaussian splats stay in their file and are carried as it is written, so that millions take no
// more memory than points do.
struct SplatCloud {
  int degree = -1;  // of the colours' harmonics, 0 to 3; -1: points are no splats
};

struct Geometry {
  Points points;  // world units; new ones of split edges at the end
  // Points after these are not the file's: places at which cells' values are carried.
  std::size_t ownPoints = 0;
  std::vector<Directions> directions;  // the first is that of Corner::direction, where corners have
  bool cornerDirections = false;       // some; directions otherwise stand at points
  std::size_t textures = 0;            // of Corner::texture
  Elements elements;
  SplatCloud splats;
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

// Gaussian splats as the reference implementation of Kerbl, Kopanas, Leimkuehler and Drettakis, "3D
// Gaussian Splatting for Real-Time Radiance Field Rendering" (2023), stores them. A splat about the
// point c has the covariance S = Q diag(exp(2 logScales)) Q^T, Q being its quaternion's rotation.
struct Splat {
  Vec3 logScales;  // natural logarithms of standard deviations in world units
  std::array<double, 4> quaternion{{1, 0, 0, 0}};  // w x y z, of any length but 0
  double opacity = 0;                              // logit of alpha, in [-inf, inf]
  int degree = 0;                                  // of the harmonics, 0 to 3
  // Coefficients of the colour's real spherical harmonics of degrees 1 to `degree`, with the
  // reference's signs: those of red, of green, of blue, each (degree + 1)^2 - 1.
  std::array<double, 45> harmonics{};
};

// look keeps alpha. With it a cloud hides what is behind it as much as before, along the image of
// each ray, however the map stretches it.
//
// mass: alpha' = alpha A / A', A being the mean of the splat's cross section, 2 pi times the root
// of the projected covariance's determinant, over all directions: half the area of the ellipsoid
// whose semi-axes are the scales (Cauchy), world units squared. Light that crosses a length L of
// splats strewn at random, n a volume, is dimmed to exp(-n L A alpha) on average; n changes by 1 /
// |det J|, so this is what a fog of the same mass does, exactly on average over directions, and in
// each where J is a similarity. alpha grows to 0.99 at most, where the reference's renderer stops,
// or stays where it was above.
enum class SplatOpacity { look, mass };

struct CarriedSplat {
  Splat splat;
  bool capped = false;  // alpha was to grow above its limit
};

// With J the Jacobian and R its polar factor: the covariance is J S J^T, its axes in the order of
// those that were turned. Along R d the colour is what it was along d; where J turns space inside
// out R is a reflection. The quaternion keeps its length and its sign. Where J is not finite or of
// a rank below 2 the splat stays as it is.
CarriedSplat carriedSplat(const Mat3& jacobian, const Splat& splat,
                          SplatOpacity opacity = SplatOpacity::look);

Setting splatsSetting(SplatOpacity* opacity);

// Meshes, point clouds, curves and cells carried through a map.

struct CarryGeometrySettings {
  // Edges of faces and lines are split in the middle, again and again, until their straight images
  // are nowhere (at a quarter, a half, three quarters) farther than this from where the map brings
  // them: world units of what is carried to; 0 splits none. Not negative.
  double subdivide = 0;
  SplatOpacity splats = SplatOpacity::look;  // of what has splats alone
  bool mirrored = false;  // as Injectivity: det J < 0 where the map does not fold
};

// Of `subdivide`, as a share of the diagonal of the solid that is carried to.
Setting subdivideSetting(double* share);

struct CarriedSplats {
  int degree = -1;  // as SplatCloud
  SplatOpacity opacity = SplatOpacity::look;
  std::uint64_t capped = 0;  // of them, as GeometryFile::cappedOpacities() counts them
};

// Cells with a negative volume, before and after; nothing for geometry without cells.
struct InvertedCells {
  std::uint64_t cells = 0, before = 0, after = 0;
};

struct CarriedGeometry {
  CarriedPoints points;            // of geometry.points, those of cells' values included
  std::vector<Points> directions;  // as geometry.directions
  CarriedSplats splats;
  InvertedCells inverted;         // as GeometryFile::inverted() counts them
  std::uint64_t ownPoints = 0;    // those of the file that were there before edges were split
  std::uint64_t added = 0;        // on split edges
  std::uint64_t folded = 0;       // points where the map folds, where Jacobians were taken
  std::uint64_t cutElements = 0;  // elements with a point that is cut
  // New numbers of the points that stay, -1 for others; and whether each element stays.
  std::vector<int> number;
  std::vector<std::uint8_t> stays;
};

// Splits edges of `geometry` where that is asked for, then carries it. Jacobians are taken where
// there are directions or splats. Throws what `carry` throws; MemoryError when edges are split
// beyond the limit; SettingError.
CarriedGeometry carryGeometry(Geometry& geometry, const PointCarry& carry,
                              const CarryGeometrySettings& settings = {});

// Peak need in bytes, beside the geometry itself, without splitting.
std::uint64_t carryGeometryMemory(const Geometry& geometry);

}  // namespace innermap
