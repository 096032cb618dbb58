#include <gtest/gtest.h>

#include <atomic>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"
#include "solve/points.h"

namespace innermap {
namespace {

double rms(const Matrix& m, std::size_t first, std::size_t columns) {
  double sum = 0;
  for (std::size_t i = 0; i < columns * m.rows(); ++i)
    sum += m.column(first)[i] * m.column(first)[i];
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, columns * m.rows())));
}

double rmsDifference(Matrix a, const Matrix& b, std::size_t first, std::size_t columns) {
  for (std::size_t i = 0; i < a.rows() * a.columns(); ++i) a.data()[i] -= b.data()[i];
  return rms(a, first, columns);
}

// The check in FastSum sees some of the points only: all of them may be a little worse.
constexpr double kSlack = 1.5;

void expectAccurate(const FieldSamples& got, const FieldSamples& exact, double accuracy) {
  ASSERT_EQ(got.values.rows(), exact.values.rows());
  for (std::size_t k = 0; k < exact.values.columns(); ++k) {
    EXPECT_LE(rmsDifference(got.values, exact.values, k, 1),
              kSlack * accuracy * rms(exact.values, k, 1));
    if (!exact.gradients.empty()) {
      EXPECT_LE(rmsDifference(got.gradients, exact.gradients, 3 * k, 3),
                kSlack * 100 * accuracy * rms(exact.gradients, 3 * k, 3));
    }
  }
}

// A hierarchy that fails its own check is replaced by plain sums, which are far more exact than
// asked for: accuracy alone would not show that.
void expectHierarchy(const FieldSamples& got, const FieldSamples& exact, double accuracy) {
  for (std::size_t k = 0; k < exact.values.columns(); ++k) {
    EXPECT_GT(rmsDifference(got.values, exact.values, k, 1),
              1e-6 * accuracy * rms(exact.values, k, 1))
        << "plain sums were taken";
  }
}

FastSumSettings hierarchical(double accuracy, bool gradients = true) {
  FastSumSettings settings{
      .accuracy = accuracy, .gradients = gradients, .method = SumMethod::hierarchical};
  return settings;
}

void expectSums(const Points& points, const Points& sources, std::size_t channels,
                double accuracy) {
  const Matrix w = testing::randomWeights(sources.size(), channels, sources.size());
  const FieldSamples exact = sumCharges(Charges(sources, w), points, true);
  expectAccurate(FastSum(sources, w).at(points, hierarchical(accuracy)), exact, accuracy);
}

TEST(FastSumRelease, HoldsItsAccuracyForRandomPoints) {
  const Points points = testing::randomPoints(6000, 1), sources = testing::randomPoints(12000, 2);
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10}) {
    SCOPED_TRACE("accuracy " + std::to_string(std::log10(accuracy)));
    const Matrix w = testing::randomWeights(sources.size(), 3, 7);
    const FieldSamples exact = sumCharges(Charges(sources, w), points, true),
                       got = FastSum(sources, w).at(points, hierarchical(accuracy));
    expectAccurate(got, exact, accuracy);
    // At higher ones all charges are near to so few leaves.
    if (accuracy > 1e-7) expectHierarchy(got, exact, accuracy);
  }
}

TEST(FastSum, TakesAnyNumberOfChannels) {
  for (std::size_t channels = 1; channels <= 7; ++channels) {
    SCOPED_TRACE("channels " + std::to_string(channels));
    expectSums(testing::randomPoints(800, channels), testing::randomPoints(1500, 50), channels,
               1e-6);
  }
}

// Charges just outside a sphere, targets on it: as in a fit.
TEST(FastSum, HoldsItsAccuracyBesideTheCharges) {
  const Points points = testing::spherePoints(6000, 1), sources = testing::spherePoints(3000, 1.06);
  expectSums(points, sources, 3, 1e-6);
  expectSums(points, sources, 3, 1e-9);
}

