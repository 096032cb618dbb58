#include "mesh/uv_charts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// An open tube of n quads around and m along, unrolled: u runs around from 0 to 1 and jumps back.
Mesh tube(int n, int m, double height = 1, double uMost = 1) {
  Mesh mesh{.name = "tube"};
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i < n; ++i) {
      const double a = 2 * kPi * i / n;
      mesh.vertices.push_back({std::cos(a), std::sin(a), height * j / m});
    }
    for (int i = 0; i <= n; ++i) mesh.uvs.push_back({uMost * i / n, 1.0 * j / m});
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const auto v = [&](int k, int l) { return (j + l) * n + (i + k) % n; };
      const auto t = [&](int k, int l) { return (j + l) * (n + 1) + i + k; };
      mesh.triangles.push_back({v(0, 0), v(1, 0), v(1, 1)});
      mesh.uvTriangles.push_back({t(0, 0), t(1, 0), t(1, 1)});
      mesh.triangles.push_back({v(0, 0), v(1, 1), v(0, 1)});
      mesh.uvTriangles.push_back({t(0, 0), t(1, 1), t(0, 1)});
    }
  return mesh;
}

// Each side of a box unwrapped for itself: six charts of two triangles.
Mesh unwrappedBox() {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  for (int side = 0; side < 6; ++side) {
    const int first = static_cast<int>(mesh.uvs.size());
    for (const Vec2& uv : {Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 1}})
      mesh.uvs.push_back({uv.x / 8 + side / 8.0, uv.y});
    mesh.uvTriangles.push_back({first, first + 1, first + 2});
    mesh.uvTriangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

// No seam has both sides in one group, and every triangle with coordinates has one.
void expectResolved(const Mesh& mesh, const UvCharts& charts, const UvGroups& groups) {
  EXPECT_EQ(groups.unresolvedLength, 0);
  for (const UvSeam& s : charts.seams) EXPECT_NE(groups.group[s.triangle], groups.group[s.other]);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    EXPECT_EQ(groups.group[t] < 0, charts.chart[t] < 0);
    EXPECT_LT(groups.group[t], groups.count);
  }
}

UvGroupSettings atMost(int groups) { return {.most = groups}; }

TEST(UvCharts, ATubeIsOneChartThatMeetsItselfAlongItsHeight) {
  const Mesh mesh = tube(24, 10, 3);
  const UvCharts charts = uvCharts(mesh);
  EXPECT_EQ(charts.count, 1);
  EXPECT_EQ(charts.seams.size(), 10u);
  EXPECT_NEAR(charts.seamLength, 3, 1e-12);
  EXPECT_GT(charts.edgeLength, 24 * 3.0);
  const UvGroups groups = uvGroups(mesh, charts);
  EXPECT_EQ(groups.pieces, 2);
  EXPECT_EQ(groups.count, 2);
  expectResolved(mesh, charts, groups);
  // The other border between the two runs opposite: each has about half.
  const auto first = std::count(groups.group.begin(), groups.group.end(), 0);
  EXPECT_NEAR(static_cast<double>(first) / static_cast<double>(groups.group.size()), 0.5, 0.1);
}

TEST(UvCharts, EqualValuesUnderOtherIndicesAreNoSeam) {
  Mesh mesh = tube(12, 4);
  Mesh split = mesh;
  split.uvs.clear();
  for (Triangle& t : split.uvTriangles)
    for (int& uv : t) {
      split.uvs.push_back(mesh.uvs[uv]);
      uv = static_cast<int>(split.uvs.size()) - 1;
    }
  const UvCharts one = uvCharts(mesh), other = uvCharts(split);
  EXPECT_EQ(one.chart, other.chart);
  EXPECT_EQ(one.seams.size(), other.seams.size());
}

TEST(UvCharts, VerticesSplitAlongTheSeamMakeNoDifference) {
  const Mesh mesh = tube(12, 4);
  Mesh split = mesh;  // a vertex for each texture coordinate
  split.vertices.assign(mesh.uvs.size(), {});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      split.vertices[mesh.uvTriangles[t][k]] = mesh.vertices[mesh.triangles[t][k]];
  split.triangles = split.uvTriangles;
  const UvCharts charts = uvCharts(split);
  EXPECT_EQ(charts.count, 1);
  EXPECT_EQ(charts.seams.size(), 4u);
  EXPECT_NEAR(charts.seamLength, 1, 1e-12);
}

