#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/proof/prove.h"
#include "mesh/shapes.h"
#include "proof/maps.h"

namespace innermap {
namespace {

using testing::affineOf;
using testing::kIdentity;
using testing::mapOf;

HarmonicMap gentleEmbedding(std::uint64_t seed) {
  return mapOf(affineOf(kIdentity), testing::chargesAbout(200, 1.9, 0.004, seed));
}

TEST(ProveEmbedding, SmoothMapsAreProven) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    EXPECT_TRUE(proveEmbedding(gentleEmbedding(seed), shapes::icosphere(3)).proven);
    EXPECT_TRUE(proveEmbedding(gentleEmbedding(seed), shapes::torus(30, 15)).proven);
    EXPECT_TRUE(proveEmbedding(ComposedMap({gentleEmbedding(seed), gentleEmbedding(seed + 5)}),
                               shapes::icosphere(2))
                    .proven);
  }
  EXPECT_TRUE(proveEmbedding(mapOf(affineOf(kIdentity), {}), shapes::icosphere(2)).proven);
}

// Two charges between two balls pull them together: nothing folds, det J > 0, and yet with strong
// ones the balls run into each other.
TEST(ProveEmbedding, PartsThatRunIntoEachOtherAreNotProven) {
  const Mesh balls = shapes::joined(shapes::icosphere(2, 0.5, {-0.6, 0, 0}),
                                    shapes::icosphere(2, 0.5, {0.6, 0, 0}));
  const auto pulled = [](double s) {
    return mapOf(affineOf(kIdentity), {{{-0.05, 0, 0}, {s, 0, 0}}, {{0.05, 0, 0}, {-s, 0, 0}}});
  };
  EXPECT_TRUE(proveSense(pulled(0.003), balls).whole());
  EXPECT_TRUE(proveEmbedding(pulled(0.003), balls).proven);
  EXPECT_TRUE(proveSense(pulled(0.02), balls).whole());
  ASSERT_GT(pulled(0.02)({-0.1, 0, 0}).x, pulled(0.02)({0.1, 0, 0}).x);
  const EmbeddingProof proof = proveEmbedding(pulled(0.02), balls);
  EXPECT_FALSE(proof.proven);
  for (const Vec3& place : proof.places) EXPECT_LT(norm(place), 0.5);
  EXPECT_FALSE(proof.connected);
  // It is the two that meet: either by itself is proven.
  for (const double side : {-0.6, 0.6}) {
    const EmbeddingProof one =
        proveEmbedding(pulled(0.02), shapes::icosphere(2, 0.5, {side, 0, 0}));
    EXPECT_TRUE(one.proven && one.connected);
  }
}

// Each of two boxes that touch along an edge may be mapped in its own way.
TEST(ProveEmbedding, WhatTouchesAlongAnEdgeIsNotConnected) {
  Mesh boxes = shapes::joined(shapes::box({-0.5, -0.5, -0.5}, {0, 0, 0.5}),
                              shapes::box({0, 0, -0.5}, {0.5, 0.5, 0.5}));
  const auto at = [&](double z) {
    std::vector<int> out;
    for (std::size_t v = 0; v < boxes.vertices.size(); ++v)
      if (norm(boxes.vertices[v] - Vec3{0, 0, z}) < 1e-12) out.push_back(static_cast<int>(v));
    return out;
  };
  for (const double z : {-0.5, 0.5}) {
    const std::vector<int> same = at(z);
    ASSERT_EQ(same.size(), 2u);
    for (Triangle& t : boxes.triangles) std::replace(t.begin(), t.end(), same[1], same[0]);
  }
  EXPECT_FALSE(proveEmbedding(gentleEmbedding(1), boxes).connected);
}

TEST(ProveEmbedding, FoldedSurfacesAreNotProven) {
  const Vec3 p{1, 0, 0};
  std::vector<testing::Charge> charges = testing::chargesAbout(200, 1.9, 0.004, 1);
  charges.push_back(testing::foldingCharge(gentleEmbedding(1), {0.98, 0, 0}, {1.2, 0, 0}, 0.5));
  const HarmonicMap map = mapOf(affineOf(kIdentity), charges);
  ASSERT_LT(testing::longDeterminant(map, p), 0);
  // A surface through the fold, along the direction that is turned round.
  const Mesh plate = shapes::box({-0.5, -0.02, -0.02}, {1.08, 0.02, 0.02});
  double most = -10;
  bool back = false;
  for (int i = 0; i <= 1000; ++i) {
    const double x = map({-0.5 + 1.58 * i / 1000, 0.02, 0.02}).x;
    back = back || x < most;
    most = std::max(most, x);
  }
  ASSERT_TRUE(back);
  const EmbeddingProof proof = proveEmbedding(map, plate, {.leastCells = 5000});
  EXPECT_FALSE(proof.proven);
  EXPECT_GT(proof.undecided, 0u);
  ASSERT_FALSE(proof.places.empty());
}

TEST(ProveEmbedding, ThreadsDoNotMatter) {
  const ThreadLimit two(2);
  const EmbeddingProof a = proveEmbedding(gentleEmbedding(2), shapes::icosphere(3));
  const ThreadLimit one(1);
  const EmbeddingProof b = proveEmbedding(gentleEmbedding(2), shapes::icosphere(3));
  EXPECT_EQ(a.examined, b.examined);
  EXPECT_EQ(a.proven, b.proven);
}

TEST(ProveEmbedding, RefusesWhatItCannotTake) {
  EXPECT_THROW(proveEmbedding(gentleEmbedding(1), Mesh()), DataError);
  Mesh bad = shapes::icosphere(1);
  bad.vertices[3].y = std::nan("");
  EXPECT_THROW(proveEmbedding(gentleEmbedding(1), bad), DataError);
}

}  // namespace
}  // namespace innermap
