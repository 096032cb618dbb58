#include <gtest/gtest.h>
#include <openvdb/tools/Composite.h>

#include <functional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/transfer/push_pull.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

// Root mean square.
double scalarError(const HarmonicMap& map, int resolution, Sampling sampling) {
  const Solid source(ball()), target(moved(ball(), map));
  PushSettings settings;
  settings.carry.sampling = sampling;
  const auto from = levelSetOf(source, resolution), to = levelSetOf(target, resolution);
  const PushResult out = VolumePusher(source, {sampledScalar(*from, "s")}, settings).push(map, *to);
  EXPECT_EQ(out.statistics.failed, 0u);
  double squares = 0;
  const std::size_t count =
      forInside<openvdb::FloatGrid>(*out.grids[0], *to, [&](const Vec3& q, float value) {
        const double error = value - smooth(preimage(map, q, q));
        squares += error * error;
      });
  return std::sqrt(squares / static_cast<double>(count));
}

// Nearest: first order; linear: second; quadratic: third.
TEST(PushRelease, ScalarsConvergeWithTheOrderOfTheSampling) {
  const double ratios[] = {1.7, 3, 5};
  int k = 0;
  for (const Sampling sampling : {Sampling::nearest, Sampling::linear, Sampling::quadratic}) {
    const double coarse = scalarError(chargedMap(), 20, sampling),
                 fine = scalarError(chargedMap(), 40, sampling);
    EXPECT_GT(coarse / fine, ratios[k]) << "sampling " << k;
    ++k;
  }
}

TEST(PushRelease, RigidMotionsAndScalings) {
  const Mat3 r = rotation(0.5, 1.1);
  Mat3 scaled = r;
  for (auto& row : scaled)
    for (double& x : row) x *= 2.5;
  for (const Mat3& m : {r, scaled}) {
    const HarmonicMap map = affineMap(m, {10, -4, 2});
    const Solid source(ball()), target(moved(ball(), map));
    const auto from = levelSetOf(source, 40), to = levelSetOf(target, 40);
    const PushResult out = VolumePusher(source, {sampledScalar(*from, "s")}).push(map, *to);
    const Mat3 back = inverse(m);
    double error = 0;
    forInside<openvdb::FloatGrid>(*out.grids[0], *to, [&](const Vec3& q, float value) {
      error = std::max(error, std::abs(value - smooth(back * (q - Vec3{10, -4, 2}))));
    });
    EXPECT_LT(error, 6e-3);  // h^2 / 8 times the second derivatives
    EXPECT_EQ(out.statistics.inverted, out.statistics.voxels);
  }
}

// A target that the map misses by more of the source's voxels than attributes are continued by.
TEST(PushRelease, AttributesDoNotMeetTheBackgroundWhereTheTargetIsMissed) {
  Mat3 crushed{}, larger{};
  for (std::size_t k = 0; k < 3; ++k) {
    crushed[k][k] = 0.1;
    larger[k][k] = 0.16;
  }
  const Solid source(ball()), target(moved(ball(), affineMap(larger, {})));
  const auto from = levelSetOf(source, 40), to = levelSetOf(target, 40);
  const auto grid = sampledScalar(*from, "s");
  for (auto value = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)->beginValueOn(); value; ++value)
    value.setValue(5);
  const PushResult out = VolumePusher(source, {grid}).push(affineMap(crushed, {}), *to);
  forInside<openvdb::FloatGrid>(*out.grids[0], *to, [&](const Vec3& q, float value) {
    ASSERT_NEAR(value, 5, 1e-5) << "at radius " << norm(q);
  });
}

