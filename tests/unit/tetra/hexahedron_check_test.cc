#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap {
namespace {

constexpr int kCorner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr Hexahedron kCell = {0, 1, 2, 3, 4, 5, 6, 7};

Points cube(double size = 1) {
  Points points;
  for (const auto& c : kCorner) points.push_back({size * c[0], size * c[1], size * c[2]});
  return points;
}

// A cube whose corners moved by up to `far` along each axis.
Points shaken(std::uint64_t seed, double far) {
  const CounterRandom random(seed, 0);
  Points points = cube();
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t a = 0; a < 3; ++a)
      points[i][static_cast<int>(a)] += far * (2 * random.uniform(3 * i + a) - 1);
  return points;
}

// By the shape functions' derivatives.
double determinantAt(const Points& p, const Vec3& x) {
  Mat3 j{};
  for (int i = 0; i < 8; ++i) {
    Vec3 f, d;
    for (int a = 0; a < 3; ++a) {
      f[a] = kCorner[i][a] ? x[a] : 1 - x[a];
      d[a] = kCorner[i][a] ? 1 : -1;
    }
    const Vec3 slope{d.x * f.y * f.z, f.x * d.y * f.z, f.x * f.y * d.z};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c)
        j[r][c] += p[static_cast<std::size_t>(i)][static_cast<int>(r)] * slope[static_cast<int>(c)];
  }
  return determinant(j);
}

double leastSampled(const Points& p, int steps = 16) {
  double least = 1e300;
  for (int z = 0; z <= steps; ++z)
    for (int y = 0; y <= steps; ++y)
      for (int x = 0; x <= steps; ++x)
        least = std::min(
            least, determinantAt(p, {x / double(steps), y / double(steps), z / double(steps)}));
  return least;
}

TEST(HexahedronCheck, CubeHasItsVolumeEverywhere) {
  const JacobianBounds bounds = leastJacobian(cube(2), kCell);
  EXPECT_NEAR(bounds.lower, 8, 1e-12);
  EXPECT_NEAR(bounds.upper, 8, 1e-12);
  EXPECT_TRUE(bounds.proven());
}

// Against dense sampling. Among the shaken cubes are some that no corner tells to be inverted.
TEST(HexahedronCheckRelease, BoundsHoldAndDecide) {
  int proven = 0, hidden = 0, undecided = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const Points p = shaken(seed, 0.6);
    const JacobianBounds bounds = leastJacobian(p, kCell);
    const double least = leastSampled(p);
    ASSERT_LE(bounds.lower, least + 1e-12) << seed;
    ASSERT_LE(bounds.lower, bounds.upper) << seed;
    if (bounds.proven()) ++proven;
    if (least <= 0) {
      ASSERT_FALSE(bounds.proven()) << seed;
    }
    if (bounds.inverted()) {
      ASSERT_LE(least, 0.02) << seed;  // between the samples, perhaps
    }
    if (!bounds.proven() && !bounds.inverted()) ++undecided;
    bool corners = true;
    for (const Tetrahedron& t : cornerTetrahedra(kCell)) corners &= signedVolume(p, t) > 0;
    if (corners && bounds.inverted()) ++hidden;
  }
  EXPECT_GT(proven, 500);
  EXPECT_GT(hidden, 5);
  EXPECT_LT(undecided, 10);
}

__extension__ using Wide = __int128;
using Whole = std::array<std::array<std::int64_t, 3>, 8>;

// Eight times the determinant at half coordinates 0, 1, 2, exact for whole numbers below 2^34.
Wide wholeDeterminant(const Whole& p, const std::array<int, 3>& x) {
  std::array<std::array<Wide, 3>, 3> j{};
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      Wide slope = kCorner[i][c] ? 1 : -1;
      for (std::size_t a = 0; a < 3; ++a)
        if (a != c) slope *= kCorner[i][a] ? x[a] : 2 - x[a];
      for (std::size_t r = 0; r < 3; ++r) j[r][c] += slope * p[i][r];
    }
  Wide sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
    sum += j[0][k] * (j[1][l] * j[2][m] - j[1][m] * j[2][l]);
  }
  return sum;
}

// A hexahedron whose edges are nearly multiples of one, so that its determinants are about as large
// as their rounding where it is large, and much larger where it is small.
Whole nearlyFlat(std::uint64_t seed, std::int64_t offset) {
  const CounterRandom random(seed, 3);
  const double extent = std::pow(2, 4 + 26 * random.uniform(60));
  const std::int64_t third = random.uniform(61) < 0.5 ? -1 : 1;
  Whole p{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t edge = std::llround(extent * (2 * random.uniform(k) - 1));
    const auto near = [&](std::size_t i, double far) {
      return std::llround(far * (2 * random.uniform(i + k) - 1));
    };
    const std::array<std::int64_t, 3> axes{edge + near(3, 4), 2 * edge + near(6, 20),
                                           third * edge + near(12, 20)};
    for (std::size_t i = 0; i < 8; ++i) {
      p[i][k] = offset + near(20 + 3 * i, 1);
      for (std::size_t c = 0; c < 3; ++c) p[i][k] += kCorner[i][c] * axes[c];
    }
  }
  return p;
}

