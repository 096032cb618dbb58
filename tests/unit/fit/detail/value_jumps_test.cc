#include "fit/detail/value_jumps.h"

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace innermap {
namespace {

// Two boxes, one stuck into the other's face.
Mesh boxes() {
  return shapes::joined(shapes::box({-1, -1, -1}, {1, 1, 1}),
                        shapes::box({-0.4, -0.3, 0.5}, {0.4, 0.3, 2}));
}

TEST(ValueJumps, LieWhereOnePartLeavesTheOtherAndAreAsLargeAsItSlides) {
  const Mesh mesh = boxes();
  const Solid solid(mesh);
  Points moved = solid.repaired().mesh.vertices;
  for (std::size_t v = moved.size() / 2; v < moved.size(); ++v) moved[v] += Vec3{0.03, 0.04, 0};
  const std::vector<ValueJump> jumps = CrossingLines(solid).jumps(solid, moved, 0.049);
  Box3 box;
  for (const ValueJump& jump : jumps) {
    EXPECT_NEAR(jump.size, 0.05, 1e-12);
    EXPECT_NEAR(jump.place.z, 1, 1e-12);
    const double x = std::abs(jump.place.x) / 0.4, y = std::abs(jump.place.y) / 0.3;
    EXPECT_NEAR(std::max(x, y), 1, 1e-12);
    box.add(jump.place);
  }
  // All the way round, without gaps.
  EXPECT_NEAR(box.extent().x, 0.8, 1e-12);
  EXPECT_NEAR(box.extent().y, 0.6, 1e-12);
  EXPECT_GE(jumps.size(), static_cast<std::size_t>(2.8 / (solid.diagonal() / 500)));
  EXPECT_TRUE(CrossingLines(solid).jumps(solid, moved, 0.051).empty());
}

TEST(ValueJumps, NoneWherePartsMoveTogetherOrNothingOverlaps) {
  const Mesh mesh = boxes();
  const Solid solid(mesh);
  Points moved = solid.repaired().mesh.vertices;
  for (Vec3& p : moved) p = {p.x + 0.3 * p.y, 2 * p.y - p.z, p.z + 5};
  EXPECT_TRUE(CrossingLines(solid).jumps(solid, moved, 1e-9).empty());
  const Solid box(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_TRUE(CrossingLines(box).jumps(box, box.repaired().mesh.vertices, 0).empty());
}

}  // namespace
}  // namespace innermap
