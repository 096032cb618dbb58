#include "transfer/detail/step_by_step.h"

#include <gtest/gtest.h>

#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

// Three steps of a strong twist, (x, y) turned by z, and one of charges.
ComposedMap twisted() {
  const HarmonicMap twist = fittedMap([](const Vec3& p) {
    return Vec3{p.x - 0.7 * p.y * p.z, p.y + 0.7 * p.x * p.z, p.z};
  });
  const HarmonicMap smaller = affineMap({{{0.8, 0, 0}, {0, 0.8, 0}, {0, 0, 1}}}, {});
  return ComposedMap({twist, smaller, twist, smaller, twist, smaller, chargedMap(0.2)});
}

TEST(StepByStep, InvertsFromFarAway) {
  const std::uint64_t seed = 30;
  SCOPED_TRACE(seed);
  Draws draw(seed);
  const ComposedMap map = twisted();
  Points sources, targets, starts;
  while (sources.size() < 200) {
    const auto inCube = [&] { return Vec3{2 * draw() - 1, 2 * draw() - 1, 2 * draw() - 1}; };
    const Vec3 p = inCube(), start = p + 0.3 * inCube();
    if (norm(p) > 0.6 || norm(start) > 0.9) continue;
    sources.push_back(p);
    targets.push_back(map(p));
    starts.push_back(start);
  }
  const Points found = invertStepByStep(map, targets, starts, {.tolerance = 1e-10});
  for (std::size_t i = 0; i < sources.size(); ++i)
    EXPECT_LT(norm(found[i] - sources[i]), 1e-7) << i;
}

TEST(StepByStep, KeepsTheStartWhereThereIsNoSource) {
  const HarmonicMap flat = affineMap({{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}}, {});
  const Points found = invertStepByStep(ComposedMap({chargedMap(), flat}), {{0, 0, 1}},
                                        {{0.1, 0.2, 0.3}}, {.tolerance = 1e-6});
  EXPECT_EQ(norm(found.at(0) - Vec3{0.1, 0.2, 0.3}), 0);
}

}  // namespace
}  // namespace innermap