// A hollow ball, onto a target that the map misses by two voxels: outside it is the target's own
// surface, inside its own wall still.
TEST(Push, TheSurfaceOfTheSolidBecomesThatOfTheTarget) {
  Mat3 same{}, larger{};
  for (std::size_t k = 0; k < 3; ++k) {
    same[k][k] = 1;
    larger[k][k] = 1.1;
  }
  const Solid source(ball()), target(moved(ball(), affineMap(larger, {}))), wall(ball(0.6));
  const auto to = levelSetOf(target, 44);
  const LevelSetSettings lattice = onLatticeOf(source, {.resolution = 40});
  const auto hollow = openvdb::tools::csgDifferenceCopy(*makeLevelSet(source, lattice),
                                                        *makeLevelSet(wall, lattice));
  hollow->setGridClass(openvdb::GRID_LEVEL_SET);
  const PushResult out = VolumePusher(source, {hollow}).push(affineMap(same, {}), *to);
  const auto& carried = static_cast<const openvdb::FloatGrid&>(*out.grids[0]);
  const double voxel = carried.voxelSize()[0];
  double errors[2] = {0, 0};  // of the outer surface, and the wall
  std::size_t counts[2] = {0, 0};
  for (auto v = carried.cbeginValueOn(); v; ++v) {
    if (std::abs(*v) > 2 * voxel) continue;
    const auto q = carried.transform().indexToWorld(v.getCoord());
    const bool inner = q.length() < 0.8;
    const double distance =
        inner ? 0.6 - q.length() : static_cast<double>(to->tree().getValue(v.getCoord()));
    errors[inner] = std::max(errors[inner], std::abs(static_cast<double>(*v) - distance));
    ++counts[inner];
  }
  EXPECT_GT(counts[0], 1000u);
  EXPECT_GT(counts[1], 1000u);
  EXPECT_LT(errors[0], 0.15 * voxel);  // the surface goes through a mesh
  EXPECT_LT(errors[1], 0.15 * voxel);
}

// Maps whose inside has a closed form: the harmonic twist and bend (to first order the twist and
// bend of engineers) and a polynomial. Each by its own formulas, not the fitted map's.
struct ClosedForm {
  const char* name;
  std::function<Vec3(const Vec3&)> map;
  std::function<Mat3(const Vec3&)> jacobian;
};

std::vector<ClosedForm> closedForms() {
  return {{"twist",
           [](const Vec3& p) {
             return Vec3{p.x - 0.4 * p.y * p.z, p.y + 0.4 * p.x * p.z, p.z};
           },
           [](const Vec3& p) {
             return Mat3{{{1, -0.4 * p.z, -0.4 * p.y}, {0.4 * p.z, 1, 0.4 * p.x}, {0, 0, 1}}};
           }},
          {"bend",
           [](const Vec3& p) {
             return Vec3{p.x + 0.3 * p.x * p.z, p.y, p.z - 0.15 * (p.x * p.x - p.y * p.y)};
           },
           [](const Vec3& p) {
             return Mat3{{{1 + 0.3 * p.z, 0, 0.3 * p.x}, {0, 1, 0}, {-0.3 * p.x, 0.3 * p.y, 1}}};
           }},
          {"polynomial",
           [](const Vec3& p) {
             return Vec3{p.x + 0.2 * (p.x * p.x - p.z * p.z), p.y + 0.2 * p.x * p.y * p.z,
                         p.z + 0.3 * p.x * p.y};
           },
           [](const Vec3& p) {
             return Mat3{{{1 + 0.4 * p.x, 0, -0.4 * p.z},
                          {0.2 * p.y * p.z, 1 + 0.2 * p.x * p.z, 0.2 * p.x * p.y},
                          {0.3 * p.y, 0.3 * p.x, 1}}};
           }}};
}

Vec3 comesFrom(const ClosedForm& form, const Vec3& q) {
  Vec3 p = q;
  for (int i = 0; i < 8; ++i) p += inverse(form.jacobian(p)) * (q - form.map(p));
  return p;
}

struct Errors {
  double scalar = 0, gradient = 0, velocity = 0, mass = 0;
};

