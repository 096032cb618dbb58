#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "innermap/tetra/cells.h"
#include "lattice/detail/lattice_topology.h"
#include "lattice/fit_boundary.h"
#include "lattice/sharp_edges.h"
#include "lattice/stuffing.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(BccLattice, NeighboursAreWhereTheirDirectionsSay) {
  const BccLattice lattice({1, 2, 3}, 0.5, {7, 8, 9});
  const std::size_t middle = 3 + 7 * (3 + 8 * 3);
  for (const std::size_t node : {middle, lattice.cells() + middle})
    for (int d = 0; d < kDirections; ++d) {
      const std::size_t other = lattice.neighbour(node, d);
      const Vec3 way = lattice.position(other) - lattice.position(node);
      for (int a = 0; a < 3; ++a) EXPECT_NEAR(way[a], 0.25 * kSteps[d][a], 1e-12);
      EXPECT_NEAR(norm(way), lattice.length(d), 1e-12);
      EXPECT_EQ(lattice.neighbour(other, d ^ 1), node);
    }
}

TEST(BccLattice, TwelveTetrahedraFillACell) {
  const BccLattice lattice({0, 0, 0}, 1, {7, 7, 7});
  const std::size_t node = 3 + 7 * (3 + 7 * 3);
  double volume = 0;
  for (const BccTetrahedron& t : bccTetrahedra(lattice)) {
    Points p;
    for (const std::ptrdiff_t offset : t.offset)
      p.push_back(lattice.position(node + static_cast<std::size_t>(offset)));
    EXPECT_NEAR(signedVolume(p, {0, 1, 2, 3}), 1.0 / 12, 1e-12);
    EXPECT_NEAR(dihedralRange(p, {0, 1, 2, 3}).least, 60, 1e-9);
    volume += signedVolume(p, {0, 1, 2, 3});
  }
  EXPECT_NEAR(volume, 1, 1e-12);
}

TEST(BccLattice, TheLinkIsASphere) {
  const BccLink& link = BccLink::get();
  std::size_t edges = 0;
  for (const auto& ring : link.around) edges += ring.size();
  EXPECT_EQ(edges / 2, 36u);  // 14 - 36 + 24 = 2
  EXPECT_FALSE(link.connected[0]);
  EXPECT_TRUE(link.connected[(1 << 14) - 1]);
  EXPECT_FALSE(link.connected[1 << 0 | 1 << 1]);
}

// A lattice whose nodes are inside at random, but for its sides.
LatticeSigns randomSigns(std::uint64_t seed, double share) {
  LatticeSigns signs{.lattice = BccLattice({0, 0, 0}, 1, {12, 12, 12})};
  const CounterRandom random(seed, 1);
  const std::size_t nodes = signs.lattice.nodes();
  signs.distance.resize(nodes);
  signs.side.assign(nodes, NodeSide::outside);
  signs.onEdge.assign(nodes, -1);
  for (std::size_t n = 0; n < nodes; ++n) {
    const Vec3 p = signs.lattice.position(n);
    const bool within = std::min({p.x, p.y, p.z}) > 2.4 && std::max({p.x, p.y, p.z}) < 9.1;
    const bool inside = within && random.uniform(2 * n) < share;
    const double size = 0.01 + random.uniform(2 * n + 1);
    signs.distance[n] = static_cast<float>(inside ? -size : size);
    if (inside) signs.side[n] = NodeSide::inside;
  }
  return signs;
}

// The worst that can be: no two nodes agree. Warped or not, the cells' boundary is a manifold with
// the topology that the nodes have, and no angle is poor.
TEST(Stuffing, AnySignsGiveAManifoldOfTheirTopology) {
  for (std::uint64_t seed = 1; seed <= 48; ++seed) {
    LatticeSigns signs = randomSigns(seed, 0.1 + 0.05 * static_cast<double>(seed % 16));
    const SolidTopology wanted = latticeTopology(signs);
    for (const bool warp : {false, true}) {
      if (warp) warpNodes(signs);
      StuffedMesh mesh = stuffed(signs);
      holdWarped(mesh);
      const BoundaryTopology made = boundaryTopology(mesh.vertices, boundaryOf(mesh));
      EXPECT_TRUE(made.manifold()) << seed;
      EXPECT_TRUE(made.solid == wanted)
          << describe(made.solid) << " instead of " << describe(wanted);
      for (const Tetrahedron& t : mesh.tetrahedra) {
        const DihedralRange range = dihedralRange(mesh.vertices, t);
        EXPECT_GE(range.least, 10);
        EXPECT_LE(range.greatest, 165);
      }
    }
  }
}

TEST(SharpEdges, CurvesAndCorners) {
  const SharpEdges cube = sharpEdges(shapes::box({0, 0, 0}, {1, 1, 1}), 30);
  EXPECT_EQ(cube.corners.size(), 8u);
  EXPECT_EQ(cube.curves.size(), 12u);
  for (const SharpCurve& c : cube.curves) EXPECT_NEAR(c.length, 1, 1e-12);
  EXPECT_TRUE(sharpEdges(shapes::icosphere(3), 30).curves.empty());
  // A cylinder: two closed curves, no corner.
  Mesh mesh;
  const int n = 24;
  for (const double z : {0.0, 1.0})
    for (int i = 0; i < n; ++i)
      mesh.vertices.push_back(
          {std::cos(i * 2 * 3.14159265 / n), std::sin(i * 2 * 3.14159265 / n), z});
  mesh.vertices.push_back({0, 0, 0});
  mesh.vertices.push_back({0, 0, 1});
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.push_back({i, j, j + n});
    mesh.triangles.push_back({i, j + n, i + n});
    mesh.triangles.push_back({j, i, 2 * n});
    mesh.triangles.push_back({i + n, j + n, 2 * n + 1});
  }
  const SharpEdges cylinder = sharpEdges(mesh, 30);
  EXPECT_TRUE(cylinder.corners.empty());
  ASSERT_EQ(cylinder.curves.size(), 2u);
  for (const SharpCurve& c : cylinder.curves) {
    EXPECT_EQ(c.points.size(), static_cast<std::size_t>(n) + 1);
    EXPECT_EQ(c.corners[0], -1);
    EXPECT_NEAR(norm(c.points.front() - c.points.back()), 0, 1e-15);
  }
}

}  // namespace
}  // namespace innermap
