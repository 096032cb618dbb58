#include "io/picture/detail/picture.h"

#include <gtest/gtest.h>

#include "innermap/io/pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

TEST(Ramp, GoesFromBlueOverLightToRed) {
  const Rgb least = rampColour(0), middle = rampColour(0.5), most = rampColour(1);
  EXPECT_GT(least[2], 2 * least[0]);
  EXPECT_GT(most[0], 3 * most[2]);
  EXPECT_GT(middle[0] + middle[1] + middle[2], 2.5f);
  // Redder all the way from the middle of the blues to the middle of the reds.
  for (double t = 0; t < 1; t += 0.05)
    EXPECT_GE(rampColour(t + 0.05)[0] - rampColour(t + 0.05)[2] + 1e-3f,
              rampColour(t)[0] - rampColour(t)[2] - 0.12f)
        << t;
  EXPECT_EQ(rampColour(-5), least);
  EXPECT_EQ(rampColour(5), most);
}

TEST(Ticks, AreRoundAndInside) {
  EXPECT_EQ(tickValues(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
  for (const auto& [lower, upper] :
       {std::pair{-3.7, 12.9}, {1e-9, 2e-9}, {-5e6, 7e6}, {0.99, 1.01}}) {
    const std::vector<double> ticks = tickValues(lower, upper, 6);
    EXPECT_GE(ticks.size(), 3u);
    EXPECT_LE(ticks.size(), 13u);
    for (const double t : ticks) {
      EXPECT_GE(t, lower - 1e-6 * (upper - lower));
      EXPECT_LE(t, upper + 1e-6 * (upper - lower));
    }
  }
  EXPECT_EQ(tickValues(1, 1, 5).size(), 1u);
}

TEST(Picture, TextLeavesInkWhereThereIsAFont) {
  const test::TemporaryFolder folder;
  Picture picture(300, 60, {1, 1, 1});
  picture.text(10, 40, "jacobian 0.5", 20, {0, 0, 0});
  EXPECT_GT(textWidth("jacobian 0.5", 20), 60);
  EXPECT_LT(textWidth("jacobian 0.5", 20), 240);
  const Picture blank(300, 60, {1, 1, 1});
  picture.write(folder.file("a.png"));
  blank.write(folder.file("b.png"));
  const std::string bytes = test::contents(folder.file("a.png"));
  ASSERT_GT(bytes.size(), 8u);
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(bytes == test::contents(folder.file("b.png")), labelFont().empty());
}

}  // namespace
}  // namespace innermap
