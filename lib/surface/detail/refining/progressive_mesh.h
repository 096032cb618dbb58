// A closed mesh that is made coarser by half-edge collapses and refined again
// by undoing them, last first.
//
// Hoppe, "Progressive meshes" (SIGGRAPH 1996).
#pragma once

#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/correspond.h"

namespace innermap {

// A neighbour of a vertex and the translation of its copy there (torus).
struct RingVertex {
  int vertex = 0;
  Shift shift;
};
using Ring = std::vector<RingVertex>;

class ProgressiveMesh {
 public:
  // shift: the corners' of a layout on the torus, or empty. Triangles must be closed and manifold.
  ProgressiveMesh(std::size_t vertices, const std::vector<Triangle>& triangles,
                  const std::vector<CornerShifts>& shift = {});

  // What stands now. Dead triangles keep what they held.
  const Triangle& triangle(int t) const { return triangles_[t]; }
  bool alive(int t) const { return alive_[t] != 0; }
  bool present(int v) const { return present_[v] != 0; }
  std::size_t triangleCount() const { return triangles_.size(); }
  std::size_t vertexCount() const { return vertexCount_; }  // that are present
  std::size_t capacity() const { return around_.size(); }
  const std::vector<int>& around(int v) const { return around_[v]; }  // triangles of v
  Shift shift(int t, int k) const { return shift_.empty() ? Shift{} : shift_[t][k]; }

  // Neighbours in order, counterclockwise seen from outside; shifts relative to v's own place.
  void ring(int v, Ring& out) const;

  // Whether removing v into its neighbour w leaves a closed manifold without double edges, of the
  // same genus, and more than a tetrahedron.
  bool collapsible(const Ring& ring, std::size_t w) const;

  // v's triangles become w's. Remembered.
  void collapse(int v, const RingVertex& w);

  std::size_t collapses() const { return splits_.size(); }
  int lastInto() const { return splits_.back().into; }
  // What split() returns next, and all its neighbours then.
  void nextStar(std::vector<int>& vertices) const;
  // Undoes the last collapse; the vertex that returns.
  int split();

 private:
  struct Split {
    int vertex, into, dead[2];
    Shift shift;  // of w's copy next to v
    std::size_t moved;
  };
  void erase(int v, int t);

  std::vector<Triangle> triangles_;
  std::vector<CornerShifts> shift_;
  std::vector<char> alive_, present_;
  std::vector<std::vector<int>> around_;
  std::vector<Split> splits_;
  std::vector<int> moved_;  // of all splits, one after the other
  std::size_t vertexCount_ = 0;
};

}  // namespace innermap
