// A part of a tetrahedral mesh and of where it is carried, whose connectivity changes.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// The least sine of the six dihedral angles (1 at most, of a regular tetrahedron 0.943), negative
// for an inverted one: low where an angle is near 0 or 180 degrees.
inline double leastSine(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::array<Vec3, 4> p{a, b, c, d};
  const double volume6 = dot(b - a, cross(c - a, d - a));
  // Twice the area of the face opposite each corner.
  const std::array<double, 4> area{norm(cross(c - b, d - b)), norm(cross(c - a, d - a)),
                                   norm(cross(b - a, d - a)), norm(cross(b - a, c - a))};
  double least = 1;
  // The edge i, j lies between the faces opposite the other two corners.
  constexpr int kEdges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  for (const auto& e : kEdges) {
    const double areas = area[e[2]] * area[e[3]];
    const double sine = areas > 0 ? volume6 * norm(p[e[0]] - p[e[1]]) / areas : 0;
    least = std::min(least, sine);
  }
  return least;
}

inline double leastSine(const Points& at, const Tetrahedron& t) {
  return leastSine(at[t[0]], at[t[1]], at[t[2]], at[t[3]]);
}

class LocalCells {
 public:
  Points at, source;                // #V: where they are carried, and where they come from
  std::vector<SurfacePoint> place;  // #V: on the surface; triangle -1 inside
  std::vector<char> moving;         // #V: all tetrahedra of the vertex are here
  std::vector<char> off;            // #V: on the boundary, but not on the surface
  std::vector<Tetrahedron> tets;
  std::vector<char> alive;             // of each tetrahedron
  std::vector<int> origin;             // the one that was there, in the source, at first
  std::vector<std::vector<int>> star;  // #V: tetrahedra alive, in no order that matters

  bool onBoundary(int v) const { return place[v].triangle >= 0; }

  int add(const Tetrahedron& t, int from) {
    const int number = static_cast<int>(tets.size());
    origin.push_back(from);
    tets.push_back(t);
    alive.push_back(1);
    for (const int v : t) star[v].push_back(number);
    return number;
  }
  void remove(int t) {
    alive[t] = 0;
    for (const int v : tets[t]) {
      auto& list = star[v];
      list.erase(std::find(list.begin(), list.end(), t));
    }
  }
  double quality(int t) const { return leastSine(at, tets[t]); }
};

// What a step would do: the worst quality before and after.
struct Change {
  double before = 0, after = -1;
  std::vector<int> removed;
  std::vector<Tetrahedron> added;

  bool better() const { return after > 1.02 * before + 1e-7; }
};

// Vertex `from` of the boundary, with its triangles, drawn into `to`, a neighbour there; `after` is
// -1 where that is not to be done. The boundary changes, but for its topology.
Change collapseBoundary(const LocalCells& cells, int from, int to);

// Each is empty (not better) where it cannot be done or would leave a tetrahedron of the source
// below kLeastSource; none changes the boundary.
// The edge taken out and the ring about it filled anew, the best way (Klincsek, "Minimal
// triangulations of polygonal domains", 1980; Shewchuk, "Two discrete optimization algorithms for
// the topological improvement of tetrahedral meshes", 2002).
Change removeEdge(const LocalCells& cells, int a, int b);
// The face opposite the corner taken out, with an edge through it instead.
Change removeFace(const LocalCells& cells, int tet, int corner);
// Vertex `from`, inside, drawn into `to`.
Change collapseEdge(const LocalCells& cells, int from, int to);

// The numbers of what was added.
std::vector<int> apply(LocalCells& cells, const Change& change);

}  // namespace innermap
