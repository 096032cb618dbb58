#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "innermap/io/solid_pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

// A row of hexahedra along z, n of them.
CellMesh tower(int n) {
  CellMesh mesh{.name = "tower"};
  for (int k = 0; k <= n; ++k)
    for (const auto& [x, y] : {std::pair(0., 0.), {1., 0.}, {1., 1.}, {0., 1.}})
      mesh.vertices.push_back({x, y, static_cast<double>(k)});
  for (int k = 0; k < n; ++k) {
    Hexahedron h{};
    for (int c = 0; c < 8; ++c) h[c] = 4 * k + c;
    mesh.hexahedra.push_back(h);
  }
  return mesh;
}

// The mean of the picture's middle.
Vec3 middle(const std::string& path) {
  const Pixels p = readImage(path).pixels;
  Vec3 sum;
  for (int y = -10; y < 10; ++y)
    for (int x = -10; x < 10; ++x) {
      const std::size_t i = 3 * (static_cast<std::size_t>(p.height / 2 + y) * p.width +
                                 static_cast<std::size_t>(p.width / 2 + x));
      sum += Vec3{p.rgb[i], p.rgb[i + 1], p.rgb[i + 2]} / 400.0;
    }
  return sum;
}

TEST(CellPicture, ShowsTheCellBehindTheCut) {
  const test::TemporaryFolder folder;
  // The second of three cells is the first that shows; it is the bad one, then a good one.
  for (const double value : {0.0, 1.0}) {
    writeCellPicture(folder.file("a.png"), tower(3), {1 - value, value, 1 - value},
                     {.blue = 1, .red = 0, .pixels = 200});
    const Vec3 c = middle(folder.file("a.png"));
    EXPECT_EQ(c.x > c.z, value < 0.5);
  }
}

TEST(CellPicture, RefusesNonsense) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  CellPictureSettings settings;
  EXPECT_THROW(writeCellPicture(path, tower(2), {1}, settings), DataError);
  EXPECT_THROW(writeCellPicture(path, {}, {}, settings), DataError);
  settings.at = 2;
  EXPECT_THROW(writeCellPicture(path, tower(1), {1}, settings), SettingError);
  settings.at = 0.01;  // nothing is left
  EXPECT_THROW(writeCellPicture(path, tower(1), {1}, settings), DataError);
  settings = {};
  settings.red = settings.blue;
  EXPECT_THROW(writeCellPicture(path, tower(1), {1}, settings), SettingError);
  settings = {};
  settings.at = 1;
  test::expectCancels([&] { writeCellPicture(path, tower(1), {1}, settings); });
}

}  // namespace
}  // namespace innermap
