#include "lattice/detail/grow_solid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lattice/detail/lattice_topology.h"

namespace innermap {
namespace {

struct Ring {
  LatticeSigns signs;
  std::vector<float> order;
};

// A ring with a thick disc at one place of it, whose middle comes last of all: what is left of the
// disc without it has a handle, so that no core is without one. `sheet`: the ring is cut across by
// a buried sheet.
Ring ringWithDisc(bool sheet) {
  Ring out;
  out.signs.lattice = BccLattice({-20, -20, -5}, 1, {40, 40, 10});
  const std::size_t nodes = out.signs.lattice.nodes();
  out.signs.distance.assign(nodes, 1);
  out.signs.onEdge.assign(nodes, -1);
  for (std::size_t n = 0; n < nodes; ++n) {
    const Vec3 p = out.signs.lattice.position(n);
    const double fromRing = std::hypot(std::hypot(p.x, p.y) - 12, p.z),
                 fromDisc = std::hypot(p.x + 12, p.y);
    const bool inside = fromRing < 2.5 || (fromDisc < 5 && std::abs(p.z) < 2);
    out.signs.side.push_back(inside ? NodeSide::inside : NodeSide::outside);
    out.order.push_back(fromDisc < 2 ? -2 : sheet && p.x > 0 && std::abs(p.y) < 1 ? -1 : 5);
  }
  return out;
}

TEST(GrowSolid, CutsAtSheetsWhereEveryCoreHasAHandle) {
  Ring ring = ringWithDisc(true);
  const Sides part = ring.signs.side;
  ASSERT_TRUE(growWithHandles(ring.signs, part, 0, ring.order));
  EXPECT_EQ(latticeTopology(ring.signs), (SolidTopology{1, 0, 0}));
  for (std::size_t n = 0; n < part.size(); ++n)
    EXPECT_TRUE(ring.signs.side[n] == part[n] || ring.signs.lattice.position(n).x > 0) << n;
}

TEST(GrowSolid, CutsNoHandleOfTheSolid) {
  Ring ring = ringWithDisc(false);
  const Sides part = ring.signs.side;
  EXPECT_FALSE(growWithHandles(ring.signs, part, 0, ring.order));
  EXPECT_EQ(ring.signs.side, part);
}

}  // namespace
}  // namespace innermap
