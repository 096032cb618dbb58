// What becomes of each kind of grid, against closed forms, through push and pull.
#include "innermap/transfer/carry.h"

#include <gtest/gtest.h>
#include <openvdb/tools/ChangeBackground.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/transfer/push_pull.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

struct Pair {
  HarmonicMap map;
  Solid source, target;
  openvdb::FloatGrid::Ptr from, to;  // level sets

  Pair(const HarmonicMap& m, int resolution)
      : map(m),
        source(ball()),
        target(moved(ball(), m)),
        from(levelSetOf(source, resolution)),
        to(levelSetOf(target, resolution)) {}

  openvdb::GridPtrVec push(const openvdb::GridPtrVec& grids, const CarrySettings& carry) const {
    return VolumePusher(source, grids, {.carry = carry}).push(map, *to).grids;
  }
  openvdb::GridPtrVec pull(const openvdb::GridPtrVec& grids, const CarrySettings& carry) const {
    return pullGrids(map, source, *from, grids, {.carry = carry, .targetLevelSet = to.get()}).grids;
  }
};

// Root mean square length of the difference, over the voxels well inside the target, from
// expected(source point, Jacobian there).
template <class Expected>
double vectorError(const Pair& pair, const openvdb::GridBase& grid, const Expected& expected) {
  double squares = 0;
  const std::size_t count = forInside<
      openvdb::Vec3SGrid>(grid, *pair.to, [&](const Vec3& q, const openvdb::Vec3f& value) {
    const Vec3 p = preimage(pair.map, q, q);
    squares += squaredNorm(Vec3{value[0], value[1], value[2]} - expected(p, pair.map.jacobian(p)));
  });
  EXPECT_GT(count, 100u);
  return std::sqrt(squares / static_cast<double>(count));
}

double pushedVectorError(int resolution, openvdb::VecType type) {
  const Pair pair(chargedMap(), resolution);
  const auto out = pair.push({sampledVector(*pair.from, "v", type)}, {});
  EXPECT_EQ(out[0]->getVectorType(), type);
  return vectorError(pair, *out[0], [&](const Vec3& p, const Mat3& j) -> Vec3 {
    const Vec3 v = smoothVector(p);
    switch (type) {
      case openvdb::VEC_COVARIANT:
        return transposed(inverse(j)) * v;
      case openvdb::VEC_COVARIANT_NORMALIZE:
        return transposed(inverse(j)) * v / norm(transposed(inverse(j)) * v);
      case openvdb::VEC_CONTRAVARIANT_RELATIVE:
        return j * v;
      default:
        return v;
    }
  });
}

class VectorTypes : public testing::TestWithParam<openvdb::VecType> {};

// Linear sampling: second order in the voxels' size.
TEST_P(VectorTypes, MoveAsTheyShould) {
  const double coarse = pushedVectorError(20, GetParam()), fine = pushedVectorError(40, GetParam());
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(fine, coarse / 3);
}

INSTANTIATE_TEST_SUITE_P(Carry, VectorTypes,
                         testing::Values(openvdb::VEC_INVARIANT, openvdb::VEC_COVARIANT,
                                         openvdb::VEC_COVARIANT_NORMALIZE,
                                         openvdb::VEC_CONTRAVARIANT_RELATIVE));

TEST(CarryRelease, PositionsAreMapped) {
  const Pair pair(chargedMap(), 32);
  // Positions inside the ball: the points themselves, drawn in by a third.
  auto grid = sampled<openvdb::Vec3SGrid>(*pair.from, "P", [](const Vec3& p) {
    return openvdb::Vec3f(openvdb::Vec3d(p.x, p.y, p.z) / 3);
  });
  grid->setVectorType(openvdb::VEC_CONTRAVARIANT_ABSOLUTE);
  const auto pushed = pair.push({grid}, {});
  EXPECT_LT(
      vectorError(pair, *pushed[0], [&](const Vec3& p, const Mat3&) { return pair.map(p / 3); }),
      1e-5);
  const auto back = pair.pull(pushed, {});
  double error = 0;
  forInside<openvdb::Vec3SGrid>(*back[0], *pair.from, [&](const Vec3& p, const auto& value) {
    for (int a = 0; a < 3; ++a) error = std::max(error, std::abs(value[a] - p[a] / 3));
  });
  EXPECT_LT(error, 2e-3);  // sampled linearly once more
}

