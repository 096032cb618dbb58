// A triangulated surface split where a map bends it, so that straight edges between the images of
// its vertices lie near the image of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct RefinedSurface {
  // Not split yet: vertices and triangles of the mesh.
  explicit RefinedSurface(const Mesh& mesh);

  std::vector<SurfacePoint> vertices;  // where each stands on the mesh
  Points positions;                    // of these, there
  std::vector<Triangle> triangles;
  // Of each of the triangles: that of the mesh which it is a part of, and the barycentric
  // coordinates of its corners there.
  struct Part {
    int triangle = 0;
    std::array<std::array<double, 3>, 3> corners{};
  };
  std::vector<Part> parts;
};

// Where an edge is looked at, from its lesser vertex on: one that is bent like an S is straight in
// its middle.
constexpr std::array<double, 3> kAlongEdge{0.5, 0.25, 0.75};

struct EdgeHash {
  std::size_t operator()(const std::array<int, 2>& edge) const {
    return std::hash<std::uint64_t>()(static_cast<std::uint64_t>(edge[0]) << 32 ^
                                      static_cast<std::uint64_t>(edge[1])) *
           0x9e3779b97f4a7c15u;
  }
};

// Images of these places along each edge that was looked at and left whole, by its vertices, the
// lesser first. Moved along with the images of the vertices they spare a refinement that goes on
// from there the way from the mesh to them.
using EdgeImages = std::unordered_map<std::array<int, 2>, std::array<Vec3, 3>, EdgeHash>;

using PlacesToPoints = std::function<Points(const std::vector<SurfacePoint>&)>;

// Splits edges at their middle where the image of one is farther than `chord` from the straight
// line between the images of its ends, and the triangles beside them (by their longest edges, which
// keeps angles from shrinking: Rivara, "Algorithms for refining triangular grids", 1984); again, as
// long as there are any and no more than `most` triangles. Edges that are shorter than `chord` on
// the mesh stay whole: what is bent there is torn. images: of the vertices, in and out; edges: in,
// those that are known, and out; imagesOf: of places on the mesh. chord in the units of all.
void refine(RefinedSurface& surface, Points& images, EdgeImages& edges,
            const PlacesToPoints& imagesOf, double chord, std::size_t most);

}  // namespace innermap
