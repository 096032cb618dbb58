#include "proof/detail/interval.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace innermap::proof {
namespace {

bool holds(const Interval& i, long double x) { return i.lower <= x && x <= i.upper; }

TEST(Interval, HoldsWhatExactNumbersGive) {
  const CounterRandom random(1, 1);
  for (std::uint64_t i = 0; i < 3000; i += 3) {
    const double a = random.uniform(i) - 0.5, b = random.uniform(i + 1) - 0.5;
    const long double x = a, y = b;
    EXPECT_TRUE(holds(Interval(a) + b, x + y));
    EXPECT_TRUE(holds(Interval(a) - b, x - y));
    EXPECT_TRUE(holds(Interval(a) * b, x * y));
    EXPECT_TRUE(holds(Interval(a) / b, x / y));
    EXPECT_TRUE(holds(square(Interval(a)), x * x));
    EXPECT_TRUE(holds(squareRoot(std::abs(a)), std::sqrt(std::abs(x))));
    EXPECT_LT((Interval(a) * b).upper - (Interval(a) * b).lower, 1e-15);
  }
}

TEST(Interval, HoldsAllNumbersOfItsOperands) {
  const CounterRandom random(2, 1);
  for (std::uint64_t i = 0; i < 6000; i += 6) {
    const double u = random.uniform(i) - 0.5, v = random.uniform(i + 1) - 0.5;
    const Interval a(u, u + random.uniform(i + 2)), b(v, v + random.uniform(i + 3));
    const double x = a.lower + random.uniform(i + 4) * (a.upper - a.lower);
    const double y = b.lower + random.uniform(i + 5) * (b.upper - b.lower);
    EXPECT_TRUE(holds(a + b, static_cast<long double>(x) + y));
    EXPECT_TRUE(holds(a - b, static_cast<long double>(x) - y));
    EXPECT_TRUE(holds(a * b, static_cast<long double>(x) * y));
    EXPECT_TRUE(holds(a / b, static_cast<long double>(x) / y));
    EXPECT_TRUE(holds(square(a), static_cast<long double>(x) * x));
  }
}

TEST(Interval, NothingIsKnownOfWhatHasNoNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Interval& unknown : {Interval(1) / Interval(-1, 1), Interval(1) / Interval(0, 1),
                                  Interval(infinity) - Interval(infinity), within(infinity) * 0}) {
    EXPECT_FALSE(unknown.positive());
    EXPECT_FALSE(unknown.negative());
    EXPECT_GT(unknown.magnitude(), 1e300);
    EXPECT_GT((unknown + 1).magnitude(), 1e300);
    EXPECT_GT(square(unknown).magnitude(), 1e300);
  }
}

}  // namespace
}  // namespace innermap::proof
