#include "surface/detail/handles/cut_handles.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "surface/detail/handles/cut_alike.h"
#include "surface/detail/handles/match_handles.h"
#include "surface/detail/sphere/sphere_layout.h"
#include "surface/detail/topology/half_edges.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

using namespace shapes;

double lengthOf(const Points& vertices, const std::vector<int>& loop) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    length += norm(vertices[loop[(i + 1) % loop.size()]] - vertices[loop[i]]);
  return length;
}

// Along the shortest loops.
CutSurface cutHandles(const ClosedSurface& surface) {
  const HandleLoops loops = handleLoops(surface);
  std::vector<int> first(loops.handles);
  std::iota(first.begin(), first.end(), 0);
  return cutAlong(loops, first);
}

// A sphere whose triangles lie where those of `surface` do, but for the caps.
CutSurface expectCut(const ClosedSurface& surface) {
  const CutSurface cut = cutHandles(surface);
  const HalfEdges edges(cut.surface.triangles);  // closed and manifold
  const std::vector<int> outgoing = edges.outgoing(cut.surface.vertices.size());
  for (const int h : outgoing) EXPECT_GE(h, 0);
  const auto vertices = static_cast<int>(cut.surface.vertices.size());
  EXPECT_EQ(vertices - edges.size() / 6, 2);
  EXPECT_EQ(cut.surface.genus, 0);
  EXPECT_EQ(cut.handles.size(), static_cast<std::size_t>(surface.genus));
  for (std::size_t v = 0; v < cut.vertexOf.size(); ++v)
    if (cut.vertexOf[v] >= 0) {
      EXPECT_EQ(norm(cut.surface.vertices[v] - surface.vertices[cut.vertexOf[v]]), 0);
    }
  std::vector<SurfacePoint> centroids;
  for (std::size_t t = 0; t < cut.surface.triangles.size(); ++t)
    centroids.push_back({static_cast<int>(t), {0.2, 0.3, 0.5}});
  const std::vector<SurfacePoint> images = onUncut(cut, centroids);
  for (std::size_t t = 0; t < images.size(); ++t) {
    const Vec3 there = pointOn(surface, images[t]);
    if (cut.triangleOf[t] >= 0) {
      EXPECT_LT(norm(there - pointOn(cut.surface, centroids[t])), 1e-12);
      EXPECT_EQ(images[t].triangle, cut.triangleOf[t]);
    } else {
      // Away from the centre onto the rim.
      const Triangle& tri = cut.surface.triangles[t];
      EXPECT_LT(
          norm(there - (0.4 * cut.surface.vertices[tri[0]] + 0.6 * cut.surface.vertices[tri[1]])),
          1e-12);
    }
  }
  std::set<int> rims;
  for (const CutHandle& handle : cut.handles)
    for (std::size_t side = 0; side < 2; ++side) {
      EXPECT_EQ(cut.vertexOf[handle.centre[side]], -1);
      for (std::size_t i = 0; i < handle.loop[side].size(); ++i) {
        const int v = handle.loop[side][i];
        const int w = handle.loop[side][(i + 1) % handle.loop[side].size()];
        EXPECT_TRUE(rims.insert(v).second);
        EXPECT_EQ(cut.vertexOf[v], cut.vertexOf[handle.loop[0][i]]);
        // Side 0 has the surface on its left.
        int h = outgoing[v];
        while (edges.head(h) != w) h = edges.counterclockwise(h);
        if (side == 1) h = edges.opposite(h);
        EXPECT_GE(cut.triangleOf[static_cast<std::size_t>(h / 3)], 0);
        EXPECT_EQ(edges.apex(edges.opposite(h)), handle.centre[side]);
      }
    }
  return cut;
}

TEST(CutHandles, CutsThinBarsAcross) {
  for (const int holes : {1, 2, 3, 5}) {
    for (const int fineness : {1, 3}) {
      const CutSurface cut = expectCut(plate(holes, fineness));
      for (const CutHandle& handle : cut.handles)
        EXPECT_NEAR(lengthOf(cut.surface.vertices, handle.loop[0]), 6 * fineness, 1e-9);
      EXPECT_EQ(cut.triangleOf[0], 0);
    }
  }
}

TEST(CutHandles, OfNoneIsTheSurfaceItself) {
  const CutSurface cut = expectCut(shapes::closed(shapes::icosphere(2), 0));
  EXPECT_TRUE(cut.handles.empty());
  EXPECT_EQ(cut.surface.triangles, shapes::icosphere(2).triangles);
}