Errors closedFormErrors(const ClosedForm& form, int resolution) {
  const HarmonicMap map = fittedMap(form.map);
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, resolution), to = levelSetOf(target, resolution);
  auto density = sampled<openvdb::FloatGrid>(*from, "density", [](const Vec3& p) {
    return static_cast<float>(std::max(0.0, 0.9 - norm(p)) * smooth(p));
  });
  PushSettings settings;
  settings.carry.densities = {"density"};
  const PushResult out =
      VolumePusher(source,
                   {sampledScalar(*from, "s"), sampledVector(*from, "g", openvdb::VEC_COVARIANT),
                    sampledVector(*from, "v", openvdb::VEC_CONTRAVARIANT_RELATIVE), density},
                   settings)
          .push(map, *to);
  Errors e;
  double count = 0;
  forInside<openvdb::FloatGrid>(*out.grids[0], *to, [&](const Vec3& q, float value) {
    e.scalar += std::pow(value - smooth(comesFrom(form, q)), 2);
    ++count;
  });
  forInside<openvdb::Vec3SGrid>(*out.grids[1], *to, [&](const Vec3& q, const auto& value) {
    const Vec3 p = comesFrom(form, q),
               want = transposed(inverse(form.jacobian(p))) * smoothVector(p);
    e.gradient += squaredNorm(Vec3{value[0], value[1], value[2]} - want);
  });
  forInside<openvdb::Vec3SGrid>(*out.grids[2], *to, [&](const Vec3& q, const auto& value) {
    const Vec3 p = comesFrom(form, q), want = form.jacobian(p) * smoothVector(p);
    e.velocity += squaredNorm(Vec3{value[0], value[1], value[2]} - want);
  });
  for (double* sum : {&e.scalar, &e.gradient, &e.velocity}) *sum = std::sqrt(*sum / count);
  e.mass = std::abs(out.masses.at(0).after / out.masses.at(0).before - 1);
  return e;
}

TEST(PushRelease, TwistBendAndPolynomialAgreeWithTheirFormulas) {
  for (const ClosedForm& form : closedForms()) {
    SCOPED_TRACE(form.name);
    const Errors coarse = closedFormErrors(form, 24), fine = closedFormErrors(form, 48);
    EXPECT_GT(coarse.scalar / fine.scalar, 3);
    EXPECT_GT(coarse.gradient / fine.gradient, 3);
    EXPECT_GT(coarse.velocity / fine.velocity, 3);
    EXPECT_LT(fine.scalar, 5e-3);
    EXPECT_LT(fine.mass, 5e-3);
  }
}

// A rigid transfer leaves the energy of a deformation as it was: the energy densities of a map,
// pushed along a rigid motion and integrated.
TEST(PushRelease, RigidTransferKeepsTheEnergy) {
  const HarmonicMap map = affineMap(rotation(0.3, -0.8), {1, 2, 3});
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, 64), to = levelSetOf(target, 64);
  const MapGrids energies = evaluateMap(chargedMap(), source, *from);
  const auto pushed = VolumePusher(source, {energies.deformationEnergy}).push(map, *to).grids[0];
  const auto fog = makeFog(*to);
  auto share = fog->getConstAccessor();
  double total = 0;
  for (auto v = static_cast<const openvdb::FloatGrid&>(*pushed).cbeginValueOn(); v; ++v)
    total += *v * share.getValue(v.getCoord());
  total *= std::pow(to->voxelSize()[0], 3);
  EXPECT_NEAR(total / energies.deformationTotal, 1, 2e-3);
}

TEST(Push, FieldsAreCarriedAlong) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball()), target(moved(ball(), map));
  const auto to = levelSetOf(target, 32);
  const HarmonicMap velocity = affineMap({{{0, -1, 0}, {1, 0, 0}, {0, 0, 0}}}, {0, 0, 3});
  const VolumePusher pusher(source, {sampledScalar(*levelSetOf(source, 32), "s")});
  const PushResult out =
      pusher.push(map, *to, {{"v", velocity.field(), openvdb::VEC_CONTRAVARIANT_RELATIVE}});
  ASSERT_EQ(out.grids.size(), 2u);
  EXPECT_EQ(out.grids[1]->getName(), "v");
  EXPECT_EQ(out.grids[1]->getVectorType(), openvdb::VEC_CONTRAVARIANT_RELATIVE);
  double error = 0;
  forInside<openvdb::Vec3SGrid>(*out.grids[1], *to, [&](const Vec3& q, const auto& value) {
    const Vec3 e = velocity(preimage(map, q, q));
    for (int a = 0; a < 3; ++a) error = std::max(error, std::abs(value[a] - e[a]));
  });
  EXPECT_LT(error, 1e-4);
}

