// Densities carried by push: their mass, their values, and what the figures say of them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "innermap/transfer/push_pull.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

// One density in it, named "density".
PushResult pushed(const ComposedMap& map, const Solid& source, const openvdb::FloatGrid& target,
                  const openvdb::GridBase::Ptr& grid, PushSettings settings = {}) {
  settings.carry.densities = {grid->getName()};
  return VolumePusher(source, {grid}, settings).push(map, target);
}

// Values drawn for all voxels of a lattice of 1 / across that are about the unit ball.
template <class Grid>
typename Grid::Ptr randomDensity(double across, const openvdb::math::Mat4d& turned, Draws& draw) {
  auto grid = Grid::create();
  auto transform = openvdb::math::Transform::createLinearTransform(1 / across);
  transform->postMult(turned);
  grid->setTransform(transform);
  grid->setName("density");
  auto accessor = grid->getAccessor();
  openvdb::CoordBBox box;
  for (int corner = 0; corner < 8; ++corner)
    box.expand(transform->worldToIndexNodeCentered(
        1.2 * openvdb::Vec3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)));
  for (auto ijk = box.begin(); ijk; ++ijk)
    if (draw() < 0.7)
      accessor.setValue(*ijk, static_cast<typename Grid::ValueType>(std::pow(draw(), 4)));
  return grid;
}

// Visits a tile once, with the sum of its values.
template <class Grid, class Visit>
void forValues(const openvdb::GridBase& grid, const Visit& visit) {
  for (auto value = static_cast<const Grid&>(grid).cbeginValueOn(); value; ++value)
    visit(toVec3(grid.transform().indexToWorld(value.getCoord())),
          static_cast<double>(*value) * static_cast<double>(value.getVoxelCount()));
}

// As one would sum a file: voxels whose centre is in the solid, or all.
template <class Grid>
double summed(const openvdb::GridBase& grid, const Solid* solid) {
  double sum = 0;
  forValues<Grid>(grid, [&](const Vec3& p, double value) {
    if (!solid || solid->inside(p)) sum += value;
  });
  return sum * std::abs(grid.transform().baseMap()->determinant());
}

template <class Grid>
double largest(const openvdb::GridBase& grid) {
  double out = 0;
  forValues<Grid>(grid, [&](const Vec3&, double value) { out = std::max(out, value); });
  return out;
}

template <class Grid>
void expectMassKept(const ComposedMap& map, const Mesh& image, std::uint64_t seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Draws draw(seed);
  openvdb::math::Mat4d turned = openvdb::math::Mat4d::identity();
  turned.postRotate(openvdb::math::Z_AXIS, 3 * draw());
  turned.postScale(openvdb::Vec3d(1, 0.8 + draw(), 0.6 + draw()));
  turned.setTranslation(openvdb::Vec3d(draw(), draw(), draw()) / 10);
  const auto grid = randomDensity<Grid>(12 + 20 * draw(), turned, draw);
  const Solid source(ball());
  const auto to = levelSetOf(Solid(image), 16 + static_cast<int>(32 * draw()));
  const PushResult out = pushed(map, source, *to, grid);
  const CarriedMass& mass = out.masses.at(0);
  const double before = summed<Grid>(*grid, &source), after = summed<Grid>(*out.grids[0], nullptr);
  EXPECT_NEAR(mass.before / before, 1, 1e-9);
  EXPECT_NEAR((mass.before + mass.left) / summed<Grid>(*grid, nullptr), 1, 1e-9);
  EXPECT_NEAR(after / before, 1, 1e-5);
  EXPECT_NEAR(mass.after / after, 1, 1e-9);
  EXPECT_LE(largest<Grid>(*out.grids[0]), largest<Grid>(*grid) * mass.largestRatio * (1 + 1e-6));
}

TEST(PushDensityRelease, KeepsMassWhateverTheMap) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const HarmonicMap charged = chargedMap(0.1 * static_cast<double>(seed));
    expectMassKept<openvdb::FloatGrid>(charged, moved(ball(), charged), seed);
    const HarmonicMap turned = affineMap(rotation(0.7, -0.4), {3, 1, 2});
    expectMassKept<openvdb::DoubleGrid>(ComposedMap({charged, turned}),
                                        moved(moved(ball(), charged), turned), 10 + seed);
  }
}