TEST(UvCharts, SidesOfABoxAreChartsAndThreeGroupsAreEnough) {
  const Mesh mesh = unwrappedBox();
  const UvCharts charts = uvCharts(mesh);
  EXPECT_EQ(charts.count, 6);
  EXPECT_EQ(charts.seams.size(), 12u);
  const UvGroups all = uvGroups(mesh, charts);
  EXPECT_EQ(all.count, 6);
  expectResolved(mesh, charts, all);
  const UvGroups few = uvGroups(mesh, charts, atMost(4));
  EXPECT_EQ(few.pieces, 6);
  EXPECT_EQ(few.count, 3);
  expectResolved(mesh, charts, few);
  const UvGroups two = uvGroups(mesh, charts, atMost(2));
  EXPECT_EQ(two.count, 2);
  EXPECT_GT(two.unresolvedLength, 0);
}

TEST(UvCharts, ACutThatEndsInsideAChartIsDividedFromItsTip) {
  // The tube's jump over the lower half of its height only: above, u runs on continuously.
  Mesh mesh = tube(24, 12, 1, 0.05);
  const auto at = [&](int i, int j) { return j * 25 + i; };
  for (int j = 6; j <= 12; ++j)
    for (int i = 0; i <= 24; ++i) mesh.uvs[at(i, j)].x = 0.05 * std::abs(std::sin(kPi * i / 24));
  const UvCharts charts = uvCharts(mesh);
  EXPECT_EQ(charts.count, 1);
  EXPECT_EQ(charts.seams.size(), 6u);
  const UvGroups groups = uvGroups(mesh, charts);
  EXPECT_LE(groups.pieces, 4);
  expectResolved(mesh, charts, groups);
}

TEST(UvCharts, TrianglesWithoutCoordinatesAreInNoChart) {
  Mesh mesh = unwrappedBox();
  mesh.uvTriangles[0] = {-1, -1, -1};
  mesh.uvTriangles[3] = {mesh.uvTriangles[3][0], -1, mesh.uvTriangles[3][2]};
  mesh.uvs[mesh.uvTriangles[5][2]].x = std::numeric_limits<double>::quiet_NaN();
  const UvCharts charts = uvCharts(mesh);
  EXPECT_EQ(charts.chart[0], -1);
  EXPECT_EQ(charts.chart[3], -1);
  EXPECT_EQ(charts.chart[5], -1);
  EXPECT_EQ(charts.count, 6);
  expectResolved(mesh, charts, uvGroups(mesh, charts));
  mesh.uvTriangles.clear();
  mesh.uvs.clear();
  EXPECT_THROW(uvCharts(mesh), DataError);
  EXPECT_THROW(uvGroups(unwrappedBox(), uvCharts(unwrappedBox()), atMost(1)), SettingError);
}

// Random cuts of a sphere: whatever they are, groups resolve them.
TEST(UvCharts, RandomCutsAreResolved) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mesh mesh = shapes::icosphere(2);
    const CounterRandom random(seed, 3);
    const double share = 0.4 * random.uniform(0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      // Some triangles have an offset of their own: seams all around them.
      const double offset =
          random.uniform(t + 1) < share ? std::floor(3 * random.uniform(t + 1e6)) : 0;
      const int first = static_cast<int>(mesh.uvs.size());
      for (const int v : mesh.triangles[t])
        mesh.uvs.push_back({offset + mesh.vertices[v].x, mesh.vertices[v].y});
      mesh.uvTriangles.push_back({first, first + 1, first + 2});
    }
    const UvCharts charts = uvCharts(mesh);
    std::set<int> used(charts.chart.begin(), charts.chart.end());
    EXPECT_EQ(static_cast<int>(used.size()), charts.count);
    expectResolved(mesh, charts, uvGroups(mesh, charts));
  }
}

TEST(UvCharts, CanBeCancelled) {
  test::expectCancels([&] { uvCharts(tube(12, 4)); });
}

}  // namespace
}  // namespace innermap
