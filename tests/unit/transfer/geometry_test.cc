#include "innermap/transfer/geometry.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace innermap {
namespace {

// Two triangles with a common edge, a pentagon beside them and a line along that edge.
Geometry patch() {
  Geometry g{
      .points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2.5, 0.5, 0}, {2, 1, 0}}};
  g.ownPoints = g.points.size();
  const auto add = [&](Elements::Kind kind, const std::vector<int>& points) {
    std::vector<Corner> corners;
    for (const int p : points) corners.push_back({p, -1, p});
    g.elements.add(kind, static_cast<std::uint32_t>(g.elements.size()), corners.data(),
                   corners.size());
  };
  g.textures = g.points.size();
  add(Elements::Kind::face, {0, 1, 2});
  add(Elements::Kind::face, {0, 2, 3});
  add(Elements::Kind::face, {1, 4, 5, 6, 2});
  add(Elements::Kind::line, {0, 2, 1});
  return g;
}

double area(const Geometry& g) {
  double out = 0;
  for (std::size_t e = 0; e < g.elements.size(); ++e) {
    if (g.elements.kinds[e] != Elements::Kind::face) continue;
    const std::size_t begin = g.elements.start[e], end = g.elements.start[e + 1];
    const auto at = [&](std::size_t k) { return g.points[g.elements.corners[k].point]; };
    for (std::size_t k = begin + 2; k < end; ++k)
      out += 0.5 * cross(at(k - 1) - at(begin), at(k) - at(begin)).z;
  }
  return out;
}

// Edges of faces that no other face has.
std::set<std::pair<int, int>> open(const Geometry& g) {
  std::map<std::pair<int, int>, int> uses;
  for (std::size_t e = 0; e < g.elements.size(); ++e) {
    if (g.elements.kinds[e] != Elements::Kind::face) continue;
    const std::size_t begin = g.elements.start[e], count = g.elements.start[e + 1] - begin;
    for (std::size_t k = 0; k < count; ++k) {
      const int a = g.elements.corners[begin + k].point,
                b = g.elements.corners[begin + (k + 1) % count].point;
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  }
  std::set<std::pair<int, int>> out;
  for (const auto& [edge, count] : uses)
    if (count == 1) out.insert(edge);
  return out;
}

TEST(Geometry, EdgesOnce) { EXPECT_EQ(edgesOf(patch()).size(), 9u); }

TEST(Geometry, SplitEdgesLeaveNoGap) {
  const double before = area(patch());
  // All sets of the nine edges: no point may come to lie within another face's edge.
  for (unsigned set = 1; set < 512; ++set) {
    Geometry g = patch();
    const auto edges = edgesOf(g);
    std::vector<std::array<int, 2>> some;
    std::size_t outer = 0;
    const auto outline = open(g);
    for (std::size_t k = 0; k < edges.size(); ++k)
      if (set >> k & 1) {
        some.push_back(edges[k]);
        outer += outline.count({edges[k][0], edges[k][1]});
      }
    splitEdges(g, some);
    EXPECT_NEAR(area(g), before, 1e-12);
    EXPECT_EQ(g.points.size(), 7 + some.size());
    EXPECT_EQ(open(g).size(), outline.size() + outer) << set;
  }
}

TEST(Geometry, SplitsCarryTexturesAndDirections) {
  Geometry g = patch();
  g.directions.push_back({"n", DirectionKind::normal, {}, {}});
  for (int i = 0; i < 7; ++i) {
    g.directions[0].values.push_back(i % 2 ? Vec3{0, 2, 0} : Vec3{0, 0, 2});
    g.directions[0].points.push_back(i);
  }
  splitEdges(g, {{0, 2}, {0, 1}});
  splitEdges(g, {{0, 7}});  // the half of an edge
  EXPECT_EQ(g.points.size(), 10u);
  EXPECT_EQ(g.directions[0].values.size(), 10u);
  EXPECT_NEAR(norm(g.directions[0].values[8]), 2, 1e-14);
  const auto& texture = g.textureMiddles.parents();
  EXPECT_EQ(texture.size(), 3u);
  EXPECT_EQ(texture[0][0] + texture[0][1], 2);  // of 0 and 2
  const Elements& e = g.elements;
  EXPECT_EQ(e.kinds.back(), Elements::Kind::line);
  EXPECT_EQ(e.start.back() - e.start[e.size() - 1], 5u);  // 0 2 1 with two points more
}

}  // namespace
}  // namespace innermap
