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

double diagonalOf(const Points& points) { return boundingBox(points).diagonal(); }

// At random points of all triangles, and their corners: the largest error, of the diagonal.
double sampledError(const ComposedMap& map, const Mesh& mesh, const Points& target,
                    std::uint64_t perTriangle) {
  const CounterRandom random(5, 41);
  double most = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint64_t i = 0; i < perTriangle; ++i) {
      double u = random.uniform(2 * (t * perTriangle + i)),
             v = random.uniform(2 * (t * perTriangle + i) + 1);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Triangle& corners = mesh.triangles[t];
      const auto at = [&](const Points& p) {
        const Vec3 first = p[corners[0]];
        return first + u * (p[corners[1]] - first) + v * (p[corners[2]] - first);
      };
      most = std::max(most, norm(map(at(mesh.vertices)) - at(target)));
    }
  return most / diagonalOf(target);
}

TEST(ProveBoundaryErrorRelease, IsAboveEverySampleAndNearTheLargest) {
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    const Mesh mesh = seed % 2 ? shapes::icosphere(2) : shapes::torus(24, 12);
    const HarmonicMap first =
        mapOf(affineOf(kIdentity), testing::chargesAbout(300, 1.6, 0.004, seed));
    const HarmonicMap second = mapOf(affineOf({{{1, 0.1, 0}, {0, 1, 0}, {0, 0.2, 1}}}, {0.1, 0, 0}),
                                     testing::chargesAbout(200, 2, 0.01, seed + 1));
    for (const ComposedMap& map : {ComposedMap(first), ComposedMap({first, second})}) {
      // The map itself at the vertices: what is left lies between them.
      Points target;
      for (const Vec3& v : mesh.vertices) target.push_back(map(v));
      for (const double shift : {0.0, 0.01}) {
        target[5].x += shift;
        const BoundaryProof proof = proveBoundaryError(map, mesh, target);
        const double sampled = sampledError(map, mesh, target, 20);
        EXPECT_TRUE(proof.close);
        EXPECT_GE(proof.error, sampled);
        EXPECT_GE(proof.error, proof.seen);
        EXPECT_LE(proof.error, 1.0201 * proof.seen);
        EXPECT_GE(proof.seen, 0.97 * sampled);
      }
    }
  }
}

// Edges of 0.15 beside charges 0.03 away: each triangle has to be cut before it has a bound.
TEST(ProveBoundaryErrorRelease, TrianglesLargerThanTheDistanceOfChargesHaveABound) {
  const Mesh mesh = shapes::icosphere(3);
  const ComposedMap map(mapOf(affineOf(kIdentity), testing::chargesAbout(2000, 1.03, 1e-4, 3)));
  Points target;
  for (const Vec3& v : mesh.vertices) target.push_back(map(v));
  ProofSettings settings;
  settings.cellsPerCharge = 40;
  settings.leastCells = 1;
  const BoundaryProof proof = proveBoundaryError(map, mesh, target, settings);
  EXPECT_TRUE(proof.close);
  EXPECT_GE(proof.error, sampledError(map, mesh, target, 20));
}

TEST(ProveBoundaryError, ExactMapsHaveNone) {
  const Mat3 a = {{{1, 2, 0}, {0, 1, 0}, {0.5, 0, 3}}};
  const ComposedMap map(mapOf(affineOf(a, {5, 6, 7}), {}));
  const Mesh mesh = shapes::icosphere(3);
  Points target;
  for (const Vec3& v : mesh.vertices) target.push_back(map(v));
  const BoundaryProof proof = proveBoundaryError(map, mesh, target);
  EXPECT_TRUE(proof.close);
  EXPECT_LT(proof.error, 1e-11);
}

TEST(ProveBoundaryError, SaysWhereTheLargestErrorIs) {
  const Mesh mesh = shapes::icosphere(2);
  const ComposedMap map(mapOf(affineOf(kIdentity), {}));
  Points target = mesh.vertices;
  target[7] = target[7] + Vec3{0, 0.25, 0};
  const BoundaryProof proof = proveBoundaryError(map, mesh, target, {.errorMargin = 0.01});
  EXPECT_TRUE(proof.close);
  EXPECT_NEAR(proof.error, 0.25 / diagonalOf(target), 0.0101 * proof.error);
  EXPECT_LT(norm(proof.seenAt - mesh.vertices[7]), 0.05);
}

TEST(ProveBoundaryError, AChargeOnTheSurfaceHasNoBound) {
  const Mesh mesh = shapes::icosphere(1);
  const Vec3 place =
      0.5 * (mesh.vertices[mesh.triangles[3][0]] + mesh.vertices[mesh.triangles[3][1]]);
  const BoundaryProof proof =
      proveBoundaryError(mapOf(affineOf(kIdentity), {{place, {0.01, 0, 0}}}), mesh, mesh.vertices,
                         {.leastCells = 20000});
  EXPECT_FALSE(proof.close);
  EXPECT_FALSE(std::isfinite(proof.error));
  EXPECT_LT(proof.examined, 2000u);  // no work for what is not to be had
}

// What the expansions of the first step cut off is larger than the distance of that charge.
TEST(ProveBoundaryError, AChargeOfALaterStepMayBeNear) {
  const Mesh mesh = shapes::icosphere(1);
  const HarmonicMap first = mapOf(affineOf(kIdentity), testing::chargesAbout(1500, 1.5, 0.04, 3));
  const Vec3 middle = (mesh.vertices[mesh.triangles[7][0]] + mesh.vertices[mesh.triangles[7][1]] +
                       mesh.vertices[mesh.triangles[7][2]]) /
                      3;
  const Vec3 on = first(middle), out = inverse(transposed(first.jacobian(middle))) * middle;
  const HarmonicMap second =
      mapOf(affineOf(kIdentity), {{on + (2e-4 / norm(out)) * out, {0, 1e-7, 0}}});
  const ComposedMap map({first, second});
  Points target;
  for (const Vec3& v : mesh.vertices) target.push_back(map(v));
  const BoundaryProof proof = proveBoundaryError(map, mesh, target);
  EXPECT_TRUE(proof.close);
  EXPECT_GE(proof.error, sampledError(map, mesh, target, 20));
}

TEST(ProveBoundaryError, ThreadsDoNotMatter) {
  const Mesh mesh = shapes::icosphere(3);
  const ComposedMap map(mapOf(affineOf(kIdentity), testing::chargesAbout(700, 1.4, 0.01, 2)));
  const ThreadLimit two(2);
  const BoundaryProof a = proveBoundaryError(map, mesh, mesh.vertices);
  const ThreadLimit one(1);
  const BoundaryProof b = proveBoundaryError(map, mesh, mesh.vertices);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.examined, b.examined);
}

TEST(ProveBoundaryError, RefusesWhatItCannotTake) {
  const Mesh mesh = shapes::icosphere(1);
  const ComposedMap map(mapOf(affineOf(kIdentity), {}));
  Points target = mesh.vertices;
  target.pop_back();
  EXPECT_THROW(proveBoundaryError(map, mesh, target), DataError);
  target.push_back({std::nan(""), 0, 0});
  EXPECT_THROW(proveBoundaryError(map, mesh, target), DataError);
  EXPECT_THROW(proveBoundaryError(map, Mesh(), {}), DataError);
  EXPECT_THROW(proveBoundaryError(map, mesh, Points(mesh.vertices.size())), DataError);
}

}  // namespace
}  // namespace innermap
