#include "lattice/untangle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/expect.h"
#include "core/random.h"

namespace innermap {
namespace {

constexpr int kSide = 6;

int vertexAt(int x, int y, int z) { return (x * kSide + y) * kSide + z; }

bool onBorder(int x, int y, int z) {
  const int least = std::min({x, y, z}), most = std::max({x, y, z});
  return least == 0 || most == kSide - 1;
}

// A cube of unit cells in six tetrahedra each; the border is fixed.
TetPatch lattice() {
  constexpr std::array<std::array<int, 4>, 6> kTets{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  TetPatch patch;
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y)
      for (int z = 0; z < kSide; ++z) {
        patch.vertices.push_back(
            {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
        patch.free.push_back(!onBorder(x, y, z));
      }
  for (int x = 0; x + 1 < kSide; ++x)
    for (int y = 0; y + 1 < kSide; ++y)
      for (int z = 0; z + 1 < kSide; ++z)
        for (const auto& tet : kTets) {
          std::array<int, 4> corners{};
          for (std::size_t i = 0; i < 4; ++i)
            corners[i] = vertexAt(x + (tet[i] & 1), y + (tet[i] >> 1 & 1), z + (tet[i] >> 2 & 1));
          Mat3 edges{};
          for (std::size_t e = 0; e < 3; ++e)
            for (std::size_t r = 0; r < 3; ++r)
              edges[r][e] = (patch.vertices[corners[e + 1]] -
                             patch.vertices[corners[0]])[static_cast<int>(r)];
          patch.tets.push_back(corners);
          patch.rest.push_back(inverse(edges));
        }
  return patch;
}

double leastOf(const TetPatch& patch) {
  double least = 1e300;
  for (std::size_t t = 0; t < patch.tets.size(); ++t)
    least = std::min(least, determinant(jacobianOf(patch, t)));
  return least;
}

TEST(Untangle, TheLatticeIsAsItShouldBe) { EXPECT_NEAR(leastOf(lattice()), 1, 1e-12); }

TEST(Untangle, TurnsAllRightAndKeepsWhatIsFixed) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TetPatch rest = lattice();
    TetPatch patch = rest;
    const CounterRandom random(seed, 7);
    for (std::size_t v = 0; v < patch.vertices.size(); ++v)
      if (patch.free[v])
        for (int k = 0; k < 3; ++k)
          patch.vertices[v][k] += 4 * (random.uniform(3 * v + static_cast<std::size_t>(k)) - 0.5);
    ASSERT_LT(leastOf(patch), 0);
    const double least = untangle(patch);
    EXPECT_GT(least, 0);
    EXPECT_NEAR(least, leastOf(patch), 1e-12);
    for (std::size_t v = 0; v < patch.vertices.size(); ++v)
      EXPECT_TRUE(patch.free[v] || norm(patch.vertices[v] - rest.vertices[v]) < 1e-12);
  }
}

// What nothing fixed can undo is said, and ends.
TEST(Untangle, AFoldedBorderStaysFolded) {
  TetPatch patch = lattice();
  std::swap(patch.vertices[vertexAt(0, 0, 0)], patch.vertices[vertexAt(5, 0, 0)]);
  EXPECT_LE(untangle(patch), 0);
}

// A vertex of the border that may slide in its plane is found again there; one that is tied goes
// where it is tied to.
TEST(Untangle, SpringsHoldAlongTheirNormals) {
  TetPatch patch = lattice();
  const int sliding = vertexAt(0, 2, 2), tied = vertexAt(2, 2, 2);
  patch.free[static_cast<std::size_t>(sliding)] = 1;
  patch.vertices[sliding] = {3, 2.9, 2};
  const Vec3 place = patch.vertices[tied] + Vec3{0.2, 0, 0};
  patch.springs = {{sliding, {0, 9, 9}, {1, 0, 0}, 1e5}, {tied, place, {}, 1e5}};
  ASSERT_LT(leastOf(patch), 0);
  EXPECT_GT(untangle(patch), 0);
  EXPECT_NEAR(patch.vertices[sliding].x, 0, 1e-3);
  EXPECT_NEAR(patch.vertices[sliding].y, 2, 0.2);
  EXPECT_LT(norm(patch.vertices[tied] - place), 1e-3);
}

TEST(Untangle, SpringsMayChangeBetweenRounds) {
  TetPatch patch = lattice();
  const int tied = vertexAt(2, 2, 2);
  patch.springs = {{tied, patch.vertices[tied], {}, 1e5}};
  const Vec3 place = patch.vertices[tied] + Vec3{0, 0.3, 0};
  UntangleSettings settings;
  settings.afterRound = [&](TetPatch& p, int) { p.springs[0].place = place; };
  patch.vertices[tied] = patch.vertices[tied] + Vec3{1.5, 0, 0};
  EXPECT_GT(untangle(patch, settings), 0);
  EXPECT_LT(norm(patch.vertices[tied] - place), 1e-3);
}

TEST(Untangle, NothingToMove) {
  TetPatch patch = lattice();
  std::fill(patch.free.begin(), patch.free.end(), 0);
  EXPECT_NEAR(untangle(patch), 1, 1e-12);
}

TEST(Untangle, IsCancelled) {
  TetPatch patch = lattice();
  test::expectCancels([&] { untangle(patch, {}); });
}

}  // namespace
}  // namespace innermap
