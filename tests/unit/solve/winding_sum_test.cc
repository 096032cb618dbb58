#include "innermap/solve/winding_sum.h"

#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "solve/points.h"

namespace innermap {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

struct Soup {
  Points vertices;
  Triangles triangles;
};

// The unit sphere in rings, closed, outward.
Soup sphere(int rings) {
  Soup out;
  const int around = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int a = 0; a < around; ++a) {
      const double polar = M_PI * r / rings, angle = 2 * M_PI * a / around;
      out.vertices.push_back(
          {std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)});
    }
  for (int r = 0; r < rings; ++r)
    for (int a = 0; a < around; ++a) {
      const int p = r * around + a, q = r * around + (a + 1) % around;
      out.triangles.push_back({p, p + around, q});
      out.triangles.push_back({q, p + around, q + around});
    }
  return out;
}

// Triangles of many sizes anywhere: no closed surface, winding numbers of any size.
Soup randomSoup(std::size_t count, std::uint64_t seed) {
  Soup out;
  const Points centers = testing::randomPoints(count, seed);
  const Points corners = testing::randomPoints(3 * count, seed + 1);
  for (std::size_t t = 0; t < count; ++t) {
    const double size = std::pow(10.0, -1.0 - 2.0 * static_cast<double>(t % 10) / 10);
    for (int c = 0; c < 3; ++c) {
      out.vertices.push_back(centers[t] + size * corners[3 * t + static_cast<std::size_t>(c)]);
    }
    const int first = static_cast<int>(3 * t);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

TEST(WindingSum, TellsInsideFromOutside) {
  const Soup s = sphere(40);
  const WindingSum winding(s.vertices, s.triangles);
  const Points points = testing::randomPoints(4000, 3);
  const std::vector<double> got = winding.at(points, 1e-3, nullptr, SumMethod::hierarchical);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = norm(points[i]);
    if (r > 0.99 && r < 1.01) continue;
    EXPECT_NEAR(got[i], r < 1 ? 1 : 0, 2e-2) << "point " << i << " at " << r;
  }
}

TEST(WindingSum, HoldsItsAccuracy) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Soup s = randomSoup(3000, seed);
    const WindingSum winding(s.vertices, s.triangles);
    const Points points = testing::randomPoints(3000, seed + 7);
    for (const double accuracy : {1e-2, 1e-3, 1e-5, 1e-8}) {
      const std::vector<double> got =
          winding.at(points, accuracy, nullptr, SumMethod::hierarchical);
      double squared = 0;
      for (std::size_t i = 0; i < points.size(); i += 10) {
        const double error = got[i] - winding.exactAt(points[i]);
        squared += error * error;
      }
      EXPECT_LE(std::sqrt(squared / 300), 3 * accuracy) << "accuracy " << accuracy;
      if (accuracy > 1e-4) {
        EXPECT_GT(std::sqrt(squared / 300), 1e-9) << "plain sums were taken";
      }
    }
  }
}

TEST(WindingSum, AgreesWithThePlainWayAndItself) {
  const Soup s = sphere(12);
  const WindingSum winding(s.vertices, s.triangles);
  const Points points = testing::randomPoints(1500, 4);
  const std::vector<double> plain = winding.at(points, 1e-9, nullptr, SumMethod::direct),
                            all = winding.at(points, 1e-9, nullptr, SumMethod::hierarchical);
  const ThreadLimit limit(1);
  const std::vector<double> one = winding.at(points, 1e-9, nullptr, SumMethod::hierarchical);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(plain[i], all[i], 1e-7);
    EXPECT_EQ(one[i], all[i]);
  }
}

TEST(WindingSum, NothingAndBadInput) {
  EXPECT_EQ(WindingSum({}, {}).at({{0, 0, 0}}).at(0), 0);
  EXPECT_TRUE(WindingSum({}, {}).at({}).empty());
  // One triangle, and one without area.
  const WindingSum one({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Points points = testing::randomPoints(300, 1);
  const std::vector<double> got = one.at(points, 1e-6, nullptr, SumMethod::hierarchical);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(got[i], one.exactAt(points[i]), 1e-5);
  EXPECT_EQ(WindingSum({{0, 0, 0}}, {{0, 0, 0}}).at({{1, 0, 0}}).at(0), 0);
  EXPECT_THROW(WindingSum({{0, 0, 0}}, {{0, 0, 1}}), DataError);
  EXPECT_THROW(WindingSum({{0, 0, 0}}, {{0, 0, -1}}), DataError);
  EXPECT_THROW(WindingSum({{0, 0, std::nan("")}}, {{0, 0, 0}}), DataError);
  EXPECT_THROW(one.at(points, 0), SettingError);
  EXPECT_THROW(one.at({{std::nan(""), 0, 0}}), DataError);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(one.at(points, 1e-3, &progress, SumMethod::hierarchical), Cancelled);
}

}  // namespace
}  // namespace innermap