// As far as it goes while the shutter is open, and no farther.
TEST(PushRelease, VelocitiesGoOnAroundTheTarget) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball());
  const auto to = levelSetOf(Solid(moved(ball(), map)), 24);
  const HarmonicMap velocity = affineMap({{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}, {3, 0, 0});
  const VolumePusher pusher(source, {});
  std::vector<openvdb::CoordBBox> boxes;
  const double voxel = to->voxelSize()[0];
  for (const double shutter : {0.0, 2.5 * voxel / 3}) {
    const PushResult out = pusher.push(
        map, *to, {{"v", velocity.field(), openvdb::VEC_CONTRAVARIANT_RELATIVE, shutter}});
    const auto& grid = static_cast<const openvdb::Vec3SGrid&>(*out.grids[0]);
    for (auto v = grid.cbeginValueOn(); v; ++v) ASSERT_NEAR((*v)[0], 3, 1e-4);
    boxes.push_back(grid.evalActiveVoxelBoundingBox());
  }
  EXPECT_EQ(boxes[1].min(), boxes[0].min().offsetBy(-3));
  EXPECT_EQ(boxes[1].max(), boxes[0].max().offsetBy(3));
}

TEST(Push, OnePusherServesManyMaps) {
  const Solid source(ball());
  const auto grid = sampledScalar(*levelSetOf(source, 24), "s");
  const VolumePusher pusher(source, {grid});
  for (const double strength : {0.1, 0.3}) {
    const HarmonicMap map = chargedMap(strength);
    const auto to = levelSetOf(Solid(moved(ball(), map)), 24);
    const auto kept = pusher.push(map, *to).grids[0],
               anew = VolumePusher(source, {grid}).push(map, *to).grids[0];
    auto other = static_cast<const openvdb::FloatGrid&>(*anew).getConstAccessor();
    for (auto v = static_cast<const openvdb::FloatGrid&>(*kept).cbeginValueOn(); v; ++v)
      ASSERT_EQ(*v, other.getValue(v.getCoord()));
  }
}

TEST(Push, GridsOfOtherTransformsAreSampledWhereTheyAre) {
  const HarmonicMap map = affineMap(rotation(0, 0), {0, 0, 0});
  const Solid source(ball());
  // Turned, stretched and shifted voxels.
  auto grid = openvdb::FloatGrid::create();
  auto transform = openvdb::math::Transform::createLinearTransform(0.05);
  transform->postRotate(0.6, openvdb::math::Z_AXIS);
  transform->postScale(openvdb::Vec3d(1, 1.3, 0.8));
  transform->postTranslate(openvdb::Vec3d(0.01, 0.02, 0.03));
  grid->setTransform(transform);
  grid->setName("s");
  const openvdb::CoordBBox box(openvdb::Coord(-40), openvdb::Coord(40));
  for (auto ijk = box.begin(); ijk; ++ijk)
    grid->tree().setValueOn(*ijk,
                            static_cast<float>(smooth(toVec3(transform->indexToWorld(*ijk)))));
  const auto to = levelSetOf(source, 32);
  const auto out = VolumePusher(source, {grid}).push(map, *to).grids[0];
  double error = 0;
  forInside<openvdb::FloatGrid>(*out, *to, [&](const Vec3& q, float value) {
    error = std::max(error, std::abs(value - smooth(q)));
  });
  EXPECT_LT(error, 0.01);
}

TEST(PushRelease, WhatLiesAroundComesAlong) {
  const HarmonicMap map = affineMap({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {5, 0, 0});
  const Solid source(ball()), target(ball());
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  grid->setName("smoke");
  const openvdb::CoordBBox box(openvdb::Coord(-30), openvdb::Coord(30));
  for (auto ijk = box.begin(); ijk; ++ijk)
    grid->tree().setValueOn(*ijk, static_cast<float>(smooth(toVec3(grid->indexToWorld(*ijk)))));
  PushSettings settings;
  settings.outside.distance = 0.2;
  const auto to = levelSetOf(Solid(moved(ball(), map)), 24);
  const auto cut = VolumePusher(source, {grid}, settings).push(map, *to).grids[0];
  settings.outside.fadeTo = RigidMotion{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {5, 0, 0}};
  const auto faded = VolumePusher(source, {grid}, settings).push(map, *to).grids[0];
  const double reach = 0.2 * source.diagonal();
  double farthest = 0, error = 0;
  for (auto v = static_cast<const openvdb::FloatGrid&>(*cut).cbeginValueOn(); v; ++v) {
    const Vec3 p = toVec3(cut->transform().indexToWorld(v.getCoord())) - Vec3{5, 0, 0};
    farthest = std::max(farthest, norm(p));
    error = std::max(error, std::abs(*v - smooth(p)));
  }
  EXPECT_NEAR(farthest, 1 + reach, 0.2);
  EXPECT_LT(error, 0.03);
  EXPECT_EQ(cut->metaValue<std::string>("innermap_outside").find("extended"), 0u);
  // With a motion to fade to, all of it moves: a cube of 6 instead of a ball.
  std::size_t corner = 0;
  for (auto v = static_cast<const openvdb::FloatGrid&>(*faded).cbeginValueOn(); v; ++v) {
    const Vec3 p = toVec3(faded->transform().indexToWorld(v.getCoord())) - Vec3{5, 0, 0};
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 2.9) continue;
    corner += norm(p) > 4;
    ASSERT_NEAR(*v, smooth(p), 0.04);
  }
  EXPECT_GT(corner, 500u);
}

