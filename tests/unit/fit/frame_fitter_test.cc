#include "innermap/fit/frame_fitter.h"

#include <gtest/gtest.h>

#include "fit/test_pairs.h"
#include "innermap/core/error.h"
#include "innermap/field/harmonic_field.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

FrameFitterSettings few() { return {.sources = 400}; }

// At time t; at rest for t = 0. Quadratic in t, so that the parabola through three is exact.
Vec3 at(double t, const Vec3& p) {
  const Vec3 by = harmonicPolynomial(p) - p;
  return p + t * by + t * t * Vec3{0.1 * p.y, 0, -0.2 * p.x};
}

Vec3 velocity(double t, const Vec3& p) {
  const Vec3 by = harmonicPolynomial(p) - p;
  return by + 2 * t * Vec3{0.1 * p.y, 0, -0.2 * p.x};
}

Mesh frame(const Mesh& rest, double t) {
  return moved(rest, [t](const Vec3& p) { return at(t, p); });
}

Mesh scaled(const Mesh& mesh, const Vec3& size) {
  return moved(mesh, [&](const Vec3& p) { return Vec3{size.x * p.x, size.y * p.y, size.z * p.z}; });
}

TEST(FrameFitter, FitsEachFrameForItself) {
  const Mesh rest = ball();
  const FrameFitter fitter(makeSourceBoundary(rest), few());
  EXPECT_EQ(fitter.sources().size(), 400u);
  EXPECT_EQ(fitter.collocation(), 1200u);
  EXPECT_FALSE(fitter.iterative());
  fitter.fit(frame(rest, 1));
  const FrameFit after = fitter.fit(frame(rest, 0.5));
  const FrameFit alone = FrameFitter(makeSourceBoundary(rest), few()).fit(frame(rest, 0.5));
  EXPECT_LT(after.error.p99, 5e-3);  // what the triangles of the ball cut off, and little more
  const Vec3 p{0.2, 0.1, -0.3};
  EXPECT_LT(norm(HarmonicMap(after.field)(p) - at(0.5, p)), 5e-3);
  EXPECT_EQ(norm(HarmonicMap(after.field)(p) - HarmonicMap(alone.field)(p)), 0);
}

TEST(FrameFitter, ManyChargesAreSolvedForIteratively) {
  const Mesh rest = ball();
  const FrameFitter fitter(makeSourceBoundary(rest), {.sources = 4000});
  EXPECT_TRUE(fitter.iterative());
  EXPECT_EQ(fitter.sources().size(), 4500u);
  EXPECT_LT(fitter.fit(frame(rest, 1)).error.p99, 1e-3);
}

// A frame that passes through the rest meets it, without a jump: what is left is in proportion to
// how far the frame is from an affine image of the rest.
TEST(FrameFitterRelease, FramesNearTheRestAreMet) {
  for (const Mesh& rest : {ball(), shapes::torus(24, 12), scaled(ball(), {1, 1, 0.02}),
                           scaled(ball(), {1, 0.03, 0.03})})
    for (const std::size_t charges : {300u, 4000u}) {
      SCOPED_TRACE(rest.name + ", charges: " + std::to_string(charges));
      const FrameFitter fitter(makeSourceBoundary(rest), {.sources = charges});
      EXPECT_LT(fitter.fit(rest).error.max, 1e-12);
      EXPECT_LT(fitter.fit(moved(rest, affineMap)).error.max, 1e-12);
      for (const double t : {1e-3, 1e-6, 1e-9})
        EXPECT_LT(fitter.fit(frame(rest, t)).error.max, 1e-12 + 0.05 * t);
    }
}

class Velocity : public testing::Test {
 protected:
  const Mesh rest = ball();
  const FrameFitter fitter{makeSourceBoundary(rest), few()};
  const FrameFit before = fitter.fit(frame(rest, 0.25)), here = fitter.fit(frame(rest, 0.5)),
                 after = fitter.fit(frame(rest, 1));
  const Vec3 p{0.1, -0.3, 0.2};

  Vec3 value(const HarmonicField& field) const { return HarmonicMap(field)(p); }
};

