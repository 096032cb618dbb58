#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/transfer/push_pull.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

// Root mean square.
double pulledError(int resolution) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, resolution), to = levelSetOf(target, resolution);
  const PullResult out = pullGrids(map, source, *from, {sampledScalar(*to, "s")});
  double squares = 0;
  const std::size_t count = forInside<openvdb::FloatGrid>(
      *out.grids[0], *from,
      [&](const Vec3& p, float value) { squares += std::pow(value - smooth(map(p)), 2); });
  return std::sqrt(squares / static_cast<double>(count));
}

TEST(Pull, SecondOrder) { EXPECT_GT(pulledError(20) / pulledError(40), 3); }

TEST(PullRelease, PushAfterPullReturnsTheField) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, 64), to = levelSetOf(target, 64);
  const auto original = sampledScalar(*to, "s");
  const auto rest = pullGrids(map, source, *from, {original}, {.targetLevelSet = to.get()}).grids;
  const auto again = VolumePusher(source, rest).push(map, *to).grids[0];
  double error = 0;
  forInside<openvdb::FloatGrid>(*again, *to, [&](const Vec3& q, float value) {
    error = std::max(error, std::abs(value - smooth(q)));
  });
  // Two linear interpolations: twice h^2 / 8 times the second derivatives' trace of about 12.
  const double h = to->voxelSize()[0];
  EXPECT_LT(error, 2 * h * h / 8 * 12 * 1.5);
}

TEST(PullRelease, AroundTheSolidToo) {
  const HarmonicMap map = affineMap({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {5, 0, 0});
  const Solid source(ball());
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.05));
  grid->setName("smoke");
  const openvdb::CoordBBox box(openvdb::Coord(40, -60, -60), openvdb::Coord(160, 60, 60));
  for (auto ijk = box.begin(); ijk; ++ijk)
    grid->tree().setValueOn(*ijk, static_cast<float>(smooth(toVec3(grid->indexToWorld(*ijk)))));
  PullSettings settings;
  settings.outside.distance = 0.2;
  const auto out = pullGrids(map, source, *levelSetOf(source, 40), {grid}, settings).grids[0];
  const double reach = 0.2 * source.diagonal();
  double farthest = 0, error = 0;
  for (auto v = static_cast<const openvdb::FloatGrid&>(*out).cbeginValueOn(); v; ++v) {
    const Vec3 p = toVec3(out->transform().indexToWorld(v.getCoord()));
    farthest = std::max(farthest, norm(p));
    error = std::max(error, std::abs(*v - smooth(p + Vec3{5, 0, 0})));
  }
  EXPECT_NEAR(farthest, 1 + reach, 0.1);
  EXPECT_LT(error, 0.01);
}

TEST(Pull, RefusesWhatItCannotDo) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball());
  const auto from = levelSetOf(source, 16);
  EXPECT_THROW(pullGrids(map, source, *from, {sampledScalar(*from, "s")}, {.accuracy = 1}),
               SettingError);
  // Positions without the target's level set.
  const auto positions = sampledVector(*from, "P", openvdb::VEC_CONTRAVARIANT_ABSOLUTE);
  EXPECT_THROW(pullGrids(map, source, *from, {positions}), DataError);
  test::expectCancels([&] { pullGrids(map, source, *from, {sampledScalar(*from, "s")}, {}); });
}

}  // namespace
}  // namespace innermap