TEST(FastSum, HoldsItsAccuracyForClusters) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Points points = testing::randomPoints(2000, seed),
           sources = testing::randomPoints(2500, seed + 9);
    const Points centers = testing::randomPoints(5, seed + 20);
    // Clusters from 1e-1 to 1e-5 wide.
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = centers[i % 5] + std::pow(10.0, -1.0 - i % 5) * points[i];
    for (std::size_t i = 0; i < sources.size(); ++i)
      sources[i] = centers[i % 4] + std::pow(10.0, -1.0 - i % 4) * sources[i];
    expectSums(points, sources, 2, 1e-6);
  }
}

TEST(FastSum, CoincidentSourcesAndTargets) {
  Points sources = testing::randomPoints(1200, 3);
  for (std::size_t i = 0; i < 600; ++i) sources[i] = sources[0];
  Points points = testing::randomPoints(900, 4);
  // Some targets are sources, which then contribute nothing there.
  for (std::size_t i = 0; i < 50; ++i) points[i] = sources[i * 20];
  expectSums(points, sources, 3, 1e-6);
  expectSums(points, Points(300, Vec3{1, 2, 3}), 3, 1e-6);
  expectSums(Points(300, Vec3{1, 2, 3}), sources, 3, 1e-6);
}

// Single precision would take these for coincident, and drop them.
TEST(FastSum, AlmostCoincidentPairsCount) {
  const Points sources = testing::randomPoints(1500, 3);
  Points points = sources;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].x += std::pow(10.0, -4.0 - 6.0 * static_cast<double>(i) / 1500);
  for (const double accuracy : {1e-3, 1e-5}) {
    const Matrix w = testing::randomWeights(1500, 3, 8);
    const FieldSamples got = FastSum(sources, w).at(points, hierarchical(accuracy)),
                       exact = sumCharges(Charges(sources, w), points, true);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(got.values(i, k) / exact.values(i, k), 1, 100 * accuracy) << i;
  }
}

// Halving at medians puts these on the borders between cells.
TEST(FastSum, PointsOnTheBordersOfCells) {
  Points grid;
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y)
      for (int z = 0; z < 16; ++z) grid.push_back({x / 8.0 - 1, y / 8.0 - 1, z / 8.0 - 1});
  expectSums(grid, grid, 3, 1e-6);
}

TEST(FastSum, OneSourceAndNone) {
  const Points points = testing::randomPoints(500, 1);
  expectSums(points, {{0.1, 0.2, 0.3}}, 3, 1e-8);
  const FieldSamples none = FastSum({}, Matrix(0, 3)).at(points, hierarchical(1e-6));
  EXPECT_EQ(rms(none.values, 0, 3), 0);
  EXPECT_EQ(FastSum({{1, 2, 3}}, Matrix(1, 2)).at({}, hierarchical(1e-6)).values.rows(), 0u);
}

// Weights that cancel: expansions lose what the sums keep, and the order must follow.
TEST(FastSum, HoldsItsAccuracyWhereWeightsCancel) {
  const Points points = testing::spherePoints(2000, 1);
  Points sources = testing::spherePoints(1500, 1.5);
  Matrix w = testing::randomWeights(3000, 1, 8);
  for (std::size_t j = 0; j < 1500; ++j) {
    sources.push_back(sources[j] + Vec3{1e-4, 0, 0});
    w(1500 + j, 0) = -w(j, 0);
  }
  const FieldSamples exact = sumCharges(Charges(sources, w), points, true);
  expectAccurate(FastSum(sources, w).at(points, hierarchical(1e-5)), exact, 1e-5);
}