// A rest pose, and a frame turned and shifted from it.
class FramePushes : public testing::Test {
 protected:
  static FrameFitterSettings few() { return {.sources = 200}; }
  const HarmonicMap motion = affineMap(rotation(0.4, 0.2), {3, 0, 1});
  const FrameFitter fitter{makeSourceBoundary(ball()), few()};
  const FrameFit fit = fitter.fit(moved(ball(), motion));
  const openvdb::FloatGrid::Ptr grid = sampledScalar(*levelSetOf(fitter.solid(), 24), "s");

  FramePushSettings settings() const {
    FramePushSettings out;
    out.output.resolution = 24;
    return out;
  }
};

TEST_F(FramePushes, IsThePushOnTheRestPosesLattice) {
  const FramePusher pusher(fitter, {grid}, settings());
  const auto made = pusher.push({&fit, 5});
  const openvdb::GridBase& out = *made.result.grids[0];
  EXPECT_EQ(out.metaValue<std::int64_t>("innermap_frame"), 5);
  EXPECT_NEAR(out.voxelSize()[0], pusher.voxelSize(), 1e-12);
  EXPECT_EQ(out.transform(), levelSetOf(fitter.solid(), 24)->transform());
  const Solid target(moved(ball(), motion));
  const auto levelSet = makeLevelSet(target, onLatticeOf(fitter.solid(), settings().output));
  const PushResult plain =
      VolumePusher(fitter.solid(), {grid}).push(HarmonicMap(fit.field), *levelSet);
  EXPECT_EQ(out.activeVoxelCount(), plain.grids[0]->activeVoxelCount());
}

using FramePushesRelease = FramePushes;

TEST_F(FramePushesRelease, FadesToEachFramesOwnMotion) {
  FramePushSettings fading = settings();
  fading.push.outside.distance = 0.1;
  fading.fadeToFitted = true;
  auto around = sampledScalar(*levelSetOf(Solid(shapes::box({-2, -2, -2}, {2, 2, 2})), 40), "s");
  const auto made = FramePusher(fitter, {around}, fading).push({&fit, 1});
  const auto& out = static_cast<const openvdb::FloatGrid&>(*made.result.grids[0]);
  const Mat3 back = inverse(rotation(0.4, 0.2));
  double error = 0;
  for (auto v = out.cbeginValueOn(); v; ++v) {
    const Vec3 p = back * (toVec3(out.transform().indexToWorld(v.getCoord())) - Vec3{3, 0, 1});
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1.9)
      error = std::max(error, std::abs(*v - smooth(p)));
  }
  EXPECT_LT(error, 0.05);
}

TEST(Push, SaysWhatIsNotThere) {
  const Solid source(ball());
  auto far = sampledScalar(*levelSetOf(source, 16), "far");
  far->transform().postTranslate(openvdb::Vec3d(100, 0, 0));
  EXPECT_THROW(VolumePusher(source, {far}), DataError);
  const auto near = sampledScalar(*levelSetOf(source, 16), "near");
  const PushResult out =
      VolumePusher(source, {far, near})
          .push(chargedMap(), *levelSetOf(Solid(moved(ball(), chargedMap())), 16));
  ASSERT_EQ(out.warnings.size(), 1u);
  EXPECT_NE(out.warnings[0].find("far"), std::string::npos);
}

}  // namespace
}  // namespace innermap
