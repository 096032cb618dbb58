#include "surface/detail/torus/torus_candidates.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/expect.h"
#include "innermap/core/run.h"
#include "innermap/mesh/mesh_file.h"
#include "surface/detail/refining/locate.h"
#include "surface/detail/torus/torus_layout.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

using shapes::closed;

void expectValid(const ClosedSurface& a, const TorusCandidate& candidate, const Layout& onB) {
  const LayoutQuality quality = layoutQuality(a.triangles, a.vertices, candidate.image);
  EXPECT_EQ(quality.flips, 0u);
  EXPECT_NEAR(quality.degree, 1, 1e-9);
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(squaredNorm(candidate.image.period[i] - onB.period[i]), 0.0);
}

// A ring with a bump, so that nothing of it is symmetric.
ClosedSurface bumpyTorus(int n, int m) {
  ClosedSurface out = closed(shapes::torus(n, m), 1);
  for (Vec3& p : out.vertices) {
    const double bump = std::exp(-4 * squaredNorm(p - Vec3{1, 0.2, 0.35}));
    p += bump * Vec3{0.2, 0.1, 0.5};
    p.x *= 1.3;
  }
  return out;
}

Vec3 onSurface(const ClosedSurface& b, const Locator& locator, const Vec3& p) {
  const Located where = locator.find(p);
  const std::array<double, 3> w = locator.barycentric(p, where);
  Vec3 out;
  for (int k = 0; k < 3; ++k) out += w[k] * b.vertices[b.triangles[where.triangle][k]];
  return out;
}

// Median distance of A's image on B from where A's vertices themselves are.
double medianDistance(const ClosedSurface& a, const ClosedSurface& b, const Layout& onB,
                      const Layout& image, const Mat3& turn) {
  const Locator locator(b.triangles, onB);
  std::vector<double> distances;
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    distances.push_back(norm(onSurface(b, locator, image.place[v]) - turn * a.vertices[v]));
  std::nth_element(distances.begin(),
                   distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return distances[distances.size() / 2];
}

constexpr Mat3 kStill = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(TorusCandidates, FindASurfaceOnItselfInAnotherPose) {
  const Mat3 turn = {{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}};
  const ClosedSurface a = bumpyTorus(64, 32);
  ClosedSurface b = bumpyTorus(50, 40);
  for (Vec3& p : b.vertices) p = turn * p;
  const Layout onA = layOutTorus(a), onB = layOutTorus(b);
  const std::vector<TorusCandidate> found = torusCandidates(a, onA, b, onB, {.count = 4});
  ASSERT_EQ(found.size(), 4u);
  for (const TorusCandidate& c : found) expectValid(a, c, onB);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i - 1].cost, found[i].cost);
  EXPECT_LT(found[0].cost, 0.02);
  EXPECT_LT(medianDistance(a, b, onB, found[0].image, turn), 0.15);
}

TEST(TorusCandidates, ShiftsFollowTheLatticeMap) {
  // All candidates, twisted and reversed: meridians must go to plus or minus meridians.
  const ClosedSurface a = bumpyTorus(24, 16), b = closed(shapes::torus(30, 12, 1, 0.5), 1);
  const Layout onA = layOutTorus(a), onB = layOutTorus(b);
  TorusSearch settings{.count = 64};
  bool reversed = false, twisted = false;
  for (const TorusCandidate& c : torusCandidates(a, onA, b, onB, settings)) {
    expectValid(a, c, onB);
    reversed = reversed || c.reversed;
    twisted = twisted || c.twist != 0;
    // Places and shifts say the same: edges are short.
    double longest = 0;
    for (std::size_t t = 0; t < a.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int i = static_cast<int>(t);
        longest = std::max(longest, norm(c.image.corner(a.triangles, i, k) -
                                         c.image.corner(a.triangles, i, (k + 1) % 3)));
      }
    EXPECT_LT(longest, std::abs(c.twist) > 1 ? 4 : 2.5);
    const Points curve = meridianCurve(a, c.image);
    double length = 0;
    for (std::size_t i = 0; i < curve.size(); ++i)
      length += norm(curve[(i + 1) % curve.size()] - curve[i]);
    EXPECT_LT(length, 3.5);
  }
  EXPECT_TRUE(reversed);
  EXPECT_TRUE(twisted);
}

TEST(TorusCandidates, AlignedPosesAgreeInTheirNormals) {
  const ClosedSurface a = closed(shapes::torus(60, 30), 1), b = closed(shapes::torus(48, 36), 1);
  const Layout onA = layOutTorus(a), onB = layOutTorus(b);
  const std::vector<TorusCandidate> found = torusCandidates(a, onA, b, onB, {.aligned = true});
  EXPECT_LT(medianDistance(a, b, onB, found.at(0).image, kStill), 0.1);
}

TEST(TorusCandidates, LandmarksSayWhatSymmetryCannot) {
  const ClosedSurface a = closed(shapes::torus(60, 30), 1), b = closed(shapes::torus(48, 36), 1);
  const Layout onA = layOutTorus(a), onB = layOutTorus(b);
  TorusSearch settings;
  for (const auto& [i, j] : {std::pair{0, 0}, {0, 3}, {6, 3}, {9, 1}, {3, 4}})
    settings.landmarks.push_back({onA.place[i * 5 * 30 + j * 5], onB.place[i * 4 * 36 + j * 6]});
  const std::vector<TorusCandidate> found = torusCandidates(a, onA, b, onB, settings);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(medianDistance(a, b, onB, found[0].image, kStill), 0.1);
  // One landmark fixes the place alone.
  settings.landmarks.resize(1);
  for (const TorusCandidate& c : torusCandidates(a, onA, b, onB, settings))
    EXPECT_LT(norm(onSurface(b, Locator(b.triangles, onB), c.image.place[0]) - b.vertices[0]),
              1e-9);
}

TEST(TorusCandidates, SameForAnyNumberOfThreadsAndCancelled) {
  const ClosedSurface a = bumpyTorus(24, 16), b = closed(shapes::torus(30, 12), 1);
  const Layout onA = layOutTorus(a), onB = layOutTorus(b);
  TorusSearch settings{.grid = 8};
  const double cost = torusCandidates(a, onA, b, onB, settings).at(0).cost;
  {
    const ThreadLimit one(1);
    EXPECT_EQ(torusCandidates(a, onA, b, onB, settings).at(0).cost, cost);
  }
  test::expectCancels([&] { torusCandidates(a, onA, b, onB, settings); });
}

TEST(TorusCandidatesModelsRelease, RockerArmOntoATorusAndBack) {
  const std::string folder = INNERMAP_MODELS;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const ClosedSurface a = closed(readMesh(folder + "/rocker-arm.obj"), 1),
                      b = closed(shapes::torus(96, 48), 1);
  const Layout onA = layOutTorus(a), onB = layOutTorus(b);
  for (const TorusCandidate& c : torusCandidates(a, onA, b, onB)) expectValid(a, c, onB);
  for (const TorusCandidate& c : torusCandidates(b, onB, a, onA)) expectValid(b, c, onA);
}

}  // namespace
}  // namespace innermap