// (x, y, z^2 - x^2) folds at z = 0, (x, y, 0) leaves no volume at all, mirrored is none folded.
TEST(PushDensityRelease, KeepsMassInFolds) {
  const Mesh around = shapes::box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5});
  const HarmonicMap folded = fittedMap([](const Vec3& p) {
    return Vec3{p.x, p.y, p.z * p.z - p.x * p.x};
  });
  const HarmonicMap flat = affineMap({{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}}, {0, 0, 0.01});
  const HarmonicMap mirrored = affineMap({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 0});
  for (const HarmonicMap& map : {folded, flat, mirrored})
    expectMassKept<openvdb::FloatGrid>(map, around, 5);
  const auto foldedCells = [&](const HarmonicMap& map) {
    const Solid source(ball());
    const auto grid = sampledScalar(*levelSetOf(source, 24), "density");
    const CarriedMass mass = pushed(map, source, *levelSetOf(Solid(around), 32), grid).masses.at(0);
    return static_cast<double>(mass.foldedCells) / static_cast<double>(mass.cells);
  };
  EXPECT_NEAR(foldedCells(folded), 0.5, 0.05);
  EXPECT_EQ(foldedCells(mirrored), 0);
}

TEST(PushDensity, LimitLeavesOutWhatIsBeyond) {
  const HarmonicMap map = affineMap({{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}}, {0, 0, 0});
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, 32), to = levelSetOf(target, 32);
  const auto grid = sampled<openvdb::FloatGrid>(*from, "density", [](const Vec3&) { return 3.f; });
  PushSettings settings;
  const CarriedMass all = pushed(map, source, *to, grid, settings).masses.at(0);
  EXPECT_EQ(all.cut, 0);
  settings.carry.densityLimit = 1.5;  // it doubles
  const PushResult out = pushed(map, source, *to, grid, settings);
  const CarriedMass& mass = out.masses.at(0);
  EXPECT_NEAR(largest<openvdb::FloatGrid>(*out.grids[0]), 3 * 1.5, 1e-5);
  EXPECT_NEAR(mass.after + mass.cut, mass.before, 1e-6 * mass.before);
  EXPECT_NEAR(mass.cut / mass.before, 0.25, 0.05);
}

TEST(PushDensity, StretchDividesIt) {
  const Mat3 m{{{2, 0, 0}, {0.3, 0.8, 0}, {0, 0.1, 0.5}}};
  const HarmonicMap map = affineMap(m, {1, 2, 3});
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, 40), to = levelSetOf(target, 48);
  const auto grid = sampled<openvdb::FloatGrid>(*from, "density", [](const Vec3&) { return 3.f; });
  const PushResult out = pushed(map, source, *to, grid);
  double error = 0;
  auto distance = to->getConstAccessor();
  for (auto v = static_cast<const openvdb::FloatGrid&>(*out.grids[0]).cbeginValueOn(); v; ++v)
    if (distance.getValue(v.getCoord()) < -2.5 * to->voxelSize()[0])
      error = std::max(error, std::abs(*v - 3 / 0.8));
  EXPECT_LT(error, 1e-5);
  EXPECT_NEAR(out.masses.at(0).largestRatio, 1 / 0.8, 1e-9);
  EXPECT_NEAR(out.masses.at(0).largestCompression, 1 / 0.8, 1e-9);
}

Vec3 twist(const Vec3& p) {
  return {p.x - 0.4 * p.y * p.z, p.y + 0.4 * p.x * p.z, p.z + 0.2 * (p.x * p.x - p.y * p.y)};
}

Mat3 twistJacobian(const Vec3& p) {
  return {{{1, -0.4 * p.z, -0.4 * p.y}, {0.4 * p.z, 1, 0.4 * p.x}, {0.4 * p.x, -0.4 * p.y, 1}}};
}

// Root mean square, well inside, against density / det J in closed form.
double smoothError(int resolution) {
  const HarmonicMap map = fittedMap(twist);
  const Solid source(ball()), target(moved(ball(), map));
  const auto from = levelSetOf(source, resolution), to = levelSetOf(target, resolution);
  const PushResult out = pushed(map, source, *to, sampledScalar(*from, "density"));
  double squares = 0, count = 0;
  forInside<openvdb::FloatGrid>(*out.grids[0], *to, [&](const Vec3& q, float value) {
    Vec3 p = q;
    for (int i = 0; i < 8; ++i) p += inverse(twistJacobian(p)) * (q - twist(p));
    if (norm(p) > 0.85) return;
    squares += std::pow(value - smooth(p) / determinant(twistJacobian(p)), 2);
    ++count;
  });
  return std::sqrt(squares / count);
}

TEST(PushDensityRelease, Converges) {
  const double coarse = smoothError(24), fine = smoothError(48);
  EXPECT_GT(coarse / fine, 2.5);
  EXPECT_LT(fine, 5e-4);
}

