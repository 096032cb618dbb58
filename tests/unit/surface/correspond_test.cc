#include "innermap/surface/correspond.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/shapes.h"
#include "mesh/triangle_tree.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

Mesh meshOf(const ClosedSurface& s, const std::string& name) {
  Mesh mesh;
  mesh.name = name;
  mesh.vertices = s.vertices;
  mesh.triangles = s.triangles;
  return mesh;
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

TEST(CorrespondRelease, SameForAnyNumberOfThreads) {
  const Mesh a = limbs(2), b = shapes::icosphere(3);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return correspond(EmbeddedSurface(a), EmbeddedSurface(b)).positions;
  };
  const Points one = run(1), two = run(2);
  for (std::size_t v = 0; v < one.size(); ++v) ASSERT_LT(norm(one[v] - two[v]), 1e-15) << v;
}

TEST(CorrespondRelease, LandmarksAreMet) {
  const Mesh a = shapes::icosphere(3), b = limbs(3);
  CorrespondSettings settings;
  for (const int v : {3, 40, 171, 300, 512}) {
    Landmark l;
    l.vertex = v;
    // The same direction turned about z by a third of a turn.
    Vec3 p = a.vertices[v];
    p = {-0.5 * p.x - 0.8660254 * p.y, 0.8660254 * p.x - 0.5 * p.y, p.z};
    l.onTarget = TriangleTree(b.vertices, b.triangles).closest(1.2 * p).address;
    settings.landmarks.push_back(l);
  }
  const Correspondence map = correspond(EmbeddedSurface(a), EmbeddedSurface(b), settings);
  expectOneToOne(map);
  for (const Landmark& l : settings.landmarks)
    EXPECT_LT(norm(map.positions[l.vertex] - positionOf(b, l.onTarget)),
              1e-9 * boundingBox(b).diagonal());
}

TEST(Correspond, BadLandmarksAreRefused) {
  const Mesh a = shapes::icosphere(2), b = shapes::icosphere(3);
  const EmbeddedSurface ea(a), eb(b);
  const auto says = [&](std::vector<Landmark> landmarks, const std::string& text) {
    CorrespondSettings settings;
    settings.landmarks = std::move(landmarks);
    try {
      correspond(ea, eb, settings);
      ADD_FAILURE() << "not refused: " << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  const auto mark = [](int vertex, int triangle) {
    Landmark l;
    l.vertex = vertex;
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
  try {
    correspond(EmbeddedSurface(ball), EmbeddedSurface(torus));
    FAIL() << "not refused";
  } catch (const DataError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("genus 0"), std::string::npos) << what;
    EXPECT_NE(what.find("genus 1"), std::string::npos) << what;
  }
}

Mesh hollow(double inner, int level, const Vec3& at, bool innerFirst) {
  Mesh out, shell = shapes::icosphere(level);
  const auto add = [&](double radius, const Vec3& center, bool turned) {
    const int first = static_cast<int>(out.vertices.size());
    for (const Vec3& p : shell.vertices) out.vertices.push_back(radius * p + center);
    for (Triangle t : shell.triangles) {
      if (turned) std::swap(t[1], t[2]);
      out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  };
  out.name = "hollow ball";
  if (innerFirst) add(inner, at, true);
  add(1, {0, 0, 0}, false);
  if (!innerFirst) add(inner, at, true);
  return out;
}

TEST(CorrespondRelease, ShellsArePairedByNesting) {
  const Mesh a = hollow(0.5, 2, {0, 0, 0}, true), b = hollow(0.3, 3, {0.2, 0, 0}, false);
  const Correspondence map = correspond(EmbeddedSurface(a), EmbeddedSurface(b));
  ASSERT_EQ(map.shells.size(), 2u);
  expectOneToOne(map);
  const std::size_t inner = shapes::icosphere(2).vertices.size();
  for (std::size_t v = 0; v < map.positions.size(); ++v) {
    const double r = v < inner ? norm(map.positions[v] - Vec3{0.2, 0, 0}) : norm(map.positions[v]);
    ASSERT_NEAR(r, v < inner ? 0.3 : 1, 0.03) << v;
  }
  try {
    correspond(EmbeddedSurface(a), EmbeddedSurface(shapes::icosphere(2)));
    FAIL() << "not refused";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("1 closed surface and 1 inside, of 0, 0 handles"),
              std::string::npos)
        << error.what();
  }
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

TEST(CorrespondRelease, SubdividedSourceFollowsTheTarget) {
  Mesh a = shapes::icosphere(2);
  a.uvTriangles = a.triangles;
  for (const Vec3& p : a.vertices) a.uvs.push_back({p.x, p.y});
  const Mesh b = limbs(4);
  CorrespondSettings settings;
  settings.subdivide = 0.01;
  const Correspondence map = correspond(EmbeddedSurface(a), EmbeddedSurface(b), settings);
  expectOneToOne(map);
  EXPECT_GT(map.source.vertices.size(), a.vertices.size());
  ASSERT_EQ(map.positions.size(), map.source.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    ASSERT_LT(norm(map.source.vertices[v] - a.vertices[v]), 1e-15);
  EXPECT_NEAR(surfaceArea(map.source), surfaceArea(a), 1e-12 * surfaceArea(a));
  ASSERT_EQ(map.source.uvTriangles.size(), map.source.triangles.size());
  for (std::size_t t = 0; t < map.source.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = map.source.vertices[map.source.triangles[t][k]];
      const Vec2& uv = map.source.uvs[map.source.uvTriangles[t][k]];
      ASSERT_NEAR(uv.x, p.x, 1e-12);
      ASSERT_NEAR(uv.y, p.y, 1e-12);
    }
  const MapQuality q = mapQuality(map);
  EXPECT_LT(q.deviation.max, 0.01);
  EXPECT_LT(q.backDeviation.max, 0.01);
}

TEST(Correspond, WithoutRefinementItIsStillOneToOne) {
  CorrespondSettings settings;
  settings.refine = false;
  const Mesh a = limbs(3), b = shapes::icosphere(3);
  expectOneToOne(correspond(EmbeddedSurface(a), EmbeddedSurface(b), settings));
}

TEST(Correspond, SettingsAreChecked) {
  const EmbeddedSurface ball(shapes::icosphere(1));
  CorrespondSettings settings;
  settings.candidates = 0;
  EXPECT_THROW(correspond(ball, ball, settings), SettingError);
  settings = {};
  settings.subdivide = -1;
  EXPECT_THROW(correspond(ball, ball, settings), SettingError);
  RunContext run;
  run.cancel();
  settings = {};
  const RunScope scope(run);
  EXPECT_THROW(correspond(ball, ball, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