// At scales from 1e-9 to 1e9 and far offsets: whatever is said is so of whole numbers, whose
// determinants are exact at corners, middles of edges and faces, and the centre.
TEST(HexahedronCheckRelease, NothingIsProvenByRounding) {
  int wrong = 0, proven = 0, inverted = 0, undecided = 0;
  for (const int power : {-56, -20, 0, 6})
    for (const std::int64_t offset : {std::int64_t(0), std::int64_t(1) << 33})
      for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        const Whole whole = nearlyFlat(seed, offset);
        Points p(8);
        for (std::size_t i = 0; i < 8; ++i)
          for (std::size_t k = 0; k < 3; ++k)
            p[i][static_cast<int>(k)] = std::ldexp(static_cast<double>(whole[i][k]), power);
        const JacobianBounds bounds = leastJacobian(p, kCell);
        bool corner = false, anywhere = false;
        for (int i = 0; i < 27; ++i) {
          const std::array<int, 3> x{i % 3, i / 3 % 3, i / 9};
          const bool bad = wholeDeterminant(whole, x) <= 0;
          anywhere = anywhere || bad;
          corner = corner || (bad && x[0] != 1 && x[1] != 1 && x[2] != 1);
        }
        const auto where = [&] {
          return "seed " + std::to_string(seed) + " power " + std::to_string(power) + " offset " +
                 std::to_string(offset);
        };
        if (anywhere) {
          ASSERT_FALSE(bounds.proven()) << where();
        }
        if (corner) {
          ASSERT_TRUE(bounds.inverted()) << where();
        }
        ASSERT_FALSE(bounds.proven() && bounds.inverted()) << where();
        bool rounded = false;
        for (const Tetrahedron& t : cornerTetrahedra(kCell)) rounded |= !(signedVolume(p, t) > 0);
        wrong += rounded != corner;
        proven += bounds.proven();
        inverted += bounds.inverted();
        undecided += !bounds.proven() && !bounds.inverted();
      }
  EXPECT_GT(wrong, 20);
  EXPECT_GT(proven, 500);
  EXPECT_GT(inverted, 500);
  std::printf("%d proven, %d inverted, %d undecided; %d by plain sums wrong at a corner\n", proven,
              inverted, undecided, wrong);
}

// Positive at all corners, negative inside.
TEST(HexahedronCheckRelease, PositiveCornersDoNotProveACell) {
  const auto leastCorner = [](const Points& p) {
    double least = 1e300;
    for (const Tetrahedron& t : cornerTetrahedra(kCell))
      least = std::min(least, 6 * signedVolume(p, t));
    return least;
  };
  int found = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const Points p = shaken(seed, 0.6);
    if (!(leastCorner(p) > 0.02) || !(leastSampled(p, 4) < -1e-3)) continue;
    ++found;
    for (const double scale : {1e-9, 1.0, 1e9}) {
      Points q = p;
      for (Vec3& v : q) v = scale * (v + Vec3{5, -3, 2});
      EXPECT_TRUE(leastJacobian(q, kCell).inverted()) << "seed " << seed << " scale " << scale;
    }
  }
  EXPECT_GT(found, 0);
}

TEST(HexahedronCheck, FlatCellsEndAtOnce) {
  Points p = cube();
  for (Vec3& v : p) v.z = 0.1 * v.x + 0.3 * v.y;
  EXPECT_TRUE(leastJacobian(p, kCell, 10).inverted());
  for (Vec3& v : p) v = 1e200 * v;
  EXPECT_FALSE(leastJacobian(p, kCell).proven());
}

TEST(HexahedronCheck, CountsWhatIsWrong) {
  CellMesh mesh{.vertices = cube()};
  const Points moved = cube();
  for (const Vec3& v : moved) mesh.vertices.push_back(v);
  std::swap(mesh.vertices[8], mesh.vertices[14]);
  mesh.hexahedra = {kCell, {8, 9, 10, 11, 12, 13, 14, 15}};
  const HexahedronCheck check = checkHexahedra(mesh);
  EXPECT_EQ(check.inverted, 1u);
  EXPECT_EQ(check.invertedCorners, 1u);
  EXPECT_FALSE(check.proven());
  EXPECT_THROW(checkHexahedra(mesh, {.halvings = 11}), SettingError);
}

}  // namespace
}  // namespace innermap
