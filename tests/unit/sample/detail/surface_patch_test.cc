#include "sample/detail/surface_patch.h"

#include <gtest/gtest.h>

#include "core/pi.h"
#include "core/random.h"

namespace innermap {
namespace {

// Two triangles.
Mesh unitSquare() {
  return {.name = "square",
          .vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
          .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

std::vector<Vec3> samplesOf(const SurfacePatch& patch, const Mesh& mesh, std::size_t count,
                            std::uint64_t seed) {
  const CounterRandom random(seed, 1);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back(positionOf(mesh, patch.sample(random.uniform(3 * i), random.uniform(3 * i + 1),
                                                random.uniform(3 * i + 2))));
  return out;
}

TEST(SurfacePatch, IsLittleMoreThanWhatIsWithinReach) {
  const Mesh square = unitSquare();
  constexpr double kReach = 0.1, kFine = 0.01;
  const Points marks{{0.3, 0.6, 0}, {0.8, 0.2, 0.06}};
  const SurfacePatch patch(square, marks, kReach, kFine);
  // The second mark stands off the square: within 0.08 of its foot is within reach. The parts'
  // boxes may be as wide as kFine, and reach out by half of that and as much again.
  const auto discs = [](double more) {
    return kPi * ((kReach + more) * (kReach + more) + (0.08 + more) * (0.08 + more));
  };
  EXPECT_GE(0.5 * patch.area(), discs(0));
  EXPECT_LE(0.5 * patch.area(), discs(2 * kFine));
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::size_t within = 0;
    for (const Vec3& p : samplesOf(patch, square, 1000, seed)) {
      EXPECT_LT(std::min(norm(p - marks[0]), norm(p - marks[1])), kReach + 2 * kFine);
      EXPECT_EQ(patch.holds(p), std::min(norm(p - marks[0]), norm(p - marks[1])) < kReach);
      within += patch.holds(p);
    }
    // Uniform by area: 1000 trials with that chance, four standard deviations.
    const double chance = discs(0) / (0.5 * patch.area());
    EXPECT_NEAR(static_cast<double>(within), 1000 * chance,
                4 * std::sqrt(1000 * chance * (1 - chance)) + 1);
  }
}

TEST(SurfacePatch, WithoutMarksIsTheSurface) {
  const Mesh square = unitSquare();
  const SurfacePatch patch(square, {}, 0.1, 0.01);
  EXPECT_NEAR(0.5 * patch.area(), 1, 1e-12);
  EXPECT_TRUE(patch.holds({5, 5, 5}));
  Vec3 sum{};
  constexpr std::size_t kCount = 10000;
  for (const Vec3& p : samplesOf(patch, square, kCount, 7)) sum = sum + p;
  // Uniform on an edge of 1: variance 1/12, four standard deviations.
  const double error = 4 * std::sqrt(1.0 / 12 / kCount);
  EXPECT_NEAR(sum.x / kCount, 0.5, error);
  EXPECT_NEAR(sum.y / kCount, 0.5, error);
  // In the order of the triangles.
  EXPECT_EQ(patch.sample(0, 0.5, 0.5).triangle, 0);
  EXPECT_EQ(patch.sample(0.999, 0.5, 0.5).triangle, 1);
}

TEST(SurfacePatch, OutOfReachIsEmpty) {
  EXPECT_EQ(SurfacePatch(unitSquare(), {{0.5, 0.5, 3}}, 0.1, 0.01).area(), 0);
}

}  // namespace
}  // namespace innermap
