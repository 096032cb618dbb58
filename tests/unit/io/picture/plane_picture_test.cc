#include <gtest/gtest.h>

#include <limits>

#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "innermap/io/solid_pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

const Box3 kBox{{0, 0, 0}, {1, 1, 1}};

// x, and nothing above the middle.
std::vector<double> half(const Points& points) {
  std::vector<double> out;
  for (const Vec3& p : points)
    out.push_back(p.y > 0.5 ? std::numeric_limits<double>::quiet_NaN() : p.x);
  return out;
}

TEST(PlanePicture, ShowsValuesAndBlanks) {
  const test::TemporaryFolder folder;
  writePlanePicture(folder.file("a.png"), kBox, {{"half", half}, {"again", half}}, {.pixels = 100});
  const Pixels p = readImage(folder.file("a.png")).pixels;
  EXPECT_EQ(p.width, 3 * 24 + 2 * 100);
  const auto at = [&](int x, int y) {
    const std::size_t i = 3 * (static_cast<std::size_t>(44 + y) * p.width + 24 + x);
    return Vec3{p.rgb[i], p.rgb[i + 1], p.rgb[i + 2]};
  };
  EXPECT_GT(at(10, 75).z, at(10, 75).x);  // blue at the left
  EXPECT_GT(at(90, 75).x, at(90, 75).z);  // red at the right
  EXPECT_NEAR(at(50, 20).x, 1, 1e-6);     // blank
  EXPECT_NEAR(at(50, 20).z, 1, 1e-6);
}

TEST(PlanePicture, RefusesNonsense) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  PlanePictureSettings settings;
  EXPECT_THROW(writePlanePicture(path, kBox, {}, settings), DataError);
  EXPECT_THROW(writePlanePicture(path, Box3(), {{"half", half}}, settings), DataError);
  settings.axis = 3;
  EXPECT_THROW(writePlanePicture(path, kBox, {{"half", half}}, settings), SettingError);
  settings = {};
  settings.at = -1;
  EXPECT_THROW(writePlanePicture(path, kBox, {{"half", half}}, settings), SettingError);
  settings = {};
  settings.red = settings.blue;
  EXPECT_THROW(writePlanePicture(path, kBox, {{"half", half}}, settings), SettingError);
}

}  // namespace
}  // namespace innermap
