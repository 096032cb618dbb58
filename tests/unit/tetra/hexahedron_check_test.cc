#include <gtest/gtest.h>

#include <algorithm>

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

double leastSampled(const Points& p) {
  constexpr int kSteps = 16;
  double least = 1e300;
  for (int z = 0; z <= kSteps; ++z)
    for (int y = 0; y <= kSteps; ++y)
      for (int x = 0; x <= kSteps; ++x)
        least = std::min(
            least, determinantAt(p, {x / double(kSteps), y / double(kSteps), z / double(kSteps)}));
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

TEST(HexahedronCheck, CountsWhatIsWrong) {
  CellMesh mesh;
  mesh.vertices = cube();
  const Points moved = cube();
  for (const Vec3& v : moved) mesh.vertices.push_back(v);
  std::swap(mesh.vertices[8], mesh.vertices[14]);
  mesh.hexahedra = {kCell, {8, 9, 10, 11, 12, 13, 14, 15}};
  const HexahedronCheck check = checkHexahedra(mesh);
  EXPECT_EQ(check.inverted, 1u);
  EXPECT_EQ(check.invertedCorners, 1u);
  EXPECT_FALSE(check.proven());
  HexahedronCheckSettings settings;
  settings.halvings = 11;
  EXPECT_THROW(checkHexahedra(mesh, settings), SettingError);
}

}  // namespace
}  // namespace innermap
