#include "proof/detail/set_group.h"

#include <gtest/gtest.h>

#include "proof/maps.h"

namespace innermap::proof {
namespace {

using testing::Charge;

// Cubes of these half edges about these centres.
LaneSets cubes(const Points& centers, const std::vector<double>& halves) {
  constexpr int kSigns[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
  LaneSets out{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (int a = 0; a < 3; ++a) {
      out.center[a][lane] = centers[lane][a];
      for (int i = 0; i < 4; ++i) out.vertex[i][a][lane] = kSigns[i][a] * halves[lane];
    }
    out.radius[lane] = std::sqrt(3.0) * halves[lane];
  }
  return out;
}

struct RandomCubes {
  Points centers;
  std::vector<double> halves;
  RandomCubes(std::uint64_t seed, double spread, double half) {
    const CounterRandom random(seed, 21);
    for (std::size_t i = 0; i < kLanes; ++i) {
      centers.push_back({spread * (random.uniform(4 * i) - 0.5),
                         spread * (random.uniform(4 * i + 1) - 0.5),
                         spread * (random.uniform(4 * i + 2) - 0.5)});
      halves.push_back(half * (0.2 + random.uniform(4 * i + 3)));
    }
  }
};

// Corners, and random points.
Vec3 pointOf(const Vec3& center, double half, std::uint64_t number) {
  const CounterRandom random(number, 22);
  Vec3 out = center;
  for (int a = 0; a < 3; ++a) {
    const double t = number < 8 ? (number >> a & 1 ? 1.0 : -1.0) : 2 * random.uniform(a) - 1;
    out[a] += half * t;
  }
  return out;
}

// The spectral norm of B J(p) - 1, by powers of its Gram matrix.
double excessAt(const HarmonicMap& map, const Mat3& b, const Vec3& p) {
  Mat3 e = product(b, map.jacobian(p));
  for (int k = 0; k < 3; ++k) e[k][k] -= 1;
  const Mat3 gram = product(e, transposed(e));
  Vec3 v{0.3, 0.5, 0.8};
  double value = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 next = gram * v;
    value = norm(next) / norm(v);
    if (!(value > 0)) return 0;
    v = next / norm(next);
  }
  return std::sqrt(value);
}

struct Used {
  int bounded = 0;
  double most = 0;  // of the bound that was used at a sample
};

void checkExcess(const HarmonicMap& map, const RandomCubes& cubesAt, Used& used) {
  const StepTrees trees(map, 1);
  SetGroup group;
  group.compute(trees, cubes(cubesAt.centers, cubesAt.halves), 0xff, true);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (!(group.proven() >> lane & 1)) continue;
    ++used.bounded;
    const double bound = group.findings(0).excess[lane];
    const Mat3 b = inverse(map.jacobian(cubesAt.centers[lane]));
    for (std::uint64_t i = 0; i < 40; ++i) {
      const Vec3 p = pointOf(cubesAt.centers[lane], cubesAt.halves[lane], i);
      const double excess = excessAt(map, b, p);
      ASSERT_LE(excess, bound * (1 + 1e-9) + 1e-12);
      used.most = std::max(used.most, excess / bound);
      const double det = determinant(map.jacobian(p));
      ASSERT_GE(std::abs(det), group.findings(0).least[lane]);
      ASSERT_GT(det * group.findings(0).determinant[lane], 0);
    }
  }
}

TEST(SetGroup, BoundsWhatTheDerivativeDoesOnEachCube) {
  Used used;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    std::vector<Charge> charges = testing::chargesAbout(40, 1.2, 0.05, seed);
    const std::vector<Charge> more = testing::chargesAbout(400, 2, 0.03, seed + 100);
    charges.insert(charges.end(), more.begin(), more.end());
    const HarmonicMap map = testing::mapOf(testing::affineOf(testing::kIdentity), charges);
    checkExcess(map, RandomCubes(seed, 1.2, 0.2), used);
  }
  EXPECT_GT(used.bounded, 100);
  EXPECT_GT(used.most, 0.4);  // the bound is no wild guess
  EXPECT_LE(used.most, 1);
}

// Charges in one place, on the ray through a cube's corner.
HarmonicMap chargesTowards(const Vec3& corner, double distance, double strength,
                           std::size_t count) {
  const Vec3 way = corner / norm(corner);
  return testing::mapOf(testing::affineOf(testing::kIdentity),
                        std::vector<Charge>(count, {distance * way, strength * way}));
}