// Weights that cancel to less than rounding: no order reaches the accuracy, and plain sums would
// take as many pairs as there are charges and points.
TEST(FastSumRelease, TakesTheBestOrderWhereWeightsNearlyCancel) {
  constexpr std::size_t kMany = 30000;
  const Points points = testing::spherePoints(40000, 1);
  Points some;
  for (std::size_t i = 0; i < points.size(); i += 100) some.push_back(points[i]);
  for (const double apart : {1e-4, 1e-7, 1e-9}) {
    SCOPED_TRACE("apart " + std::to_string(std::log10(apart)));
    Points sources = testing::spherePoints(kMany, 1.01);
    Matrix w = testing::randomWeights(2 * kMany, 1, 8);
    for (std::size_t j = 0; j < kMany; ++j) {
      sources.push_back(sources[j] + Vec3{apart, 0, 0});
      w(kMany + j, 0) = -w(j, 0);
    }
    const Charges charges(sources, w);
    FastSumSettings settings = hierarchical(1e-12, false);
    settings.method = SumMethod::cheapest;
    const FieldSamples got = FastSum(sources, w).at(points, settings),
                       exact = sumCharges(charges, some, false),
                       magnitudes = sumCharges(charges.magnitudes(), some, false);
    EXPECT_GT(got.error, 0) << "plain sums were taken";
    FieldSamples gotAtSome{.values = Matrix(some.size(), 1)};
    for (std::size_t i = 0; i < some.size(); ++i) gotAtSome.values(i, 0) = got.values(100 * i, 0);
    const double error = rmsDifference(gotAtSome.values, exact.values, 0, 1);
    // Of sums of doubles no more can be asked, of their error no less.
    EXPECT_LT(error, 1e-15 * rms(magnitudes.values, 0, 1));
    EXPECT_LT(error, 3 * got.error);
    EXPECT_GT(error, got.error / 3);
  }
}

TEST(FastSum, AbsoluteAccuracyIsEnough) {
  const Points points = testing::randomPoints(1000, 1), sources = testing::spherePoints(1000, 2);
  const Matrix w = testing::randomWeights(1000, 1, 8);
  const FieldSamples exact = sumCharges(Charges(sources, w), points, false);
  FastSumSettings settings = hierarchical(1e-12, false);
  settings.absolute = 1e-3 * rms(exact.values, 0, 1);
  const FieldSamples got = FastSum(sources, w).at(points, settings);
  const double error = rmsDifference(got.values, exact.values, 0, 1);
  EXPECT_LE(error, kSlack * settings.absolute);
  EXPECT_GT(error, 1e-9 * rms(exact.values, 0, 1)) << "more was done than asked for";
}

TEST(FastSum, ScaleAndPlaceDoNotMatter) {
  const Points points = testing::randomPoints(1000, 1), sources = testing::spherePoints(1000, 1.8);
  const Matrix w = testing::randomWeights(1000, 3, 8);
  const FieldSamples here = FastSum(sources, w).at(points, hierarchical(1e-6));
  for (const double scale : {1e-6, 1e6}) {
    Points movedPoints = points, movedSources = sources;
    const Vec3 offset = scale * Vec3{100, -300, 50};
    for (Vec3& p : movedPoints) p = scale * p + offset;
    for (Vec3& p : movedSources) p = scale * p + offset;
    FieldSamples there = FastSum(movedSources, w).at(movedPoints, hierarchical(1e-6));
    for (std::size_t i = 0; i < 3000; ++i) there.values.data()[i] *= scale;
    for (std::size_t i = 0; i < 9000; ++i) there.gradients.data()[i] *= scale * scale;
    expectAccurate(there, here, 1e-6);
  }
}

TEST(FastSum, SameForAnyNumberOfThreads) {
  const Points points = testing::randomPoints(5000, 1), sources = testing::randomPoints(3000, 2);
  const FastSum sum(sources, testing::randomWeights(3000, 3, 1));
  FieldSamples one;
  {
    const ThreadLimit limit(1);
    one = sum.at(points, hierarchical(1e-6));
  }
  const FieldSamples all = sum.at(points, hierarchical(1e-6));
  for (std::size_t i = 0; i < 15000; ++i) ASSERT_EQ(one.values.data()[i], all.values.data()[i]);
}