TEST(CarryRelease, PullIsTheOtherWayRound) {
  const Pair pair(chargedMap(), 48);
  for (const openvdb::VecType type :
       {openvdb::VEC_COVARIANT, openvdb::VEC_CONTRAVARIANT_RELATIVE}) {
    const auto out = pair.pull({sampledVector(*pair.to, "v", type)}, {});
    double error = 0;
    forInside<openvdb::Vec3SGrid>(*out[0], *pair.from, [&](const Vec3& p, const auto& value) {
      const Mat3 j = pair.map.jacobian(p);
      const Vec3 v = smoothVector(pair.map(p)),
                 e = (type == openvdb::VEC_COVARIANT ? transposed(j) : inverse(j)) * v;
      for (int a = 0; a < 3; ++a) error = std::max(error, std::abs(value[a] - e[a]));
    });
    EXPECT_LT(error, 0.015);
  }
}

constexpr int kPart[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
const char* const kPartName[6] = {".xx", ".yy", ".zz", ".xy", ".yz", ".xz"};

Mat3 tensorAt(const Vec3& p) {
  Mat3 s;
  for (int k = 0; k < 6; ++k)
    s[kPart[k][0]][kPart[k][1]] = s[kPart[k][1]][kPart[k][0]] =
        smooth({p.x + 0.3 * k, p.y, p.z - 0.2 * k});
  return s;
}

openvdb::GridPtrVec tensorGrids(const Pair& pair, const std::string& name) {
  openvdb::GridPtrVec grids;
  for (int k = 0; k < 6; ++k)
    grids.push_back(sampled<openvdb::FloatGrid>(
        *pair.from, name + kPartName[k],
        [k](const Vec3& p) { return static_cast<float>(tensorAt(p)[kPart[k][0]][kPart[k][1]]); }));
  return grids;
}

double tensorError(int resolution, bool stress) {
  const Pair pair(chargedMap(), resolution);
  CarrySettings carry;
  (stress ? carry.stresses : carry.strains) = {"t"};
  const auto out = pair.push(tensorGrids(pair, "t"), carry);
  double error = 0;
  for (int k = 0; k < 6; ++k)
    forInside<openvdb::FloatGrid>(*out[k], *pair.to, [&](const Vec3& q, float value) {
      const Vec3 p = preimage(pair.map, q, q);
      const Mat3 j = pair.map.jacobian(p), b = inverse(j), s = tensorAt(p);
      Mat3 e =
          stress ? product(j, product(s, transposed(j))) : product(transposed(b), product(s, b));
      const double scale = stress ? determinant(j) : 1;
      error = std::max(error, std::abs(value - e[kPart[k][0]][kPart[k][1]] / scale));
    });
  return error;
}

TEST(CarryRelease, TensorsAgreeWithClosedForms) {
  for (const bool stress : {true, false}) {
    const double coarse = tensorError(16, stress), fine = tensorError(32, stress);
    EXPECT_LT(coarse, 0.1) << stress;
    EXPECT_LT(fine, coarse / 2.5) << stress;  // largest errors: their places jump
  }
}

TEST(Carry, TensorsByRowsAreTheSame) {
  const Pair pair(chargedMap(), 24);
  openvdb::GridPtrVec rows;
  for (int r = 0; r < 3; ++r)
    rows.push_back(
        sampled<openvdb::Vec3SGrid>(*pair.from, std::string("t.") + "xyz"[r], [r](const Vec3& p) {
          const Mat3 t = tensorAt(p);
          return openvdb::Vec3f(openvdb::Vec3d(t[r][0], t[r][1], t[r][2]));
        }));
  CarrySettings carry{.stresses = {"t"}};
  const auto byRows = pair.push(rows, carry), byParts = pair.push(tensorGrids(pair, "t"), carry);
  double error = 0;
  for (int k = 0; k < 6; ++k) {
    auto row = openvdb::gridPtrCast<openvdb::Vec3SGrid>(byRows[kPart[k][0]])->getConstAccessor();
    for (auto v = static_cast<const openvdb::FloatGrid&>(*byParts[k]).cbeginValueOn(); v; ++v)
      error = std::max<double>(error, std::abs(row.getValue(v.getCoord())[kPart[k][1]] - *v));
  }
  EXPECT_LT(error, 1e-5);
}

TEST(CarryRelease, DensitiesKeepTheirMass) {
  const Pair pair(chargedMap(), 128);
  // Some of it inside, none at the surface: the integral is exact but for the sampling.
  auto grid = sampled<openvdb::FloatGrid>(*pair.from, "density", [](const Vec3& p) {
    return static_cast<float>(std::max(0.0, 0.9 - norm(p)) * smooth(p));
  });
  PushSettings settings;
  settings.carry.allDensities = true;
  const PushResult out = VolumePusher(pair.source, {grid}, settings).push(pair.map, *pair.to);
  ASSERT_EQ(out.masses.size(), 1u);
  EXPECT_NEAR(out.masses[0].after / out.masses[0].before, 1, 5e-3);
  // What it is without: the volume changes by more than that.
  settings.carry.allDensities = false;
  double sum = 0;
  const auto plain = VolumePusher(pair.source, {grid}, settings).push(pair.map, *pair.to).grids[0];
  for (auto v = static_cast<const openvdb::FloatGrid&>(*plain).cbeginValueOn(); v; ++v) sum += *v;
  sum *= std::pow(plain->voxelSize()[0], 3);
  EXPECT_GT(std::abs(sum / out.masses[0].before - 1), 0.01);
}

TEST(Carry, WholeNumbersAndTruthValuesComeFromTheNearestVoxel) {
  const Pair pair(affineMap(rotation(0.4, 0.7), {3, 1, -2}), 32);
  const auto half = [](const Vec3& p) { return p.x > 0; };
  const auto ints = sampled<openvdb::Int32Grid>(*pair.from, "id",
                                                [&](const Vec3& p) { return half(p) ? 7 : -3; });
  const auto longs = sampled<openvdb::Int64Grid>(
      *pair.from, "long", [&](const Vec3& p) { return half(p) ? std::int64_t{1} << 40 : 5; });
  const auto bools = sampled<openvdb::BoolGrid>(*pair.from, "flag", half);
  const auto out = pair.push({ints, longs, bools}, {});
  const double voxel = pair.from->voxelSize()[0];
  const auto check = [&](const auto& typed, auto yes, auto no) {
    using Grid = std::decay_t<decltype(typed)>;
    std::size_t wrong = 0;
    forInside<Grid>(typed, *pair.to, [&](const Vec3& q, const auto& value) {
      const Vec3 p = preimage(pair.map, q, q);
      if (std::abs(p.x) > voxel && value != (half(p) ? yes : no)) ++wrong;
    });
    EXPECT_EQ(wrong, 0u) << typed.getName();
  };
  check(static_cast<const openvdb::Int32Grid&>(*out[0]), 7, -3);
  check(static_cast<const openvdb::Int64Grid&>(*out[1]), std::int64_t{1} << 40, std::int64_t{5});
  check(static_cast<const openvdb::BoolGrid&>(*out[2]), true, false);
}

TEST(Carry, MasksMoveTheirActiveVoxels) {
  const Pair pair(affineMap(rotation(0.4, 0.7), {3, 1, -2}), 32);
  auto mask = openvdb::MaskGrid::create();
  mask->setTransform(pair.from->transform().copy());
  mask->setName("region");
  const auto all = sampledScalar(*pair.from, "all");
  for (auto v = all->cbeginValueOn(); v; ++v)
    if (all->transform().indexToWorld(v.getCoord()).x() > 0) mask->tree().setValueOn(v.getCoord());
  const auto out = pair.push({mask}, {});
  const auto& pushed = static_cast<const openvdb::MaskGrid&>(*out[0]);
  std::size_t wrong = 0;
  const double voxel = pair.from->voxelSize()[0];
  for (auto v = pair.to->cbeginValueOn(); v; ++v) {
    if (*v > 0) continue;
    const Vec3 q = toVec3(pair.to->transform().indexToWorld(v.getCoord())),
               p = preimage(pair.map, q, q);
    if (std::abs(p.x) > voxel && pushed.tree().isValueOn(v.getCoord()) != (p.x > 0)) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
}

TEST(CarryRelease, LevelSetsBecomeDistancesAgain) {
  const Pair pair(affineMap({{{1.5, 0, 0}, {0, 1.5, 0}, {0, 0, 1.5}}}, {0, 0, 0}), 64);
  const Solid inner(ball(0.6));
  const auto out = pair.push({makeLevelSet(inner, {.voxelSize = pair.from->voxelSize()[0]})}, {});
  const auto& surface = static_cast<const openvdb::FloatGrid&>(*out[0]);
  EXPECT_EQ(surface.getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(surface.getName(), "surface");
  const double voxel = surface.voxelSize()[0];
  double error = 0;
  std::size_t count = 0;
  for (auto v = surface.cbeginValueOn(); v; ++v) {
    if (std::abs(*v) > 2 * voxel) continue;  // the rebuilt band's last voxels are less exact
    const Vec3 q = toVec3(surface.transform().indexToWorld(v.getCoord()));
    error = std::max(error, std::abs(*v - (norm(q) - 0.9)));
    ++count;
  }
  EXPECT_GT(count, 1000u);
  EXPECT_LT(error, 0.15 * voxel);  // the ball is a polyhedron, and the surface goes through a mesh
  EXPECT_LT(surface.tree().getValue(
                openvdb::Coord::round(surface.transform().worldToIndex(openvdb::Vec3d(0)))),
            0);
}

TEST(Carry, NamesClassesBackgroundsAndMetadataStay) {
  const Pair pair(chargedMap(), 24);
  auto grid = sampledScalar(*pair.from, "heat");
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setSaveFloatAsHalf(true);
  grid->insertMeta("made_by", openvdb::StringMetadata("me"));
  openvdb::tools::changeBackground(grid->tree(), 0.25f);
  const auto out = pair.push({grid}, {});
  const auto& pushed = static_cast<const openvdb::FloatGrid&>(*out[0]);
  EXPECT_EQ(pushed.getName(), "heat");
  EXPECT_EQ(pushed.getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_TRUE(pushed.saveFloatAsHalf());
  EXPECT_EQ(pushed.metaValue<std::string>("made_by"), "me");
  EXPECT_FLOAT_EQ(pushed.background(), 0.25f);
  EXPECT_EQ(pushed.transform(), pair.to->transform());
  // Active: the target's inside and a skin of two voxels, nothing else.
  auto distance = pair.to->getConstAccessor();
  for (auto v = pushed.cbeginValueOn(); v; ++v)
    ASSERT_LE(distance.getValue(v.getCoord()), 2 * pair.to->voxelSize()[0] * (1 + 1e-6));
  for (auto v = pair.to->cbeginValueOn(); v; ++v)
    if (*v < 1.99 * pair.to->voxelSize()[0]) {
      ASSERT_TRUE(pushed.tree().isValueOn(v.getCoord()));
    }
}

// A colour that ends at the surface must not darken along it.
TEST(Carry, AttributesAreContinuedBeyondTheSurface) {
  const Pair pair(chargedMap(), 32);
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(pair.from->transform().copy());
  grid->setName("tint");
  const auto all = sampledScalar(*pair.from, "all");
  auto distance = pair.from->getConstAccessor();
  for (auto v = all->cbeginValueOn(); v; ++v)
    if (distance.getValue(v.getCoord()) < 0) grid->tree().setValueOn(v.getCoord(), 1.f);
  const auto out = pair.push({grid}, {});
  const auto& pushed = static_cast<const openvdb::FloatGrid&>(*out[0]);
  for (auto v = pushed.cbeginValueOn(); v; ++v) ASSERT_NEAR(*v, 1, 1e-6);
  // A fog's edge is the fog's own.
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  const auto fog = pair.push({grid}, {});
  float least = 1;
  for (auto v = static_cast<const openvdb::FloatGrid&>(*fog[0]).cbeginValueOn(); v; ++v)
    least = std::min(least, *v);
  EXPECT_LT(least, 0.1f);
}

TEST(Carry, RefusesWhatMakesNoSense) {
  const Pair pair(chargedMap(), 16);
  const auto scalar = sampledScalar(*pair.from, "s");
  EXPECT_THROW(pair.push({scalar}, {.densities = {"missing"}}), DataError);
  EXPECT_THROW(pair.push({scalar}, {.stresses = {"s"}}), DataError);
  EXPECT_THROW(
      pair.push({sampledVector(*pair.from, "v", openvdb::VEC_INVARIANT)}, {.densities = {"v"}}),
      DataError);
  auto grids = tensorGrids(pair, "t");
  grids.pop_back();
  test::expectRefused<DataError>([&] { pair.push(grids, {.stresses = {"t"}}); }, "t.xz");
  EXPECT_THROW(pair.push(tensorGrids(pair, "t"), {.stresses = {"t"}, .strains = {"t"}}), DataError);
}

TEST(VoxelGrowth, FollowsTheSolidsBeyondATenth) {
  EXPECT_NEAR(voxelGrowth(1, 8), 2, 1e-12);
  EXPECT_NEAR(voxelGrowth(8, 1), 0.5, 1e-12);
  EXPECT_EQ(voxelGrowth(1, 1.3), 1);  // 1.09
  EXPECT_GT(voxelGrowth(1, 1.4), 1.1);
  EXPECT_EQ(voxelGrowth(0, 1), 1);
  EXPECT_EQ(volumeRatio(2, 5), 2.5);
}

}  // namespace
}  // namespace innermap