// A cube about the origin, in all lanes.
SetGroup groupOf(const HarmonicMap& map, double half) {
  SetGroup out;
  out.compute(StepTrees(map, 1), cubes(Points(8), std::vector<double>(8, half)), 0xff, true);
  return out;
}

// One charge: at the corner each term of the bound is reached, and what is cut off is a third of
// the whole.
TEST(SetGroup, BoundIsNearlyReachedTowardsOneCharge) {
  const Vec3 corner{1, 1, 1};
  for (const double ratio : {0.3, 0.5, 0.7, 0.78}) {
    const double half = 0.1, distance = std::sqrt(3.0) * half / ratio;
    // J changes by less than half all over the cube.
    const double room = distance * (1 - ratio);
    const double strength = 0.2 * room * room * room / distance;
    const HarmonicMap map = chargesTowards(corner, distance, strength, 1);
    const SetGroup group = groupOf(map, half);
    ASSERT_EQ(group.proven(), 0xff);
    const double bound = group.findings(0).excess[0];
    const double there = excessAt(map, inverse(map.jacobian({})), {half, half, half});
    EXPECT_LE(there, bound * (1 + 1e-9));
    EXPECT_GT(there, 0.75 * bound) << ratio;
    // So is the bound of what the map adds to its linear part.
    const Vec3 p{half, half, half};
    const double rest = norm(map(p) - map({}) - map.jacobian({}) * p);
    const double slack = group.findings(0).image.slack[0];
    EXPECT_LE(rest, slack * (1 + 1e-9));
    EXPECT_GT(rest, 0.75 * slack) << ratio;
  }
}

// Charges in one place are expanded about the group first. That expansion's last degree is not
// worth moving to the sets: 6e-4 of the bound, which is 2e-4 above what is reached.
TEST(SetGroup, BoundCountsTheDegreesThatAreNotMoved) {
  const double half = 0.1, distance = std::sqrt(3.0) * half / 0.3;
  const HarmonicMap map = chargesTowards({1, 1, 1}, distance, 0.002 * distance * distance, 32);
  const SetGroup group = groupOf(map, half);
  ASSERT_EQ(group.proven(), 0xff);
  const double bound = group.findings(0).excess[0];
  const double there = excessAt(map, inverse(map.jacobian({})), {half, half, half});
  EXPECT_LE(there, bound * (1 + 1e-9));
}

TEST(SetGroup, ImagesLieInTheirEnclosures) {
  int enclosed = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const HarmonicMap first =
        testing::mapOf(testing::affineOf({{{1, 0.2, 0}, {0, 0.8, 0.1}, {0, 0, 1.5}}}, {3, 0, 0}),
                       testing::chargesAbout(60, 1.3, 0.02, seed));
    std::vector<Charge> later = testing::chargesAbout(300, 2.5, 0.02, seed + 7);
    for (Charge& c : later) c.place = c.place + Vec3{3, 0, 0};
    const HarmonicMap second = testing::mapOf(testing::affineOf(testing::kIdentity), later);
    const ComposedMap map({first, second});
    const RandomCubes at(seed, 0.8, 0.1);
    const StepTrees trees(map, 0.5);
    RandomCubes scaled = at;
    for (Vec3& c : scaled.centers) c = 0.5 * c;
    for (double& h : scaled.halves) h *= 0.5;
    SetGroup group;
    group.compute(trees, cubes(scaled.centers, scaled.halves), 0xff, false);
    const LaneSets& image = group.findings(1).image;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (!(group.enclosed() >> lane & 1)) continue;
      ++enclosed;
      const Vec3 center{image.center[0][lane], image.center[1][lane], image.center[2][lane]};
      const Mat3 j = map.jacobian(at.centers[lane]);
      for (std::uint64_t i = 0; i < 40; ++i) {
        const Vec3 p = pointOf(at.centers[lane], at.halves[lane], i);
        ASSERT_LE(norm(0.5 * map(p) - center), image.radius[lane]);
        const Vec3 linear = 0.5 * (j * (p - at.centers[lane]));
        // The derivative at the centre's image is known up to the same slack.
        ASSERT_LE(norm(0.5 * map(p) - center - linear), 1.2 * image.slack[lane]);
      }
    }
  }
  EXPECT_GT(enclosed, 100);
}

}  // namespace
}  // namespace innermap::proof