// The points' order is made once, far from the charges and in other units than theirs.
TEST(FastSum, SumsAtKeptPointsAreThoseAtPoints) {
  const SumPoints kept(testing::randomPoints(5000, 1));
  for (const double scale : {1e-3, 1.0, 1e3}) {
    SCOPED_TRACE(scale);
    Points sources = testing::randomPoints(3000, 2);
    for (Vec3& p : sources) p = Vec3{0.3, -0.2, 0.1} + scale * p;
    const Matrix w = testing::randomWeights(3000, 3, 1);
    const FastSum sum(sources, w);
    const FieldSamples got = sum.at(kept, hierarchical(1e-6)),
                       exact = sumCharges(Charges(sources, w), kept.points(), true);
    expectAccurate(got, exact, 1e-6);
    const FieldSamples again = sum.at(kept.points(), hierarchical(1e-6));
    for (std::size_t i = 0; i < 15000; ++i) ASSERT_EQ(got.values.data()[i], again.values.data()[i]);
  }
}

// A ball of blocks about the origin, whose outer blocks want some of their points only.
LatticeBlocks ballOfBlocks(int across) {
  LatticeBlocks lattice{.spacing = 2.0 / across};
  lattice.origin = {-1 + 0.5 * lattice.spacing, -1 + 0.5 * lattice.spacing,
                    -1 + 0.5 * lattice.spacing};
  for (int x = 0; x < across; x += 8)
    for (int y = 0; y < across; y += 8)
      for (int z = 0; z < across; z += 8) {
        LatticeBlocks::Block block{{x, y, z}, {}};
        bool any = false;
        for (int i = 0; i < 512; ++i) {
          const Vec3 p =
              lattice.origin +
              lattice.spacing * Vec3{x + (i >> 6) + 0.0, y + (i >> 3 & 7) + 0.0, z + (i & 7) + 0.0};
          if (norm(p) > 1) continue;
          block.wanted[static_cast<std::size_t>(i) >> 6] |= std::uint64_t{1} << (i & 63);
          any = true;
        }
        if (any) lattice.blocks.push_back(block);
      }
  return lattice;
}

Points pointsOf(const LatticeBlocks& lattice) {
  Points out;
  for (const auto& b : lattice.blocks)
    for (int i = 0; i < 512; ++i)
      if (b.wanted[static_cast<std::size_t>(i) >> 6] >> (i & 63) & 1)
        out.push_back(lattice.origin + lattice.spacing * Vec3{b.first[0] + (i >> 6) + 0.0,
                                                              b.first[1] + (i >> 3 & 7) + 0.0,
                                                              b.first[2] + (i & 7) + 0.0});
  return out;
}

FieldSamples onLattice(const FastSum& sum, const LatticeBlocks& lattice,
                       const FastSumSettings& settings) {
  std::vector<std::size_t> begin(lattice.blocks.size() + 1, 0);
  for (std::size_t b = 0; b < lattice.blocks.size(); ++b) {
    begin[b + 1] = begin[b];
    for (const std::uint64_t word : lattice.blocks[b].wanted)
      begin[b + 1] += static_cast<std::size_t>(__builtin_popcountll(word));
  }
  const std::size_t channels = sum.channels();
  FieldSamples out{.values = Matrix(begin.back(), channels)};
  if (settings.gradients) out.gradients = Matrix(begin.back(), 3 * channels);
  std::atomic<std::size_t> visits{0};
  sum.onLattice(
      lattice,
      [&](std::size_t b, const double* values, const double* gradients) {
        ++visits;
        EXPECT_EQ(gradients != nullptr, settings.gradients);
        std::size_t row = begin[b];
        for (std::size_t i = 0; i < 512; ++i) {
          if (!(lattice.blocks[b].wanted[i >> 6] >> (i & 63) & 1)) continue;
          for (std::size_t k = 0; k < channels; ++k) out.values(row, k) = values[512 * k + i];
          for (std::size_t k = 0; gradients && k < 3 * channels; ++k)
            out.gradients(row, k) = gradients[512 * k + i];
          ++row;
        }
      },
      settings);
  EXPECT_EQ(visits, lattice.blocks.size());
  return out;
}