TEST(CutHandles, OfACavityClosesTunnels) {
  // A plate's loops along its holes bound in the space around it: 2 (3 + 3) about a hole.
  const CutSurface cut = expectCut(shapes::turnedInsideOut(plate(2)));
  for (const CutHandle& handle : cut.handles)
    EXPECT_NEAR(lengthOf(cut.surface.vertices, handle.loop[0]), 12, 1e-9);
}

TEST(CutHandles, KnottedAndLinkedTubesAreHandlesToo) {
  expectCut(boundaryOf(shapes::trefoilCells(), 1));
  expectCut(shapes::tube(shapes::trefoil, 120, 9, 0.3));
  // Two linked rings with a bar between them.
  const shapes::Cells flat = without(block({0, 0, 0}, {8, 8, 0}), block({1, 1, 0}, {7, 7, 0}));
  const shapes::Cells upright =
      without(block({4, 4, -4}, {4, 12, 4}), block({4, 5, -3}, {4, 11, 3}));
  expectCut(boundaryOf(with(with(flat, upright), block({4, 1, 0}, {4, 3, 0})), 2));
}

TEST(CutHandles, MakesRoomWhereThereIsNone) {
  // Two tori of nine vertices joined at a triangle: most loops share vertices.
  const Mesh one = shapes::torus(3, 3);
  ClosedSurface two = shapes::closed(one, 2);
  two.triangles.pop_back();
  const Triangle seam = one.triangles.back();
  std::vector<int> number(one.vertices.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    number[v] = static_cast<int>(two.vertices.size());
    two.vertices.push_back(Vec3{-one.vertices[v].x + 2 * one.vertices[seam[0]].x, one.vertices[v].y,
                                one.vertices[v].z});
  }
  for (const int v : seam) number[v] = v;
  for (const auto& [a, b, c] : one.triangles)
    if (Triangle{a, b, c} != seam) two.triangles.push_back({number[a], number[c], number[b]});
  // Compact.
  std::vector<int> to(two.vertices.size(), -1);
  Points used;
  for (Triangle& t : two.triangles)
    for (int& v : t) {
      if (to[v] < 0) {
        to[v] = static_cast<int>(used.size());
        used.push_back(two.vertices[v]);
      }
      v = to[v];
    }
  two.vertices = used;
  expectCut(two);
}

TEST(CutHandles, KnottedTunnelsAreRefused) {
  // With a straight tunnel beside it.
  const shapes::Cells solid =
      without(with(shapes::knottedTunnel(), block({11, -2, -2}, {15, 10, 4})),
              block({13, 4, -2}, {13, 4, 4}));
  EXPECT_THROW(handleLoops(boundaryOf(shapes::knottedTunnel(), 1)), DataError);
  test::expectRefused<DataError>([&] { handleLoops(boundaryOf(solid, 2)); }, "knotted");
  test::expectCancels([&] { handleLoops(plate(2)); });
}

struct Laid {
  CutSurface cut;
  Layout layout;
};

Laid laid(const ClosedSurface& surface) {
  Laid out{cutHandles(surface), {}};
  out.layout = layOutSphere(out.cut.surface);
  return out;
}

// Plates of three holes with marks, so that they have no symmetry.
ClosedSurface markedPlate(int fineness) {
  return boundaryOf(shapes::finer(with(with(shapes::plateCells(3), block({0, 0, 2}, {2, 0, 6})),
                                       block({12, 5, 0}, {12, 7, 0})),
                                  fineness),
                    3);
}

// The cuts of both lie at the same places, but for a motion and a factor.
void expectSameCuts(const CutPair& pair, const Mat3& turn, double scale, double near) {
  for (std::size_t i = 0; i < pair.a.handles.size(); ++i) {
    const CutHandle &from = pair.a.handles[i],
                    &to = pair.b.handles[static_cast<std::size_t>(pair.match.target[i])];
    EXPECT_LT(norm(scale * (turn * pair.a.surface.vertices[from.centre[0]]) -
                   pair.b.surface.vertices[to.centre[0]]),
              near);
  }
}

TEST(CutAlike, FindsTheHandlesOfATurnedSurface) {
  const Mat3 turn = {{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}};
  const HandleLoops a = handleLoops(markedPlate(1));
  EXPECT_GT(a.loops.size(), 3u);
  ClosedSurface surface = markedPlate(2);
  for (Vec3& p : surface.vertices) p = 0.5 * (turn * p);
  expectSameCuts(cutAlike(a, handleLoops(surface)), turn, 1, 3);
}

