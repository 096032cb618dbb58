#include "io/picture/detail/image.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/random.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

Pixels made(int width, int height, const std::function<float(int x, int y, int c)>& value) {
  Pixels p;
  p.width = width;
  p.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) p.rgb.push_back(value(x, y, c));
  return p;
}

// Red runs along u, green along v (up), blue is constant.
Pixels ramps(int width, int height) {
  return made(width, height, [&](int x, int y, int c) {
    return c == 0   ? (static_cast<float>(x) + 0.5f) / static_cast<float>(width)
           : c == 1 ? 1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(height)
                    : 0.25f;
  });
}

void expectColour(const Vec3& c, double r, double g, double b, double tolerance = 1e-6) {
  EXPECT_NEAR(c.x, r, tolerance);
  EXPECT_NEAR(c.y, g, tolerance);
  EXPECT_NEAR(c.z, b, tolerance);
}

TEST(Image, VPointsUpAndValuesAreBilinear) {
  const Image image(ramps(8, 4));
  EXPECT_EQ(image.width(), 8);
  EXPECT_EQ(image.height(), 4);
  for (const double u : {0.1, 0.3, 0.5, 0.77})
    for (const double v : {0.2, 0.4, 0.7}) expectColour(image.at({u, v}), u, v, 0.25);
}

TEST(Image, WrapsAsAsked) {
  const auto corner = [](Wrap wrap, double u, double v) {
    // Pixel (0, 0), upper left, is 1; all others are 0.
    const Image image(made(4, 4, [](int x, int y, int) { return x == 0 && y == 0 ? 1.0f : 0.0f; }),
                      wrap);
    return image.at({u, v}).x;
  };
  const double middle = 1.0 / 8, top = 1 - middle;
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror, Wrap::black})
    EXPECT_NEAR(corner(wrap, middle, top), 1, 1e-6);
  EXPECT_NEAR(corner(Wrap::repeat, middle + 3, top - 7), 1, 1e-6);
  EXPECT_NEAR(corner(Wrap::mirror, -middle, top + 2), 1, 1e-6);
  EXPECT_NEAR(corner(Wrap::mirror, middle + 1, top), 0, 1e-6);
  EXPECT_NEAR(corner(Wrap::clamp, -5, 9), 1, 1e-6);
  EXPECT_NEAR(corner(Wrap::black, -middle, top), 0, 1e-6);
  // At the border itself half of a neighbour shows.
  EXPECT_NEAR(corner(Wrap::repeat, 0, top), 0.5, 1e-6);
  EXPECT_NEAR(corner(Wrap::clamp, 0, top), 1, 1e-6);
  EXPECT_NEAR(corner(Wrap::black, 0, top), 0.5, 1e-6);
}

// The mean does not change, whatever the size: each halving is weighted by area.
TEST(Image, WholeImageFootprintIsTheMean) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CounterRandom random(seed, 5);
    const int width = 1 + static_cast<int>(40 * random.uniform(0)),
              height = 1 + static_cast<int>(40 * random.uniform(1));
    Vec3 mean;
    const Pixels pixels = made(width, height, [&](int x, int y, int c) {
      const float v = static_cast<float>(random.uniform(10 + 3 * (y * width + x) + c));
      mean[c] += v / (width * height);
      return v;
    });
    const Image image(pixels);
    expectColour(image.at({0.3, 0.8}, {1e6, 0}, {0, 1e6}), mean.x, mean.y, mean.z, 1e-4);
  }
}

TEST(Image, StripesFinerThanAFootprintAreTheirMean) {
  const Image stripes(made(256, 256, [](int x, int, int) { return x % 2 ? 1.0f : 0.0f; }));
  for (const double u : {0.301, 0.4022, 0.555}) {
    expectColour(stripes.at({u, 0.5}, {4.0 / 256, 0}, {0, 4.0 / 256}), 0.5, 0.5, 0.5, 1e-6);
    // Long across the stripes only, and turned by a quarter: the same ellipse.
    expectColour(stripes.at({u, 0.5}, {0, 1.0 / 256}, {16.0 / 256, 0}), 0.5, 0.5, 0.5, 0.05);
  }
}

TEST(Image, LongFootprintKeepsWhatLiesAcross) {
  const Image stripes(made(64, 64, [](int, int y, int) { return y % 8 < 4 ? 1.0f : 0.0f; }));
  // Ten pixels along the stripes, one across: still the stripe's own value.
  EXPECT_NEAR(stripes.at({0.5, 1 - 2.0 / 64}, {10.0 / 64, 0}, {0, 1.0 / 64}).x, 1, 1e-6);
  EXPECT_NEAR(stripes.at({0.5, 1 - 6.0 / 64}, {10.0 / 64, 0}, {0, 1.0 / 64}).x, 0, 1e-6);
  // A footprint below a pixel is no footprint.
  const Vec3 sharp = stripes.at({0.41, 0.33}),
             small = stripes.at({0.41, 0.33}, {1e-4, 0}, {0, 1e-4});
  EXPECT_NEAR(sharp.x, small.x, 1e-12);
}

TEST(Image, NumbersThatAreNoneAreBlack) {
  const Image image(ramps(4, 4));
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = 1.0 / 0.0;
  expectColour(image.at({nan, 0}), 0, 0, 0);
  expectColour(image.at({inf, 0}, {1, 0}, {0, 1}), 0, 0, 0);
  const Vec3 wide = image.at({0.5, 0.5}, {inf, 0}, {0, 1});
  EXPECT_TRUE(isFinite(wide));
  EXPECT_TRUE(isFinite(image.at({1e300, -1e300})));
  EXPECT_TRUE(isFinite(image.at({0.5, 0.5}, {nan, 0}, {0, nan})));
}

TEST(Image, SizesMustFit) {
  Pixels p = ramps(4, 4);
  p.rgb.pop_back();
  EXPECT_THROW(Image{p}, DataError);
  EXPECT_THROW(Image(Pixels{}), DataError);
}

}  // namespace
}  // namespace innermap
