#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "fit/test_pairs.h"
#include "innermap/core/error.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

MapFit affineFit() {
  const Mesh source = ball(2);
  return fitMap(source, moved(source, affineMap));
}

TEST(MapGrids, HoldTheMapAndItsTotals) {
  const MapFit fit = affineFit();
  const SolidGrids grids = evaluateOnGrid(fit, {.resolution = 24});
  std::vector<std::string> names;
  for (const auto& grid : grids.all()) names.push_back(grid->getName());
  EXPECT_EQ(names, (std::vector<std::string>{"surface", "density", "map", "jacobian",
                                             "harmonic_energy", "deformation_energy"}));
  const double det = determinant(fit.map.jacobian({0, 0, 0}));
  EXPECT_NEAR(grids.values.jacobianMin, det, 1e-5 * det);
  EXPECT_NEAR(grids.values.jacobianMax, det, 1e-5 * det);
  EXPECT_EQ(grids.values.foldedFraction, 0);
  const openvdb::Coord origin =
      grids.surface->transform().worldToIndexNodeCentered(openvdb::Vec3d(0));
  const openvdb::Vec3d centre = grids.surface->indexToWorld(origin);
  const openvdb::Vec3f mapped = grids.values.map->tree().getValue(origin);
  EXPECT_LT(norm(Vec3{mapped.x(), mapped.y(), mapped.z()} -
                 affineMap({centre.x(), centre.y(), centre.z()})),
            1e-5);
}