// Frames 1, 2 and 4 at 4 frames a second: quarter seconds, unevenly spaced.
TEST_F(Velocity, IsTheDerivativeOfTheParabola) {
  const HarmonicField field =
      velocityAt({&here, 2}, NumberedFit{&before, 1}, NumberedFit{&after, 4}, 4);
  EXPECT_LT(norm(value(field) - velocity(0.5, p)), 1e-2);
}

TEST_F(Velocity, IsTheLineToOneNeighbour) {
  const Vec3 forward = value(velocityAt({&here, 2}, {}, NumberedFit{&after, 4}, 4));
  EXPECT_LT(norm(forward - 2.0 * (value(after.field) - value(here.field))), 1e-12);
  const Vec3 backward = value(velocityAt({&here, 2}, NumberedFit{&before, 1}, {}, 4));
  EXPECT_LT(norm(backward - 4.0 * (value(here.field) - value(before.field))), 1e-12);
}

TEST_F(Velocity, NeedsANeighbour) { EXPECT_THROW(velocityAt({&here, 2}, {}, {}, 24), DataError); }

// Frames 1 to 5 at times of a quarter of that, the third of them broken.
class Fits : public testing::Test {
 protected:
  const Mesh rest = ball(2);
  const FrameFitter fitter{makeSourceBoundary(rest), few()};
  std::vector<std::size_t> made;
  FrameFits fits{{1, 2, 3, 4, 5}, [this](std::size_t index) {
                   made.push_back(index);
                   if (index == 2) throw FileError("frame.3.obj", "cannot be read");
                   return fitter.fit(frame(rest, 0.25 * static_cast<double>(index + 1)));
                 }};
};

TEST_F(Fits, AreMadeOnceWhileVelocitiesNeedThem) {
  for (const std::size_t index : {0, 1}) {
    fits.at(index);
    fits.velocity(index, 24);
  }
  EXPECT_EQ(made, (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_THROW(fits.at(2), FileError);
}

// Frames 2 and 4, as 3 is broken: two thirds of a second about frame 3 at three frames a second.
TEST_F(Fits, VelocitiesPassOverBrokenFrames) {
  const HarmonicField field = fits.velocity(3, 3);
  const auto second = fits.at(1), fourth = fits.at(3), fifth = fits.at(4);
  const HarmonicField expected =
      velocityAt({fourth.get(), 4}, NumberedFit{second.get(), 2}, NumberedFit{fifth.get(), 5}, 3);
  const Vec3 p{0.1, -0.3, 0.2};
  EXPECT_LT(norm(HarmonicMap(field)(p) - HarmonicMap(expected)(p)), 1e-12);
}

TEST_F(Fits, OneFrameHasNoVelocity) {
  FrameFits alone({7}, [this](std::size_t) { return fitter.fit(rest); });
  EXPECT_THROW(alone.velocity(0, 24), DataError);
}

TEST(FrameFitter, RefusesFramesOfOtherConnectivityAndFarCharges) {
  const FrameFitter fitter(makeSourceBoundary(ball(2)), few());
  EXPECT_THROW(fitter.fit(ball(3)), DataError);
  EXPECT_THROW(FrameFitter(makeSourceBoundary(ball(2)), {.distance = 0.5}), SettingError);
}

TEST(FrameFitter, CountsItsMemory) {
  const std::uint64_t thousands = frameFitterMemory({});
  EXPECT_GT(frameFitterMemory({.sources = 100000}), 5 * thousands);
  EXPECT_EQ(frameCollocation({.sources = 100000}), 300000u);
}

TEST(FrameFitter, SaysWherePartsSlide) {
  const Mesh rest = shapes::joined(shapes::box({-1, -1, -1}, {1, 1, 1}),
                                   shapes::box({-0.4, -0.3, 0.5}, {0.4, 0.3, 2}));
  const FrameFitter fitter(makeSourceBoundary(rest), few());
  Mesh slid = rest;
  for (std::size_t v = slid.vertices.size() / 2; v < slid.vertices.size(); ++v)
    slid.vertices[v] += Vec3{0.06, 0.08, 0};
  const std::string said = fitter.fit(slid).jumps;
  EXPECT_NE(said.find("differ by up to 0.02"), std::string::npos) << said;
  EXPECT_EQ(fitter.fit(rest).jumps, "");
}

}  // namespace
}  // namespace innermap