TEST(CutAlike, PosesAndLandmarksDecide) {
  // Plates have symmetries.
  const ClosedSurface a = plate(2, 2), b = plate(2, 3);
  const HandleLoops loopsOfA = handleLoops(a), loopsOfB = handleLoops(b);
  EXPECT_NE(cutAlike(loopsOfA, loopsOfB).note, "");
  CutAlikeSettings aligned, landmarks;
  aligned.aligned = true;
  for (const Vec3& p :
       {Vec3{0, 0, 0}, Vec3{9, 0, 0}, Vec3{0, 5, 0}, Vec3{9, 5, 2}, Vec3{0, 0, 2}}) {
    const auto vertexAt = [](const ClosedSurface& surface, const Vec3& q) {
      for (std::size_t v = 0; v < surface.vertices.size(); ++v)
        if (norm(surface.vertices[v] - q) < 1e-9) return static_cast<int>(v);
      ADD_FAILURE() << "no vertex there";
      return 0;
    };
    const int w = vertexAt(b, 3.0 * p);
    for (std::size_t t = 0; t < b.triangles.size(); ++t) {
      if (b.triangles[t][0] != w) continue;
      landmarks.landmarks.push_back({vertexAt(a, 2.0 * p), {static_cast<int>(t), {1, 0, 0}}});
      break;
    }
  }
  ASSERT_GE(landmarks.landmarks.size(), 3u);
  const Mat3 still = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  expectSameCuts(cutAlike(loopsOfA, loopsOfB, aligned), still, 1.5, 8);
  expectSameCuts(cutAlike(loopsOfA, loopsOfB, landmarks), still, 1.5, 8);
}

TEST(MatchHandles, ManyAreMatchedByDescent) {
  const Laid a = laid(plate(8));
  const HandleMatch best = matchHandles(a.cut, a.layout, a.cut, a.layout, {.aligned = true}).at(0);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(best.target[i], static_cast<int>(i));
    EXPECT_FALSE(best.swapped[i]);
  }
  EXPECT_NEAR(best.cost, 0, 1e-9);
}

TEST(Seamed, RimsLieOnRims) {
  const Laid a = laid(plate(2, 3)), b = laid(markedPlate(2));
  // Of three handles of b only as many as a has are used here; all matches are legal.
  for (const bool swapped : {false, true}) {
    HandleMatch match{.target = {2, 0},
                      .swapped = {swapped, !swapped},
                      .rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    const SeamedSurface s = seamed(a.cut, a.layout, b.cut, b.layout, match);
    const LayoutQuality quality =
        layoutQuality(s.cut.surface.triangles, s.cut.surface.vertices, s.layout);
    EXPECT_EQ(quality.flips, 0u);
    EXPECT_NEAR(quality.degree, 1, 1e-9);
    const HalfEdges edges(s.cut.surface.triangles);
    std::vector<Vec3> goal(s.cut.surface.vertices.size());
    std::vector<char> isFixed(goal.size(), 0);
    for (const auto& [v, p] : s.fixed) {
      goal[v] = pointOn(b.cut.surface, p);
      EXPECT_FALSE(isFixed[v]);
      isFixed[v] = 1;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const CutHandle &ha = s.cut.handles[i],
                      &hb = b.cut.handles[static_cast<std::size_t>(match.target[i])];
      ASSERT_EQ(ha.loop[0].size(), ha.loop[1].size());
      EXPECT_GE(ha.loop[0].size(), hb.loop[0].size());
      Points images;
      std::set<int> met;
      for (std::size_t k = 0; k < ha.loop[0].size(); ++k) {
        EXPECT_TRUE(isFixed[ha.loop[0][k]] && isFixed[ha.loop[1][k]]);
        images.push_back(goal[ha.loop[0][k]]);
        EXPECT_LT(norm(images.back() - goal[ha.loop[1][k]]), 1e-9);  // glued again
        for (const int w : hb.loop[0])
          if (norm(b.cut.surface.vertices[w] - images.back()) < 1e-12) met.insert(w);
      }
      // All of B's rim, once around, in the right direction.
      EXPECT_EQ(met.size(), hb.loop[0].size());
      std::vector<int> all(images.size());
      for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
      EXPECT_NEAR(lengthOf(images, all), lengthOf(b.cut.surface.vertices, hb.loop[0]), 1e-9);
      const auto turning = [](const Points& points) {
        Vec3 sum;
        for (std::size_t k = 0; k < points.size(); ++k)
          sum += cross(points[k] - points[0], points[(k + 1) % points.size()] - points[0]);
        return sum;
      };
      Points rim;
      for (const int w : hb.loop[0]) rim.push_back(b.cut.surface.vertices[w]);
      EXPECT_EQ(dot(turning(images), turning(rim)) > 0, !match.swapped[i]);
    }
  }
}

}  // namespace
}  // namespace innermap
