#include "core/orientation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "core/random.h"

namespace innermap {
namespace {

__extension__ using Wide = __int128;
using Whole = std::array<std::int64_t, 3>;

Sign signOf(Wide x) { return x > 0 ? Sign::positive : x < 0 ? Sign::negative : Sign::zero; }

// Of whole numbers below 2^38: exact.
Sign reference(const std::array<Whole, 4>& p) {
  const auto edge = [&](std::size_t i, std::size_t k) { return Wide(p[i][k]) - p[0][k]; };
  Wide sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
    sum += edge(1, k) * (edge(2, l) * edge(3, m) - edge(2, m) * edge(3, l));
  }
  return signOf(sum);
}

// Points near a line, `offset` from the origin, so that their determinant is about as large as its
// rounding: edges are small multiples of the first, but for up to 2 in each coordinate.
std::array<Whole, 4> nearlyFlat(std::uint64_t seed, double extent, std::int64_t offset) {
  const CounterRandom random(seed, 0);
  std::array<Whole, 4> p{};
  for (std::size_t k = 0; k < 3; ++k) {
    p[0][k] = offset + std::llround(extent * random.uniform(k));
    const std::int64_t edge = std::llround(extent * random.uniform(3 + k));
    const auto near = [&](std::size_t i) { return std::llround(4 * random.uniform(i + k) - 2); };
    p[1][k] = p[0][k] + edge;
    p[2][k] = p[0][k] + 2 * edge + near(6);
    p[3][k] = p[0][k] + (random.uniform(12) < 0.5 ? -edge : 3 * edge) + near(9);
  }
  return p;
}

Vec3 scaled(const Whole& p, double scale) {
  return {scale * static_cast<double>(p[0]), scale * static_cast<double>(p[1]),
          scale * static_cast<double>(p[2])};
}

Sign rounded(const std::array<Vec3, 4>& p) {
  const double det = dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]));
  return det > 0 ? Sign::positive : det < 0 ? Sign::negative : Sign::zero;
}

// Whole numbers times a power of two, so that the reference knows them: from 1e-9 to 1e9 in size.
TEST(OrientationRelease, AgreesWithWholeNumbersWhereRoundingDoesNot) {
  std::uint64_t wrong = 0, exact = 0, count = 0;
  for (const int power : {-66, -38, 0, 30})
    for (const std::int64_t offset : {std::int64_t(0), std::int64_t(1) << 36})
      for (const double extent : {3e3, 1e7, 1e10})
        for (std::uint64_t seed = 0; seed < 2000; ++seed) {
          const std::array<Whole, 4> whole = nearlyFlat(seed, extent, offset);
          std::array<Vec3, 4> p;
          for (std::size_t i = 0; i < 4; ++i) p[i] = scaled(whole[i], std::ldexp(1.0, power));
          const Sign wanted = reference(whole);
          ASSERT_EQ(orientation(p[0], p[1], p[2], p[3], exact), wanted)
              << "seed " << seed << " power " << power << " offset " << offset << " extent "
              << extent;
          ASSERT_EQ(orientation(p[1], p[0], p[2], p[3], exact), opposite(wanted))
              << "seed " << seed;
          wrong += rounded(p) != wanted;
          ++count;
        }
  EXPECT_GT(wrong, 500u);  // of plain sums
  EXPECT_LT(exact, 2 * count);
  std::printf("of %d signs %d are wrong by plain sums\n", static_cast<int>(count),
              static_cast<int>(wrong));
}

// Where floats are far from each other in size the terms are many.
TEST(OrientationRelease, IsAntisymmetricWhateverTheNumbers) {
  std::uint64_t exact = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const CounterRandom random(seed, 1);
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        p[i][k] = (random.uniform(6 * i + static_cast<std::size_t>(k)) - 0.5) *
                  std::pow(10, 18 * random.uniform(40 + 3 * i + static_cast<std::size_t>(k)) - 9);
    p[3] = p[0] + random.uniform(60) * (p[1] - p[0]) + random.uniform(61) * (p[2] - p[0]);
    const Sign s = orientation(p[0], p[1], p[2], p[3], exact);
    ASSERT_NE(s, Sign::undecided) << "seed " << seed;
    ASSERT_EQ(orientation(p[1], p[2], p[0], p[3], exact), s) << "seed " << seed;
    ASSERT_EQ(orientation(p[3], p[2], p[1], p[0], exact), s) << "seed " << seed;
    ASSERT_EQ(orientation(p[2], p[1], p[0], p[3], exact), opposite(s)) << "seed " << seed;
    for (Vec3& v : p) v = 0x1.0p-100 * v;
    ASSERT_EQ(orientation(p[0], p[1], p[2], p[3], exact), s) << "seed " << seed;
  }
  EXPECT_GT(exact, 10000u);
}

TEST(Orientation, SmallestAndLargestNumbers) {
  std::uint64_t exact = 0;
  for (const double size : {5e-324, 1e-310, 1e-120, 1.0, 1e120, 1e307}) {
    const auto at = [&](double x, double y, double z) { return size * Vec3{x, y, z}; };
    EXPECT_EQ(orientation(at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(0, 0, 1), exact),
              Sign::positive)
        << size;
    EXPECT_EQ(orientation(at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(3, 5, 0), exact), Sign::zero)
        << size;
  }
  EXPECT_EQ(orientation({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, exact), Sign::zero);
}

TEST(Orientation, WhatIsNotDecidedIsNamed) {
  std::uint64_t exact = 0;
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, none}, exact), Sign::undecided);
  EXPECT_EQ(orientation({0, 0, 0}, {1, 3, 1e-120}, {2, 6, 1e-120}, {3, 9, 0}, exact),
            Sign::undecided);
  EXPECT_EQ(orientation({0, 0, 0}, {1, 3, 1e-80}, {2, 6, 1e-80}, {3, 9, 0}, exact), Sign::zero);
}

TEST(Orientation, TurnsInEachPlane) {
  std::uint64_t exact = 0;
  EXPECT_EQ(turn({0, 0, 7}, {1, 0, 8}, {0, 1, -9}, 2, exact), Sign::positive);
  EXPECT_EQ(turn({7, 0, 0}, {8, 1, 0}, {-9, 0, 1}, 0, exact), Sign::positive);
  EXPECT_EQ(turn({0, 7, 0}, {0, 8, 1}, {1, -9, 0}, 1, exact), Sign::positive);
  EXPECT_EQ(turn({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 2, exact), Sign::negative);
  EXPECT_EQ(turn({0, 0, 1e16}, {1, 1, 1e16}, {2, 2, 1e16}, 2, exact), Sign::zero);
  EXPECT_EQ(turn({0, 0, 1e300}, {1, 1, 1e300}, {2, 3, 1e300}, 2, exact), Sign::undecided);
}

}  // namespace
}  // namespace innermap
