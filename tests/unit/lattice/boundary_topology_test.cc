#include <gtest/gtest.h>

#include "innermap/lattice/outer_surface.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

BoundaryTopology of(const Mesh& mesh) { return boundaryTopology(mesh.vertices, mesh.triangles); }

TEST(BoundaryTopology, CountsComponentsCavitiesAndHandles) {
  const BoundaryTopology ball = of(shapes::icosphere(2));
  EXPECT_TRUE(ball.manifold());
  EXPECT_TRUE((ball.solid == SolidTopology{1, 0, 0}));
  const BoundaryTopology ring = of(shapes::torus(12, 8));
  EXPECT_TRUE((ring.solid == SolidTopology{1, 0, 1}));
  EXPECT_EQ(describe(ring.solid), "1 component, 0 cavities, 1 handle");
  const BoundaryTopology all = of(shapes::joined(
      shapes::joined(shapes::icosphere(2), shapes::flipped(shapes::icosphere(1, 0.5))),
      shapes::torus(12, 8, 5, 1)));
  EXPECT_TRUE((all.solid == SolidTopology{2, 1, 1}));
  EXPECT_TRUE((of({}).solid == SolidTopology{}));
}

TEST(BoundaryTopology, FindsWhatIsNotManifold) {
  Mesh open = shapes::icosphere(1);
  open.triangles.pop_back();
  EXPECT_EQ(of(open).openEdges, 3u);
  Mesh twisted = shapes::icosphere(1);
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  EXPECT_EQ(of(twisted).nonManifoldEdges, 3u);
  // Two tetrahedra that touch in a vertex, and in an edge.
  Mesh touching;
  touching.vertices.resize(7);
  touching.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2},
                        {0, 5, 4}, {0, 4, 6}, {4, 5, 6}, {0, 6, 5}};
  const BoundaryTopology t = of(touching);
  EXPECT_EQ(t.nonManifoldVertices, 1u);
  EXPECT_EQ(t.nonManifoldEdges, 0u);
  EXPECT_TRUE((t.solid == SolidTopology{2, 0, 0}));
  for (Triangle& f : touching.triangles)
    for (int& v : f) v = v == 4 ? 1 : v;
  EXPECT_GT(of(touching).nonManifoldEdges, 0u);
  EXPECT_FALSE(of(touching).manifold());
}

TEST(BoundaryTopology, OfASolidWhereItsSurfaceTells) {
  const SurfaceTopology ring = surfaceTopology(Solid(shapes::torus(24, 12)));
  EXPECT_TRUE(ring.clean);
  EXPECT_EQ(ring.solid.handles, 1);
  Mesh open = shapes::icosphere(2);
  open.triangles.pop_back();
  EXPECT_FALSE(surfaceTopology(Solid(open)).clean);
  const Mesh overlapping = shapes::joined(shapes::icosphere(2), shapes::icosphere(2, 1, {1, 0, 0}));
  EXPECT_FALSE(surfaceTopology(Solid(overlapping)).clean);
  // Vertices that a file doubled, along a seam, are one.
  Mesh seam = shapes::icosphere(2);
  const int doubled = static_cast<int>(seam.vertices.size());
  seam.vertices.push_back(seam.vertices[seam.triangles[0][0]]);
  seam.triangles[0][0] = doubled;
  const SurfaceTopology s = surfaceTopology(Solid(seam));
  EXPECT_TRUE(s.clean);
  EXPECT_TRUE((s.solid == SolidTopology{1, 0, 0}));
}

}  // namespace
}  // namespace innermap
