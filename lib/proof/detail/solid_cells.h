// The cells of an octree about a solid, and which of them hold points of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/bvh.h"
#include "innermap/mesh/mesh.h"
#include "innermap/proof/prove.h"
#include "mesh/winding_number.h"
#include "proof/detail/lane_kernels.h"

namespace innermap::proof {

// A cell by its path: 1, then three bits a level.
using CellKey = std::uint64_t;
constexpr int kMostLevels = 20;

inline CellKey childOf(CellKey key, int lane) { return key << 3 | static_cast<CellKey>(lane); }
inline int levelOf(CellKey key) {
  int level = 0;
  while (key >>= 3) ++level;
  return level;
}

struct OpenCell {
  CellKey key = 1;
  bool inside = false;  // no triangle meets it
  double excess = 0;    // S of the step where the proof failed; infinite where that is not known
};

struct ChildLanes {
  std::uint8_t alive = 0, inside = 0;
};

// In coordinates of the proof: those of the mesh times proofScale().
class SolidCells {
 public:
  // The mesh must be closed.
  explicit SolidCells(const Mesh& mesh);

  double scale() const { return scale_; }

  // Of the node's children: those that may hold points of the solid, and which of these lie in it
  // wholly. A child is left out where no triangle meets it and its centre lies outside.
  ChildLanes children(const OpenCell& parent) const;
  void sets(CellKey parent, LaneSets& out) const;

  ProofCell world(CellKey key) const;

 private:
  struct Cell {
    Vec3 center;
    double half = 0;  // of its edge
  };
  Cell local(CellKey key) const;  // about center_
  bool meetsSurface(const Cell& cell) const;

  double scale_ = 1;
  Vec3 center_;                                 // of the root's cube, scaled
  double half_ = 1;                             // a power of two
  std::vector<std::array<Vec3, 3>> triangles_;  // scaled, about center_; in the order of the leaves
  Bvh tree_;
  WindingNumber winding_;
};

}  // namespace innermap::proof
