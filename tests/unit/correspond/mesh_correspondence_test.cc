#include "innermap/correspond/mesh_correspondence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/memory_limit.h"
#include "fit/blobs.h"
#include "innermap/core/run.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using shapes::blob;
using testing::TemporaryFolder;

const Mesh kA = blob("a.obj", 1, 0.8), kB = blob("b.obj", 2, 0.5, {1.4, 0.9, 1});

MeshCorrespondenceSettings quick() {
  MeshCorrespondenceSettings settings;
  settings.candidates = 1;
  return settings;
}

const MeshCorrespondence& plain() {
  static const MeshCorrespondence map = correspondMeshes(kA, kB, quick());
  return map;
}

// Addresses and positions agree, on the triangles of B as given.
void expectOnTarget(const MeshCorrespondence& map, const Mesh& b, double most) {
  ASSERT_EQ(map.positions.size(), map.source.vertices.size());
  ASSERT_EQ(map.onTarget.size(), map.source.vertices.size());
  const double diagonal = boundingBox(b).diagonal();
  for (std::size_t v = 0; v < map.positions.size(); ++v) {
    ASSERT_LT(map.onTarget[v].triangle, static_cast<int>(b.triangles.size()));
    EXPECT_LE(norm(positionOf(b, map.onTarget[v]) - map.positions[v]), most * diagonal);
  }
}

std::vector<std::string> stagesOf(const MeshCorrespondence& map) {
  std::vector<std::string> names;
  for (const auto& [stage, seconds] : map.seconds) names.push_back(stage);
  return names;
}

TEST(CorrespondMeshes, LaysOneOnTheOther) {
  const MeshCorrespondence& map = plain();
  EXPECT_FALSE(map.changed);
  EXPECT_EQ(map.source.vertices.size(), kA.vertices.size());
  EXPECT_EQ(map.source.triangles, kA.triangles);
  expectOnTarget(map, kB, 1e-12);
  EXPECT_EQ(map.quality.flips, 0u);
  EXPECT_NEAR(map.quality.degree, 1, 1e-9);
  EXPECT_LT(map.quality.energyForward + map.quality.energyBackward, 10);
  EXPECT_FALSE(map.a.outer || map.b.outer || map.farthestFromOuter);
  EXPECT_EQ(map.landmarks, 0u);
  EXPECT_TRUE(map.warnings.empty());
  EXPECT_EQ(stagesOf(map), (std::vector<std::string>{"embed_source", "embed_target", "map",
                                                     "carry back", "measure"}));
  const Mesh target = map.target("moved");
  EXPECT_EQ(target.name, "moved");
  EXPECT_EQ(target.triangles, kA.triangles);
  EXPECT_EQ(target.vertices.size(), map.positions.size());
}

TEST(CorrespondMeshes, IsTheSameForAnyNumberOfThreadsAndOfMeshesThatAreLaidOut) {
  const MeshCorrespondence& first = plain();
  const LaidOutMesh a = layOutMesh(kA), b = layOutMesh(kB);
  const ThreadLimit one(1);
  const MeshCorrespondence second = correspondMeshes(a, b, quick());
  for (std::size_t v = 0; v < first.positions.size(); ++v) {
    EXPECT_EQ(norm(first.positions[v] - second.positions[v]), 0);
    EXPECT_EQ(first.onTarget[v].barycentric, second.onTarget[v].barycentric);
  }
}

TEST(CorrespondMeshes, MeetsLandmarks) {
  MeshCorrespondenceSettings settings = quick();
  const auto farthest = [](const Mesh& mesh, const Vec3& way) {
    const auto at =
        std::max_element(mesh.vertices.begin(), mesh.vertices.end(),
                         [&](const Vec3& p, const Vec3& q) { return dot(p, way) < dot(q, way); });
    return static_cast<int>(at - mesh.vertices.begin());
  };
  // Turned by 20 degrees about z, against what the shapes say.
  const double c = std::cos(0.35), s = std::sin(0.35);
  for (const Vec3& way : Points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}) {
    LandmarkPair pair;
    pair.onA.vertex = farthest(kA, way);
    pair.onB.vertex = farthest(kB, {c * way.x - s * way.y, s * way.x + c * way.y, 0});
    settings.landmarks.pairs.push_back(pair);
  }
  const MeshCorrespondence map = correspondMeshes(kA, kB, settings);
  EXPECT_EQ(map.landmarks, 4u);
  EXPECT_LT(map.landmarkError, 1e-12);
  for (const LandmarkPair& pair : settings.landmarks.pairs)
    EXPECT_LT(norm(map.positions[*pair.onA.vertex] - kB.vertices[*pair.onB.vertex]), 1e-9);
  EXPECT_EQ(map.quality.flips, 0u);
}

TEST(CorrespondMeshes, TellsOfLandmarksThatWereMoved) {
  MeshCorrespondenceSettings settings = quick();
  settings.refine = false;
  settings.landmarks.name = "pairs.txt";
  settings.landmarks.pairs.resize(1);
  settings.landmarks.pairs[0].onA.point = positionOf(kA, {0, {0.4, 0.3, 0.3}});
  settings.landmarks.pairs[0].onB.vertex = 3;
  const MeshCorrespondence map = correspondMeshes(kA, kB, settings);
  ASSERT_EQ(map.warnings.size(), 1u);
  EXPECT_EQ(map.warnings[0].find("pairs.txt: 1"), 0u) << map.warnings[0];
}