// Floats that far are 0.25 apart, the ball is 2 across.
TEST(MapGridsRelease, HoldPositionsFarFromTheOrigin) {
  const Vec3 away{4e6, -3e6, 1e5};
  const Mesh near = ball(2), source = moved(near, [&](const Vec3&p) { return p + away; });
  const auto map = [&](const Vec3& p) { return affineMap(p - away) + away; };
  const MapFit fit = fitMap(source, moved(source, map));
  const SolidGrids grids = evaluateOnGrid(fit, {.resolution = 24});
  ASSERT_TRUE(grids.mapLocal);
  EXPECT_EQ(grids.warnings.size(), 1u);
  EXPECT_EQ(grids.all().back()->getName(), "map_local");
  const Vec3& o = grids.localOrigin;
  EXPECT_EQ(grids.mapLocal->metaValue<openvdb::Vec3d>("innermap_map_local_origin"),
            openvdb::Vec3d(o.x, o.y, o.z));
  const auto absolute = grids.values.map->getConstAccessor();
  double worst = 0, rounding = 0;
  for (auto voxel = grids.mapLocal->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Vec3d p = grids.mapLocal->indexToWorld(voxel.getCoord());
    const Vec3 known = map({p.x(), p.y(), p.z()});
    const openvdb::Vec3f local = *voxel, stored = absolute.getValue(voxel.getCoord());
    worst = std::max(worst, norm(o + Vec3{local.x(), local.y(), local.z()} - known));
    rounding = std::max(rounding, norm(Vec3{stored.x(), stored.y(), stored.z()} - known));
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(rounding, 0.1);
  const double unit = fit.boundary.target.diagonal;
  EXPECT_NEAR(grids.mapRounding, rounding / unit, 0.01 * rounding / unit);
  EXPECT_EQ(grids.values.map->metaValue<double>("innermap_map_rounding"), grids.mapRounding);
  EXPECT_EQ(grids.injectivity.cells.folded, 0u);
}

TEST(MapGrids, CarryTheFactsInTheirMetadata) {
  const MapFit fit = affineFit();
  MapGridSettings settings{.resolution = 16};
  for (const auto& grid : evaluateOnGrid(fit, settings).all()) {
    EXPECT_EQ(grid->metaValue<std::string>("innermap_tolerance_met"), "true");
    EXPECT_EQ(grid->metaValue<double>("innermap_folded_fraction"), 0);
    EXPECT_EQ(grid->metaValue<double>("innermap_lame_mu"), settings.lame.mu);
  }
}

TEST(MapGrids, SayWhatVoxelsAndCellsTellOfOneToOne) {
  const MapFit fit = affineFit();
  const SolidGrids grids = evaluateOnGrid(fit, {.resolution = 24});
  const Injectivity& known = grids.injectivity;
  EXPECT_EQ(known.inside.checked, fit.injectivity.inside.checked);
  EXPECT_EQ(known.voxels.checked, grids.values.interiorVoxels);
  EXPECT_EQ(known.voxels.least, grids.values.jacobianMin);
  const double det = determinant(fit.map.jacobian({0, 0, 0}));
  EXPECT_NEAR(known.cells.least, det, 1e-3 * det);
  EXPECT_EQ(known.cells.folded, 0u);
  EXPECT_EQ(known.cells.overlaps, 0);
  // All but about a voxel along the surface: a fifth of a ball that is 24 across.
  EXPECT_GT(known.cells.share, 0.75);
  EXPECT_LT(known.cells.share, 0.95);
  const std::string statement = injectivityStatement(known);
  for (const auto& grid : grids.all())
    EXPECT_EQ(grid->metaValue<std::string>("innermap_one_to_one"), statement);
}

// Two balls that come to lie in one another: the lens that they share is covered twice, by cells of
// which none is turned over.
TEST(MapGrids, CellsThatOverlapAreTold) {
  const MapFit fit = fitMap(twoBalls(1.5), twoBalls(0.5), {.tolerance = 5e-3});
  EXPECT_EQ(fit.injectivity.degree.greatest, 2);
  EXPECT_GT(fit.injectivity.target.pairs, 0u);
  const Injectivity known = evaluateOnGrid(fit, {.resolution = 32}).injectivity;
  EXPECT_EQ(known.cells.folded, 0u);
  EXPECT_GT(known.cells.overlaps, 0);
  EXPECT_TRUE(notOneToOne(known));
  EXPECT_NE(injectivityStatement(known).find("2 times"), std::string::npos);
}

// Cubes about which nothing is proven, and one that is proven folded though the determinant there,
// of all steps together, is above 0.
TEST(MapGridsRelease, MarkTheCellsOfAProof) {
  MapFit fit = fitMap(ball(3), ball(3));
  const SolidGrids whole = evaluateOnGrid(fit, {.resolution = 32});
  EXPECT_FALSE(whole.undecided);
  EXPECT_FALSE(whole.values.folded);
  ProofFigures& proof = fit.injectivity.proof;
  proof.undecidedCells = {{{0.25, 0, 0}, 0.125}, {{0, 0, 1}, 0.25}};  // one reaches out of the ball
  // Some between the voxels' centres.
  for (int i = 0; i < 50; ++i)
    proof.undecidedCells.push_back({{-0.5 + 0.013 * i, 0.4, 0.01 * i}, 0.011});
  proof.negativeCells = {{{0, -0.5, 0}, 0.125}};
  const SolidGrids grids = evaluateOnGrid(fit, {.resolution = 32});
  ASSERT_TRUE(grids.undecided);
  ASSERT_TRUE(grids.values.folded);
  const auto marked = [](const openvdb::FloatGrid& marks, const openvdb::Coord& at) {
    return marks.tree().isValueOn(at) && marks.tree().getValue(at) > 0.5F;
  };
  const auto in = [](const std::vector<ProofCell>& cells, const openvdb::Vec3d& p) {
    return std::any_of(cells.begin(), cells.end(), [&](const ProofCell& cell) {
      const openvdb::Vec3d way = p - openvdb::Vec3d(cell.center.x, cell.center.y, cell.center.z);
      return std::max({std::abs(way.x()), std::abs(way.y()), std::abs(way.z())}) <= cell.halfEdge;
    });
  };
  for (auto v = grids.values.map->cbeginValueOn(); v; ++v) {
    const bool inside = grids.surface->tree().getValue(v.getCoord()) < 0;
    const openvdb::Vec3d p = grids.surface->indexToWorld(v.getCoord());
    EXPECT_EQ(marked(*grids.undecided, v.getCoord()), inside && in(proof.undecidedCells, p)) << p;
    EXPECT_EQ(marked(*grids.values.folded, v.getCoord()), inside && in(proof.negativeCells, p))
        << p;
  }
}

// The target shrinks by a tenth after the fit, so that the images of a shell lie outside it.
TEST(MapGridsRelease, MarkWhatLandsOutsideTheTarget) {
  const Mesh source = ball(3);
  MapFit fit = fitMap(source, source);
  EXPECT_FALSE(evaluateOnGrid(fit, {.resolution = 32}).outside);
  for (Vec3& p : fit.boundary.target.moved) p = p * 0.9;
  const SolidGrids grids = evaluateOnGrid(fit, {.resolution = 32});
  ASSERT_TRUE(grids.outside);
  EXPECT_NEAR(grids.outsideFraction, 1 - 0.9 * 0.9 * 0.9, 0.03);
  EXPECT_EQ(grids.all().back()->getName(), "outside");
  std::size_t out = 0;
  for (auto v = grids.values.map->cbeginValueOn(); v; ++v) {
    if (!(grids.surface->tree().getValue(v.getCoord()) < 0)) continue;
    const double depth = v->length() - 0.9;  // the ball's facets are up to 0.01 inside
    const bool marked = grids.outside->tree().isValueOn(v.getCoord());
    if (std::abs(depth + 0.005) > 0.005) {
      EXPECT_EQ(marked, depth > 0) << v.getCoord();
    }
    if (marked) {
      EXPECT_NEAR(grids.outside->tree().getValue(v.getCoord()), depth, 0.01);
    }
    out += marked;
  }
  EXPECT_EQ(out, grids.outside->activeVoxelCount());
}

TEST(MapGrids, CountTheirMemory) {
  const Solid solid(ball(2));
  const auto need = [&](const MapGridKind& kind, int resolution = 0) {
    return static_cast<double>(mapGridMemory(solid, {.resolution = resolution}, kind));
  };
  const double coarse = need({});
  EXPECT_GT(need({5}), coarse + 50e6);
  EXPECT_GT(need({1, true}), coarse);
  EXPECT_LT(need({1, false, true}), coarse);
  EXPECT_GT(need({}, 512), 10 * coarse);
  test::expectOverLimit(1000, [&] { evaluateOnGrid(affineFit(), {.resolution = 512}); });
}

class Frames : public testing::Test {
 protected:
  static FrameFitterSettings few() { return {.sources = 300}; }
  static MapGridSettings coarse() { return {.resolution = 20}; }
  const Mesh rest = ball(2);
  const FrameFitter fitter{makeSourceBoundary(rest), few()};
  const FrameFit fit = fitter.fit(moved(rest, affineMap));
};

TEST_F(Frames, AreEvaluatedOnTheGridOfTheirRestPose) {
  const FrameEvaluator evaluator(fitter, {"jacobian", "surface"}, coarse());
  const MapGrids values = evaluator.evaluate(fit);
  const double det = determinant(HarmonicMap(fit.field).jacobian({0, 0, 0}));
  EXPECT_NEAR(values.jacobianMin, det, 1e-3 * det);
  const openvdb::GridPtrVec grids = evaluator.grids({&fit, 12}, values);
  ASSERT_EQ(grids.size(), 2u);
  EXPECT_EQ(grids[0]->getName(), "jacobian");
  EXPECT_EQ(grids[1]->getName(), "surface");
  for (const auto& grid : grids) {
    EXPECT_EQ(grid->metaValue<std::int64_t>("innermap_frame"), 12);
    EXPECT_EQ(grid->metaValue<double>("innermap_boundary_error_rms"), fit.error.rms);
    EXPECT_EQ(grid->metaValue<double>("innermap_jacobian_min"), values.jacobianMin);
  }
  EXPECT_THROW(FrameEvaluator(fitter, {"depth"}, coarse()), SettingError);
}

// Grids go through one map after another, and other programs use names of ours.
TEST_F(Frames, DescribeGridsThatWereDescribedBefore) {
  const openvdb::GridBase::Ptr grid = openvdb::FloatGrid::create();
  grid->insertMeta("innermap_frame", openvdb::StringMetadata("12"));
  grid->insertMeta("innermap_source", openvdb::FloatMetadata(1));
  const MapFit map = fitMap(rest, moved(rest, affineMap), {.tolerance = 1e-2});
  describeMap({grid}, map);
  ASSERT_EQ(grid->metaValue<std::string>("innermap_source"), map.facts[1].second);
  ASSERT_FALSE(grid->metaValue<std::string>("innermap_boundary_error_rms").empty());
  describeFrame({grid}, {&fit, 12});
  EXPECT_EQ(grid->metaValue<std::int64_t>("innermap_frame"), 12);
  EXPECT_EQ(grid->metaValue<double>("innermap_boundary_error_rms"), fit.error.rms);
  EXPECT_EQ((*grid)["innermap_boundary_error_samples"], nullptr);
  EXPECT_EQ((*grid)["innermap_one_to_one"], nullptr);
  describeMap({grid}, map);
  EXPECT_FALSE(grid->metaValue<std::string>("innermap_boundary_error_rms").empty());
}

}  // namespace
}  // namespace innermap