TEST(PushDensity, StaysAsItIsWhereNothingMoves) {
  Draws draw(6);
  const Solid source(ball());
  const auto levelSet = levelSetOf(source, 24);
  const auto grid = sampled<openvdb::FloatGrid>(
      *levelSet, "density", [&](const Vec3&) { return static_cast<float>(draw()); });
  const HarmonicMap same = affineMap(rotation(0, 0), {0, 0, 0});
  const auto out = pushed(same, source, *levelSet, grid).grids[0];
  auto before = grid->getConstAccessor();
  std::size_t inside = forInside<openvdb::FloatGrid>(*out, *levelSet, [](const Vec3&, float) {});
  EXPECT_GT(inside, 1000u);
  for (auto v = static_cast<const openvdb::FloatGrid&>(*out).cbeginValueOn(); v; ++v) {
    const Vec3 p = toVec3(levelSet->transform().indexToWorld(v.getCoord()));
    const float want = source.inside(p) ? before.getValue(v.getCoord()) : 0.f;
    ASSERT_NEAR(*v, want, 1e-5) << v.getCoord();
  }
}

// A fog's values along the surface are shares: the voxels that touch the solid are all its mass.
TEST(PushDensity, FogIsCarriedWithItsEdge) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball());
  const auto from = levelSetOf(source, 24), to = levelSetOf(Solid(moved(ball(), map)), 24);
  const auto fog = makeFog(*from);
  fog->setName("density");
  const PushResult out = pushed(map, source, *to, fog);
  EXPECT_NEAR(out.masses.at(0).before, summed<openvdb::FloatGrid>(*fog, nullptr), 1e-9);
  EXPECT_NEAR(out.masses.at(0).left, 0, 1e-9);
  EXPECT_NEAR(out.masses.at(0).after / source.volume(), 1, 2e-3);
}

TEST(PushDensityRelease, WhatLiesAroundIsKeptToo) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball());
  const auto to = levelSetOf(Solid(moved(ball(), map)), 24);
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  grid->setName("density");
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-20), openvdb::Coord(20)), 2.f);  // with tiles
  PushSettings settings;
  settings.outside.distance = 0.15;
  const CarriedMass cut = pushed(map, source, *to, grid, settings).masses.at(0);
  settings.outside.fadeTo = RigidMotion();
  const CarriedMass faded = pushed(map, source, *to, grid, settings).masses.at(0);
  EXPECT_NEAR(faded.before, 2 * std::pow(4.1, 3), 1e-6);
  EXPECT_NEAR(faded.left, 0, 1e-6);
  EXPECT_NEAR(faded.after / faded.before, 1, 1e-5);
  const double reach = 1 + 0.15 * source.diagonal();
  EXPECT_NEAR(cut.before / (2 * 4.18879 * std::pow(reach, 3)), 1, 0.02);
  EXPECT_NEAR(cut.before + cut.left, faded.before, 1e-6);
  EXPECT_NEAR(cut.after / cut.before, 1, 1e-5);
}

// Two boxes a fifth of a voxel apart, and a sheet of dipoles between them that drives them asunder:
// nothing must be drawn across the gap.
TEST(PushDensity, NeighboursThatPartLeaveNothingBetween) {
  constexpr double kGap = 0.01, kAcross = 0.02, kWidth = 0.6;
  Points charges;
  std::vector<double> signs;
  for (double y = -kWidth; y <= kWidth; y += kAcross)
    for (double z = -kWidth; z <= kWidth; z += kAcross)
      for (const double side : {-1.0, 1.0}) {
        charges.push_back({0.2 * kGap * side, y, z});
        signs.push_back(side);
      }
  Matrix weights(charges.size(), 3);
  for (std::size_t i = 0; i < charges.size(); ++i)
    weights(i, 0) = signs[i] * 0.5 * kAcross * kAcross / (4 * kPi * 0.4 * kGap) * 2;
  const HarmonicMap map(HarmonicField(charges, weights, affineOf(kIdentity)));
  Mesh pair = shapes::box({-1, -0.5, -0.5}, {-kGap, 0.5, 0.5});
  const Mesh right = shapes::box({kGap, -0.5, -0.5}, {1, 0.5, 0.5});
  const int first = static_cast<int>(pair.vertices.size());
  pair.vertices.insert(pair.vertices.end(), right.vertices.begin(), right.vertices.end());
  for (std::array<int, 3> t : right.triangles) {
    for (int& v : t) v += first;
    pair.triangles.push_back(t);
  }
  const Solid source(pair);
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.05));
  grid->transform().postTranslate(openvdb::Vec3d(0.025));
  grid->setName("density");
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-20, -10, -10), openvdb::Coord(19, 9, 9)), 1.f);
  const auto to = levelSetOf(Solid(shapes::box({-2, -1, -1}, {2, 1, 1})), 80);
  const PushResult out = pushed(map, source, *to, grid);
  EXPECT_NEAR(out.masses.at(0).after / 2, 1, 1e-5);
  double between = 0;
  forValues<openvdb::FloatGrid>(*out.grids[0], [&](const Vec3& q, double value) {
    if (std::abs(q.x) < 0.15) between += value * std::pow(0.05, 3);
  });
  EXPECT_LT(between, 1e-3);
}

}  // namespace
}  // namespace innermap
