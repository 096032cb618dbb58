// The body-centred cubic lattice that solids are cut out of: two cubic lattices, the nodes of one
// in the centres of the other's cells. Its tetrahedra are all alike (Labelle and Shewchuk,
// "Isosurface Stuffing", SIGGRAPH 2007).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

enum class NodeSide : std::uint8_t { outside = 0, on = 1, inside = 2 };

// Directions from a node to its 14 neighbours: d and d ^ 1 are opposite; the first six go along the
// axes and are one spacing long, the others sqrt(3)/2.
constexpr int kDirections = 14;
constexpr int kLongDirections = 6;
constexpr std::array<std::array<int, 3>, kDirections> kSteps = {{{2, 0, 0},
                                                                 {-2, 0, 0},
                                                                 {0, 2, 0},
                                                                 {0, -2, 0},
                                                                 {0, 0, 2},
                                                                 {0, 0, -2},
                                                                 {1, 1, 1},
                                                                 {-1, -1, -1},
                                                                 {1, 1, -1},
                                                                 {-1, -1, 1},
                                                                 {1, -1, 1},
                                                                 {-1, 1, -1},
                                                                 {1, -1, -1},
                                                                 {-1, 1, 1}}};  // half spacings

// Node c of the first lattice and node cells() + c of the second, half a spacing further on every
// axis, c = i + nx (j + ny k). No node within two of the lattice's sides may be inside.
class BccLattice {
 public:
  BccLattice() = default;
  BccLattice(const Vec3& origin, double spacing, const std::array<int, 3>& size);

  std::size_t cells() const { return cells_; }
  std::size_t nodes() const { return 2 * cells_; }
  const std::array<int, 3>& size() const { return size_; }
  double spacing() const { return spacing_; }
  const Vec3& origin() const { return origin_; }

  int second(std::size_t node) const { return node >= cells_ ? 1 : 0; }
  std::size_t neighbour(std::size_t node, int direction) const {
    return node + static_cast<std::size_t>(offsets_[second(node)][direction]);
  }
  const std::array<std::ptrdiff_t, kDirections>& offsets(int second) const {
    return offsets_[second];
  }
  Vec3 position(std::size_t node) const;
  // The node nearest to p, of those that are not within two of the lattice's sides.
  std::size_t nearest(const Vec3& p) const;
  // World units.
  double length(int direction) const {
    return direction < kLongDirections ? spacing_ : 0.8660254037844386 * spacing_;
  }

 private:
  Vec3 origin_;
  double spacing_ = 1;
  std::array<int, 3> size_{};
  std::size_t cells_ = 0;
  std::array<std::array<std::ptrdiff_t, kDirections>, 2> offsets_{};
};

// The twelve tetrahedra of cell c: right-handed, corners 0 and 1 in the first lattice, 2 and 3 in
// the second.
struct BccTetrahedron {
  std::array<std::ptrdiff_t, 4> offset;         // of the corners' nodes from c
  std::array<std::array<int, 3>, 4> place;      // of the corners, half spacings from node c
  std::array<std::array<int, 4>, 4> direction;  // from corner to corner
};
std::array<BccTetrahedron, 12> bccTetrahedra(const BccLattice& lattice);

// The sphere of neighbours about a node: for each set of directions whether it hangs together, and
// the neighbours of each direction, in order around it.
struct BccLink {
  static const BccLink& get();
  std::vector<bool> connected;  // of 2^14 sets; the empty one is not
  std::array<std::vector<int>, kDirections> around;
};

}  // namespace innermap
