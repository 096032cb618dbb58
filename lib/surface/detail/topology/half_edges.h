// The sides of the triangles of a closed surface, for walks along edges and
// across them.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Half-edge 3 t + k runs from corner k of triangle t to corner k + 1 (modulo 3); its triangle lies
// to its left, seen from outside.
class HalfEdges {
 public:
  // Each edge must have two triangles that run along it in opposite ways; throws DataError.
  explicit HalfEdges(const std::vector<Triangle>& triangles);

  int size() const { return static_cast<int>(opposite_.size()); }
  int opposite(int h) const { return opposite_[h]; }
  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int tail(int h) const { return (*triangles_)[h / 3][h % 3]; }
  int head(int h) const { return tail(next(h)); }
  int apex(int h) const { return tail(previous(h)); }                    // the corner opposite
  int edge(int h) const { return h < opposite_[h] ? h : opposite_[h]; }  // one of the two

  // Outgoing half-edges in turn around the tail.
  int counterclockwise(int h) const { return opposite_[previous(h)]; }
  int clockwise(int h) const { return next(opposite_[h]); }

  // Some outgoing half-edge of each vertex; -1 of loose ones. #vertices.
  std::vector<int> outgoing(std::size_t vertices) const;

 private:
  const std::vector<Triangle>* triangles_;
  std::vector<int> opposite_;
};

}  // namespace innermap
