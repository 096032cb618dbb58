#include <gtest/gtest.h>

#include <cmath>

#include "innermap/io/pictures.h"

namespace innermap {
namespace {

double lightness(const Vec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

TEST(Colormap, LightnessRisesAlongSequentialOnes) {
  for (const auto& [name, map] : colormapNames()) {
    if (map == Colormap::redBlue) continue;
    for (int i = 0; i < 50; ++i)
      EXPECT_LT(lightness(colormapColour(map, i / 50.0)),
                lightness(colormapColour(map, (i + 1) / 50.0)))
          << name << " " << i;
  }
}

TEST(Colormap, TheDivergingOneIsLightestInTheMiddle) {
  const double middle = lightness(colormapColour(Colormap::redBlue, 0.5));
  for (const double t : {0.0, 0.2, 0.8, 1.0})
    EXPECT_GT(middle, lightness(colormapColour(Colormap::redBlue, t)) + 0.1) << t;
  EXPECT_GT(colormapColour(Colormap::redBlue, 0).z, colormapColour(Colormap::redBlue, 0).x);
  EXPECT_GT(colormapColour(Colormap::redBlue, 1).x, colormapColour(Colormap::redBlue, 1).z);
}

TEST(Colormap, EndsHoldBeyondTheRangeAndForNoNumber) {
  for (const auto& [name, map] : colormapNames()) {
    const Vec3 low = colormapColour(map, 0), high = colormapColour(map, 1);
    EXPECT_NEAR(norm(colormapColour(map, -3) - low), 0, 1e-12) << name;
    EXPECT_NEAR(norm(colormapColour(map, 7) - high), 0, 1e-12) << name;
    EXPECT_NEAR(norm(colormapColour(map, std::nan("")) - low), 0, 1e-12) << name;
    for (const Vec3& c : {low, high})
      for (int k = 0; k < 3; ++k) EXPECT_TRUE(c[k] >= 0 && c[k] <= 1) << name;
  }
}

}  // namespace
}  // namespace innermap
