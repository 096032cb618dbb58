// Soundness: maps with a fold of known place are never proven there.
#include <gtest/gtest.h>

#include "innermap/proof/prove.h"
#include "mesh/shapes.h"
#include "proof/maps.h"

namespace innermap {
namespace {

using testing::Charge;

struct KnownFold {
  HarmonicMap map;
  Vec3 place;
  double size;  // its distance from the charge that makes it
};

// A ball's map with one charge so close outside that it turns its surroundings over: at `place`,
// 1e-1 to 1e-7 diagonals from the charge, the determinant is down to a thousandth below 0.
KnownFold knownFold(const Mesh& ball, std::uint64_t seed) {
  const CounterRandom random(seed, 31);
  const std::size_t t = random.bits(0) % ball.triangles.size();
  Vec3 p = (1.0 / 3) * (ball.vertices[ball.triangles[t][0]] + ball.vertices[ball.triangles[t][1]] +
                        ball.vertices[ball.triangles[t][2]]);
  const Vec3 n =
      areaVector(ball, static_cast<int>(t)) / norm(areaVector(ball, static_cast<int>(t)));
  const double size = boundingBox(ball).diagonal() * std::pow(10.0, -1 - 6 * random.uniform(1));
  const double depth = size * random.uniform(2);
  const double margin = std::pow(10.0, -3 * random.uniform(3));
  p = p - depth * n;
  std::vector<Charge> charges = testing::chargesAbout(60, 1.7, 0.01, seed);
  const HarmonicMap smooth = testing::mapOf(testing::affineOf(testing::kIdentity), charges);
  charges.push_back(testing::foldingCharge(smooth, p, p + size * n, margin));
  return {testing::mapOf(testing::affineOf(testing::kIdentity), charges), p, size};
}

bool holds(const ProofCell& cell, const Vec3& p) {
  const Vec3 d = p - cell.center;
  return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= cell.halfEdge;
}

bool holds(const ProofCells& cells, const Vec3& p) {
  return std::any_of(cells.places.begin(), cells.places.end(),
                     [&](const ProofCell& cell) { return holds(cell, p); });
}

Vec3 randomPointOf(const ProofCell& cell, std::uint64_t number) {
  const CounterRandom random(number, 32);
  Vec3 p = cell.center;
  for (int a = 0; a < 3; ++a) p[a] += cell.halfEdge * (2 * random.uniform(a) - 1);
  return p;
}

// Of proven and of negative cells about so many, at a random point each.
void expectSigns(const ProofCells& cells, const HarmonicMap& map, double sign, std::size_t count) {
  for (std::size_t i = 0; i < cells.places.size(); i += 1 + cells.places.size() / count) {
    const Vec3 p = randomPointOf(cells.places[i], i);
    ASSERT_GT(sign * static_cast<double>(testing::longDeterminant(map, p)), 0);
  }
}

void checkSeeds(std::uint64_t first, std::uint64_t count, std::size_t samples) {
  const Mesh ball = shapes::icosphere(2);
  double proven = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const KnownFold fold = knownFold(ball, seed);
    ASSERT_LE(testing::longDeterminant(fold.map, fold.place), 0) << seed;
    const SenseProof proof =
        proveSense(fold.map, ball, {.cellsPerCharge = 1, .leastCells = 4000, .keepProven = true});
    ASSERT_FALSE(proof.whole()) << seed;
    ASSERT_FALSE(holds(proof.proven, fold.place)) << seed;
    ASSERT_TRUE(holds(proof.negative, fold.place) || holds(proof.undecided, fold.place)) << seed;
    expectSigns(proof.proven, fold.map, 1, samples);
    expectSigns(proof.negative, fold.map, -1, samples);
    proven += proof.provenShare / static_cast<double>(count);
  }
  EXPECT_GT(proven, 0.8);
}

TEST(KnownFolds, AreNeverProven) { checkSeeds(0, 100, 100); }
TEST(KnownFoldsNightly, AreNeverProven) { checkSeeds(1000, 10000, 1000); }

}  // namespace
}  // namespace innermap
