#include <gtest/gtest.h>

#include "innermap/lattice/outer_surface.h"
#include "lattice/stuffing.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(StuffingNeed, IsAboveWhatIsMadeAndNear) {
  for (const Mesh& mesh : {shapes::icosphere(4), shapes::torus(60, 30)})
    for (const double spacing : {0.1, 0.05}) {
      const Solid solid(mesh);
      const StuffingNeed need = stuffingNeed(solid, spacing);
      LatticeSigns signs = latticeSigns(solid, spacing);
      warpNodes(signs);
      const StuffedMesh made = stuffed(signs);
      EXPECT_GE(need.tetrahedra, made.tetrahedra.size());
      EXPECT_LE(need.tetrahedra, 1.3 * static_cast<double>(made.tetrahedra.size()));
      EXPECT_GE(need.vertices, made.vertices.size());
      EXPECT_GT(need.memory, made.tetrahedra.size() * sizeof(Tetrahedron));
    }
}

}  // namespace
}  // namespace innermap