TEST(FastSumRelease, LatticeAgreesWithPlainSums) {
  const LatticeBlocks lattice = ballOfBlocks(48);
  const Points sources = testing::spherePoints(2000, 1.05), points = pointsOf(lattice);
  for (const std::size_t channels : {1, 3, 5}) {
    const Matrix w = testing::randomWeights(2000, channels, 4);
    const FieldSamples exact = sumCharges(Charges(sources, w), points, true);
    const FastSum sum(sources, w);
    for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-10}) {
      const FieldSamples got = onLattice(sum, lattice, hierarchical(accuracy));
      expectAccurate(got, exact, accuracy);
      if (accuracy > 1e-9) expectHierarchy(got, exact, accuracy);
    }
    FastSumSettings direct;
    direct.method = SumMethod::direct;
    direct.gradients = true;
    expectAccurate(onLattice(sum, lattice, direct), exact, 1e-13);
  }
}

TEST(FastSum, LatticeOfOneVoxelOfNoneAndWithoutGradients) {
  LatticeBlocks lattice = ballOfBlocks(8);
  for (auto& b : lattice.blocks) b.wanted = {0, 0, 0, 1 << 27, 0, 0, 0, 0};
  const Points sources = testing::spherePoints(2000, 2);
  const Matrix w = testing::randomWeights(2000, 3, 4);
  const FastSum sum(sources, w);
  expectAccurate(onLattice(sum, lattice, hierarchical(1e-6, false)),
                 sumCharges(Charges(sources, w), pointsOf(lattice), false), 1e-6);
  // Blocks that want nothing are visited all the same.
  lattice.blocks.assign(3, {});
  EXPECT_EQ(onLattice(sum, lattice, hierarchical(1e-6)).values.rows(), 0u);
  lattice.blocks.clear();
  sum.onLattice(lattice, [](std::size_t, const double*, const double*) { FAIL(); });
}

TEST(FastSum, BadSettingsAndPoints) {
  const FastSum sum({{0, 0, 0}}, Matrix(1, 1));
  for (const double accuracy : {0.0, -1.0, 0.2, std::nan("")})
    EXPECT_THROW(sum.at({{1, 0, 0}}, hierarchical(accuracy)), SettingError);
  EXPECT_THROW(sum.at({{1, 0, 0}}, {.absolute = -1}), SettingError);
  EXPECT_THROW(sum.at({{std::nan(""), 0, 0}}, hierarchical(1e-3)), DataError);
  LatticeBlocks lattice = ballOfBlocks(8);
  lattice.spacing = 0;
  EXPECT_THROW(sum.onLattice(lattice, [](std::size_t, const double*, const double*) {}),
               SettingError);
  EXPECT_THROW(FastSum({{0, 0, 0}}, Matrix(2, 1)), DataError);
  EXPECT_THROW(FastSum({{std::nan(""), 0, 0}}, Matrix(1, 1)), DataError);
}

TEST(FastSum, CanBeCancelled) {
  const Points points = testing::randomPoints(20000, 1), sources = testing::randomPoints(3000, 2);
  const FastSumSettings settings = hierarchical(1e-6);
  const FastSum sum(sources, testing::randomWeights(3000, 3, 1));
  test::expectCancels([&] { sum.at(points, settings); });
  test::expectCancels([&] {
    sum.onLattice(
        ballOfBlocks(16), [](std::size_t, const double*, const double*) {}, settings);
  });
}

}  // namespace
}  // namespace innermap
