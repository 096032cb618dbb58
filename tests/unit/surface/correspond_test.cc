#include "innermap/surface/correspond.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "mesh/shapes.h"
#include "mesh/triangle_tree.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

Mesh meshOf(const ClosedSurface& s, const std::string& name) {
  return {.name = name, .vertices = s.vertices, .triangles = s.triangles};
}

// A ball with four blunt limbs of different lengths, no two alike: it has one best map onto itself.
Mesh limbs(int level, double twist = 0) {
  Mesh mesh = shapes::icosphere(level);
  mesh.name = "limbs";
  const Vec3 ways[4] = {{1, 0, 0}, {-0.5, 0.85, 0.1}, {-0.4, -0.8, 0.4}, {0.1, 0.1, -1}};
  const double lengths[4] = {1.6, 1.1, 0.7, 0.4};
  for (Vec3& p : mesh.vertices) {
    double radius = 1;
    for (int k = 0; k < 4; ++k) {
      const double c = dot(p, ways[k]) / norm(ways[k]);
      radius += lengths[k] * std::exp(-12 * (1 - c));
    }
    p = radius * p;
    const double a = twist * p.z;
    p = {std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
  }
  return mesh;
}

double farthestFrom(const Points& points, const Mesh& surface) {
  const TriangleTree tree(surface.vertices, surface.triangles);
  double farthest = 0;
  for (const Vec3& p : points) farthest = std::max(farthest, tree.closest(p).distance);
  return farthest / boundingBox(surface).diagonal();
}

void expectOneToOne(const Correspondence& map) {
  for (const ShellCorrespondence& s : map.shells) {
    const LayoutQuality q = layoutQuality(s.surface.triangles, s.surface.vertices, s.image);
    EXPECT_EQ(q.flips, 0u);
    EXPECT_NEAR(q.degree, 1, 1e-9);
  }
}

TEST(CorrespondRelease, ABodyOntoItselfInAnotherMesh) {
  const Mesh a = limbs(3), b = limbs(4, 0.2);
  const Correspondence map = correspond(EmbeddedSurface(a), EmbeddedSurface(b));
  ASSERT_EQ(map.positions.size(), a.vertices.size());
  expectOneToOne(map);
  EXPECT_LT(farthestFrom(map.positions, b), 1e-12);
  const MapQuality q = mapQuality(map);
  EXPECT_LT(q.energyForward + q.energyBackward, 8.8);  // 8 for an isometry
  // The vertices of the coarse ball are the first of the fine one, so the truth is known.
  std::vector<double> error;
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    error.push_back(norm(map.positions[v] - b.vertices[v]) / boundingBox(b).diagonal());
  std::sort(error.begin(), error.end());
  EXPECT_LT(error[error.size() / 2], 0.02);
  EXPECT_LT(error.back(), 0.08);
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    ASSERT_LT(norm(positionOf(b, map.onTarget[v]) - map.positions[v]), 1e-12);
}

TEST(Correspond, BadLandmarksAreRefused) {
  const Mesh a = shapes::icosphere(2), b = shapes::icosphere(3);
  const EmbeddedSurface ea(a), eb(b);
  const auto says = [&](std::vector<Landmark> landmarks, const std::string& text) {
    test::expectRefused([&] { correspond(ea, eb, {.landmarks = std::move(landmarks)}); }, text);
  };
  const auto mark = [](int vertex, int triangle) {
    Landmark l{.vertex = vertex};
    l.onTarget.triangle = triangle;
    return l;
  };
  says({mark(-1, 0)}, "vertex -1");
  says({mark(100000, 0)}, "vertex 100000");
  says({mark(0, 1 << 30)}, "triangle");
  says({mark(0, 3), mark(0, 90)}, "same vertex");
  says({mark(0, 3), mark(5, 3)}, "same place");
  // The mirror image of the truth.
  std::vector<Landmark> mirrored;
  const TriangleTree tree(b.vertices, b.triangles);
  for (const int v : {0, 20, 40, 60, 80, 100, 120}) {
    Vec3 p = a.vertices[v];
    p.x = -p.x;
    mirrored.push_back(mark(v, 0));
    mirrored.back().onTarget = tree.closest(p).address;
  }
  says(mirrored, "orientation");
}

TEST(Correspond, OtherTopologyIsRefusedWithBothGenera) {
  const Mesh ball = shapes::icosphere(2);
  const Mesh torus = meshOf(shapes::tube(shapes::circle, 30, 12, 0.4), "torus");
  const auto laid = [&] { correspond(EmbeddedSurface(ball), EmbeddedSurface(torus)); };
  for (const char* genus : {"genus 0", "genus 1"}) test::expectRefused<DataError>(laid, genus);
}

TEST(CorrespondRelease, ToriMeetMeridianToMeridian) {
  const int n = 36, m = 14;
  const Mesh a = meshOf(shapes::tube(shapes::circle, n, m, 0.3), "a"),
             b = meshOf(shapes::tube(shapes::trefoil, 90, 10, 0.35), "b");
  const Correspondence map = correspond(EmbeddedSurface(a), EmbeddedSurface(b));
  expectOneToOne(map);
  EXPECT_LT(farthestFrom(map.positions, b), 1e-12);
  // A ring of A's tube goes around B's tube once: it stays near a point of the curve inside.
  for (const int ring : {0, 11, 25}) {
    Box3 box;
    for (int j = 0; j < m; ++j) box.add(map.positions[static_cast<std::size_t>(ring * m + j)]);
    EXPECT_LT(box.diagonal(), 0.4 * boundingBox(b).diagonal());
  }
}

}  // namespace
}  // namespace innermap