TEST(CorrespondMeshes, SplitsTheSourceWhereAsked) {
  MeshCorrespondenceSettings settings = quick();
  settings.subdivide = 0.01;
  const MeshCorrespondence map = correspondMeshes(kA, kB, settings);
  EXPECT_TRUE(map.changed);
  EXPECT_GT(map.source.vertices.size(), kA.vertices.size());
  for (std::size_t v = 0; v < kA.vertices.size(); ++v)
    EXPECT_EQ(norm(map.source.vertices[v] - kA.vertices[v]), 0);
  expectOnTarget(map, kB, 1e-12);
}

TEST(CorrespondMeshes, CarriesValuesOfOuterSurfacesBackToTheMeshesAsGiven) {
  MeshCorrespondenceSettings settings = quick();
  settings.layOut.outerResolution = 12;
  settings.refine = false;
  const Mesh overlapping = shapes::overlapping("two.obj");
  const MeshCorrespondence from = correspondMeshes(overlapping, kB, settings);
  EXPECT_TRUE(from.a.outer);
  EXPECT_FALSE(from.b.outer || from.changed);
  EXPECT_EQ(from.source.triangles, overlapping.triangles);
  expectOnTarget(from, kB, 1e-12);
  ASSERT_TRUE(from.farthestFromOuter);
  EXPECT_GT(*from.farthestFromOuter, 0.05) << "vertices inside the other ball";
  const MeshCorrespondence onto = correspondMeshes(kA, overlapping, settings);
  EXPECT_TRUE(onto.b.outer);
  EXPECT_FALSE(onto.farthestFromOuter);
  expectOnTarget(onto, overlapping, 0.05);
  // What maps are fitted to: the outer surface itself.
  settings.carryBack = false;
  const MeshCorrespondence outer = correspondMeshes(overlapping, kB, settings);
  EXPECT_TRUE(outer.changed);
  EXPECT_EQ(outer.source.vertices.size(), outer.a.outer->mesh.vertices.size());
  EXPECT_FALSE(outer.farthestFromOuter);
  expectOnTarget(outer, kB, 1e-12);
}

TEST(CorrespondMeshes, RefusesWhatHasNoMap) {
  EXPECT_THROW(correspondMeshes(kA, shapes::torus(12, 8), quick()), DataError);
  MeshCorrespondenceSettings settings = quick();
  {
    const MemoryLimit limit(1'000'000);
    EXPECT_THROW(correspondMeshes(kA, kB, settings), MemoryError);
  }
  settings = quick();
  settings.candidates = 0;
  EXPECT_THROW(correspondMeshes(kA, kB, settings), SettingError);
  settings = quick();
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(correspondMeshes(kA, kB, settings), Cancelled);
}

TEST(CorrespondMeshes, ClosesHoles) {
  MeshCorrespondenceSettings settings = quick();
  settings.refine = false;
  const Mesh open = shapes::opened(kB, 6);
  const MeshCorrespondence map = correspondMeshes(kA, open, settings);
  for (const SurfacePoint& p : map.onTarget)
    EXPECT_LT(p.triangle, static_cast<int>(open.triangles.size())) << "on a cap";
}

TEST(CorrespondEstimates, GrowWithTheMeshes) {
  EXPECT_GT(correspondMemory(20000, 100), correspondMemory(1000, 100));
}

TEST(SameConnectivity, LooksAtPolygonsFirst) {
  Mesh a = kA, moved = kA;
  moved.vertices[3] = {5, 5, 5};
  EXPECT_TRUE(sameConnectivity(a, moved));
  EXPECT_FALSE(sameConnectivity(a, kB));
  std::swap(moved.triangles[0], moved.triangles[1]);
  EXPECT_FALSE(sameConnectivity(a, moved));
  // A square, cut both ways.
  Mesh one, other;
  one.vertices = other.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}, {0, 2, 3}};
  other.triangles = {{0, 1, 3}, {1, 2, 3}};
  EXPECT_FALSE(sameConnectivity(one, other));
  one.polygonStart = other.polygonStart = {0, 4};
  one.polygonCorners = other.polygonCorners = {0, 1, 2, 3};
  EXPECT_TRUE(sameConnectivity(one, other));
}

TEST(WriteCorrespondence, HasPlacesAndAddresses) {
  MeshCorrespondence map = plain();
  map.source.colours.assign(kA.vertices.size(), {1, 0, 0});
  const TemporaryFolder folder;
  const std::string path = folder.file("on.ply");
  writeCorrespondence(path, map);
  const Mesh moved = readMesh(path);
  EXPECT_EQ(moved.triangles, map.source.triangles);
  ASSERT_EQ(moved.vertices.size(), map.positions.size());
  for (std::size_t v = 0; v < moved.vertices.size(); ++v)
    EXPECT_EQ(norm(moved.vertices[v] - map.positions[v]), 0);
  EXPECT_TRUE(moved.colours.empty());
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(bytes.find("property int triangle\nproperty double b0\nproperty double b1\n"
                       "property double b2\nelement face"),
            std::string::npos);
  std::int32_t triangle;
  std::memcpy(&triangle, &bytes[bytes.find("end_header\n") + 11 + 24], 4);
  EXPECT_EQ(triangle, map.onTarget[0].triangle);
}

TEST(ReadCorrespondence, KnowsWhatBelongsTogether) {
  const TemporaryFolder folder;
  writeCorrespondence(folder.file("on.ply"), plain());
  const Mesh moved = readCorrespondence(folder.file("on.ply"), kA);
  EXPECT_EQ(moved.triangles, kA.triangles);
  EXPECT_NO_THROW(requireOnTarget(moved, kB));
  EXPECT_THROW(requireOnTarget(moved, kA), DataError);
  EXPECT_THROW(readCorrespondence(folder.file("on.ply"), blob("finer.obj", 2, 0.8)), DataError);
}

}  // namespace
}  // namespace innermap
