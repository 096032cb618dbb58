#include "proof/recheck.h"

#include <gtest/gtest.h>

#include "innermap/core/run.h"
#include "mesh/shapes.h"
#include "proof/maps.h"

namespace innermap::proof {
namespace {

using innermap::testing::affineOf;
using innermap::testing::kIdentity;
using innermap::testing::mapOf;

RecheckSettings settingsOf(std::uint64_t seed = 1) { return {.seed = seed}; }

HarmonicMap gentleMap(std::uint64_t seed = 1, double strength = 0.02) {
  return mapOf(affineOf(kIdentity), innermap::testing::chargesAbout(200, 1.5, strength, seed));
}

// Folds at some place inside.
HarmonicMap folded() {
  std::vector<innermap::testing::Charge> charges =
      innermap::testing::chargesAbout(200, 1.5, 0.004, 1);
  charges.push_back(
      innermap::testing::foldingCharge(gentleMap(1, 0.004), {0.7, 0.1, 0}, {1.2, 0.2, 0}, 0.5));
  return mapOf(affineOf(kIdentity), charges);
}

SenseProof proofOf(const ComposedMap& map, const Mesh& solid) {
  return proveSense(map, solid, {.keepProven = true});
}

TEST(Recheck, AgreesWithProofs) {
  const Mesh ball = shapes::icosphere(3);
  for (std::uint64_t seed = 1; seed < 3; ++seed)
    for (const ComposedMap& map :
         {ComposedMap(gentleMap(seed)), ComposedMap({gentleMap(seed), gentleMap(seed + 9, 0.002)}),
          ComposedMap(folded())}) {
      const SenseProof proof = proofOf(map, ball);
      const Recheck cells = recheckSense(map, ball, proof, settingsOf(seed));
      EXPECT_FALSE(cells.disagreement) << cells.disagreement->what;
      EXPECT_EQ(cells.decided, cells.drawn);
      EXPECT_GT(cells.drawn, 10u);
      EXPECT_GT(cells.points, 300u);
      EXPECT_GT(cells.least, 0);
    }
}

TEST(Recheck, SeesCellsThatAreNotAsProven) {
  const Mesh ball = shapes::icosphere(3);
  const HarmonicMap map = folded();
  SenseProof proof = proofOf(map, ball);
  ASSERT_GT(proof.negative.count, 0u);
  std::swap(proof.proven, proof.negative);
  proof.negative = {};
  const Recheck found = recheckSense(map, ball, proof, settingsOf());
  ASSERT_TRUE(found.disagreement);
  EXPECT_LT(determinant(map.jacobian(found.disagreement->place)), 0);
}

TEST(Recheck, SeesADeterminantBelowItsBound) {
  const Mesh ball = shapes::icosphere(3);
  const HarmonicMap map = gentleMap();
  SenseProof proof = proofOf(map, ball);
  proof.least = 100;
  ASSERT_TRUE(recheckSense(map, ball, proof, settingsOf()).disagreement);
}

TEST(Recheck, SeesCellsThatAreMissing) {
  const Mesh ball = shapes::icosphere(3);
  const HarmonicMap map = gentleMap();
  SenseProof proof = proofOf(map, ball);
  std::vector<ProofCell>& places = proof.proven.places;
  places.erase(places.begin());
  ASSERT_TRUE(recheckSense(map, ball, proof, settingsOf()).disagreement);
}

TEST(Recheck, DoesNotDependOnThreads) {
  const Mesh ball = shapes::icosphere(2);
  const HarmonicMap map = gentleMap();
  const SenseProof proof = proofOf(map, ball);
  const Recheck all = recheckSense(map, ball, proof, settingsOf());
  const ThreadLimit one(1);
  const Recheck single = recheckSense(map, ball, proof, settingsOf());
  EXPECT_EQ(all.decided, single.decided);
  EXPECT_DOUBLE_EQ(all.least, single.least);
}

// A target whose error is known: it is moved from the map's own images.
struct Target {
  Mesh ball = shapes::icosphere(3);
  ComposedMap map{gentleMap(1, 0.004)};
  Points to;

  Target() {
    for (const Vec3& p : ball.vertices) to.push_back(map(p));
    to[17] = to[17] + Vec3{0.01, 0, 0};
  }
};

TEST(Recheck, BoundsTheBoundarysError) {
  const Target target;
  const BoundaryProof proof = proveBoundaryError(target.map, target.ball, target.to);
  RecheckSettings all = settingsOf();
  all.cells = 5000;  // as many as are drawn: each triangle with near certainty
  const Recheck found = recheckBoundary(target.map, target.ball, target.to, proof.error, all);
  EXPECT_FALSE(found.disagreement);
  EXPECT_EQ(found.decided, found.drawn);
  EXPECT_LE(found.greatest, proof.error * (1 + 1e-9));
  const Recheck wrong = recheckBoundary(target.map, target.ball, target.to, 0.5 * proof.error, all);
  ASSERT_TRUE(wrong.disagreement);
  EXPECT_LT(norm(wrong.disagreement->place - target.ball.vertices[17]), 0.3);
}

TEST(Recheck, DistancesAndDeterminantsAtPointsAreBounds) {
  const Target target;
  const Vec3 p = target.ball.vertices[17];
  EXPECT_NEAR(sureDistance(target.map, p, target.to[17]), 0.01, 1e-9);
  EXPECT_LE(sureDistance(target.map, p, target.map(p)), 0);
  EXPECT_GE(largestDeterminant(target.map, p), determinant(target.map.jacobian(p)));
  EXPECT_NEAR(largestDeterminant(target.map, p), determinant(target.map.jacobian(p)), 1e-9);
}

}  // namespace
}  // namespace innermap::proof
