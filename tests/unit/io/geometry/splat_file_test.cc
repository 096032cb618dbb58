// Files of Gaussian splats, written by hand here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/io/geometry_file.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using test::pathOf;
using test::written;

// A splat, and the names of its properties.
struct Row {
  std::vector<std::string> names;
  std::vector<float> values;

  void add(const std::string& name, float value) {
    names.push_back(name);
    values.push_back(value);
  }
  void set(const std::string& name, float value) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) values[i] = value;
  }
  void rename(const std::string& from, const std::string& to) {
    for (std::string& name : names)
      if (name == from) name = to;
  }
  float at(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return values[i];
    return NAN;
  }
};

// As the reference writes them, with something of the user's between.
Row splat(int rest) {
  Row row;
  for (const char* name : {"x", "y", "z"}) row.add(name, 0.5f);
  for (const char* name : {"nx", "ny", "nz"}) row.add(name, 0);
  for (int i = 0; i < 3; ++i) row.add("f_dc_" + std::to_string(i), 0.1f * static_cast<float>(i));
  for (int i = 0; i < rest; ++i)
    row.add("f_rest_" + std::to_string(i), 0.01f * static_cast<float>(i + 1));
  row.add("opacity", 1.25f);
  row.add("label", 7);
  for (int i = 0; i < 3; ++i) row.add("scale_" + std::to_string(i), -2.f - static_cast<float>(i));
  const float q[4] = {0.5f, -1, 0.25f, 2};
  for (std::size_t i = 0; i < 4; ++i) row.add("rot_" + std::to_string(i), q[i]);
  return row;
}

std::string bytesOf(const std::vector<Row>& rows, bool ascii = false) {
  std::ostringstream out;
  out << "ply\nformat " << (ascii ? "ascii" : "binary_little_endian")
      << " 1.0\ncomment a capture\nelement vertex " << rows.size() << "\n";
  for (const std::string& name : rows[0].names) out << "property float " << name << "\n";
  out << "end_header\n";
  for (const Row& row : rows) {
    for (const float value : row.values)
      if (ascii)
        out << value << ' ';
      else
        out.write(reinterpret_cast<const char*>(&value), 4);
    if (ascii) out << "\n";
  }
  return out.str();
}

std::vector<Row> rowsOf(const std::string& bytes, const Row& like) {
  std::vector<Row> out;
  for (std::size_t at = bytes.find("end_header\n") + 11; at < bytes.size();) {
    Row row = like;
    for (float& value : row.values) {
      std::memcpy(&value, bytes.data() + at, 4);
      at += 4;
    }
    out.push_back(row);
  }
  return out;
}

// Twice as long along x; beyond x = 5 all is cut.
CarriedPoints stretch(const Points& points, bool jacobians) {
  CarriedPoints out;
  for (const Vec3& p : points) {
    out.points.push_back({2 * p.x, p.y, p.z});
    if (jacobians) out.jacobians.push_back({{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    out.fates.push_back(p.x > 5 ? PointFate::cut : PointFate::carried);
    out.cut += p.x > 5;
  }
  return out;
}

CarriedPoints stay(const Points& points, bool jacobians) {
  CarriedPoints out{.points = points};
  if (jacobians) out.jacobians.assign(points.size(), {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  out.fates.assign(points.size(), PointFate::carried);
  return out;
}

std::string carriedBytes(const std::string& bytes, const PointCarry& carry,
                         SplatOpacity opacity = SplatOpacity::look) {
  const auto file = readGeometry(written("splats.ply", bytes));
  const CarriedGeometry carried = carryGeometry(file->geometry, carry, {.splats = opacity});
  writeGeometry(pathOf("out.ply"), *file, carried);
  return test::contents(pathOf("out.ply"));
}

TEST(SplatFile, OfEveryDegreeThatStayIsTheSameBytes) {
  for (const int rest : {0, 9, 24, 45}) {
    const std::string bytes = bytesOf(std::vector<Row>(9000, splat(rest)));
    EXPECT_TRUE(carriedBytes(bytes, stay) == bytes) << rest;
  }
  Row opaque = splat(9);
  opaque.set("opacity", std::numeric_limits<float>::infinity());
  EXPECT_TRUE(carriedBytes(bytesOf({opaque}), stay) == bytesOf({opaque}));
}

Splat splatOf(const Row& row, int rest) {
  Splat out{.degree = rest == 45 ? 3 : rest == 24 ? 2 : rest == 9 ? 1 : 0};
  for (int i = 0; i < 3; ++i) out.logScales[i] = row.at("scale_" + std::to_string(i));
  for (std::size_t i = 0; i < 4; ++i) out.quaternion[i] = row.at("rot_" + std::to_string(i));
  for (int i = 0; i < rest; ++i)
    out.harmonics[static_cast<std::size_t>(i)] = row.at("f_rest_" + std::to_string(i));
  out.opacity = row.at("opacity");
  return out;
}

// What carriedSplat() says, in each row and property, and what is cut is gone.
TEST(SplatFile, AreCarriedByTheirJacobians) {
  for (const SplatOpacity opacity : {SplatOpacity::look, SplatOpacity::mass}) {
    std::vector<Row> rows(3, splat(45));
    rows[1].set("x", 9);
    rows[2].set("rot_1", 3);
    rows[2].set("f_rest_17", -2);
    const std::vector<Row> out = rowsOf(carriedBytes(bytesOf(rows), stretch, opacity), rows[0]);
    ASSERT_EQ(out.size(), 2u);
    for (int i = 0; i < 2; ++i) {
      const Row &before = rows[static_cast<std::size_t>(2 * i)],
                &after = out[static_cast<std::size_t>(i)];
      const Splat expected =
          carriedSplat({{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, splatOf(before, 45), opacity).splat;
      const Splat got = splatOf(after, 45);
      EXPECT_NEAR(after.at("x"), 1, 1e-7);
      EXPECT_EQ(after.at("label"), 7);
      EXPECT_NEAR(after.at("f_dc_1"), 0.1f, 1e-9);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(got.logScales[k], expected.logScales[k], 1e-6);
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(got.quaternion[k], expected.quaternion[k], 1e-6);
      for (std::size_t k = 0; k < 45; ++k)
        EXPECT_NEAR(got.harmonics[k], expected.harmonics[k], 1e-6);
      EXPECT_NEAR(got.opacity, expected.opacity, 1e-6);
      EXPECT_EQ(opacity == SplatOpacity::look, std::abs(got.opacity - 1.25) < 1e-6);
    }
  }
}

// An opacity that stays, stays as it is spelt.
TEST(SplatFile, TextIsReadToo) {
  std::string text = bytesOf({splat(9)}, true);
  text.replace(text.find(" 1.25 7"), 5, " 1.250");
  const std::string out = carriedBytes(text, stay);
  EXPECT_NE(out.find(" 1.250 7 -2 -3 -4 0.5 -1 0.25 2"), std::string::npos) << out;
}

void expectError(const std::vector<Row>& rows, const std::string& part) {
  const std::string path = written("bad.ply", bytesOf(rows));
  test::expectRefused<FileError>([&] { readGeometry(path); }, part);
}

TEST(SplatFile, NumbersThatSayNothing) {
  const float none = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  Row row = splat(9);
  for (int i = 0; i < 4; ++i) row.set("rot_" + std::to_string(i), 0);
  expectError({splat(9), row}, "splat 1 has a quaternion (rot_0 to rot_3) of length 0");
  for (const float value : {none, infinite, -infinite}) {
    for (const auto& [name, part] :
         std::vector<std::pair<std::string, std::string>>{{"scale_1", "splat 1 has a scale"},
                                                          {"rot_2", "splat 1 has a quaternion"},
                                                          {"f_rest_8", "splat 1 has a colour"},
                                                          {"x", "vertex 1"}}) {
      row = splat(9);
      row.set(name, value);
      expectError({splat(9), row}, part);
    }
  }
  row = splat(9);
  row.set("opacity", none);
  expectError({splat(9), row}, "splat 1 has an opacity");
}

TEST(SplatFile, PropertiesThatAreNotThose) {
  for (const int rest : {1, 3, 10, 44, 46, 72}) expectError({splat(rest)}, "9, 24 or 45");
  Row row = splat(9);
  row.rename("f_rest_4", "f_rest_9");
  expectError({row}, "'f_rest_9' is not one of 9");
  for (const char* name : {"scale_2", "rot_3", "opacity"}) {
    row = splat(9);
    row.rename(name, "other");
    expectError({row}, std::string("no '") + name + "'");
    row.rename("other", name);
    row.rename("label", name);
    expectError({row}, "is there twice");
  }
  std::string bytes = bytesOf({splat(9)});
  bytes.replace(bytes.find("float opacity"), 5, "uint");
  EXPECT_THROW(readGeometry(written("bad.ply", bytes)), FileError);
  // Neither scales nor turns: a cloud of points, however it calls its numbers.
  row = splat(10);
  row.rename("scale_0", "size");
  EXPECT_EQ(readGeometry(written("cloud.ply", bytesOf({row})))->geometry.splats.degree, -1);
}

TEST(SplatFile, CountsThatLie) {
  std::string bytes = bytesOf({splat(9)});
  bytes.replace(bytes.find("vertex 1"), 8, "vertex 4000000000");
  EXPECT_THROW(readGeometry(written("bad.ply", bytes)), FileError);
  bytes = bytesOf({splat(9)});
  EXPECT_THROW(readGeometry(written("bad.ply", bytes.substr(0, bytes.size() - 1))), FileError);
}

TEST(SplatFile, MemoryIsThatOfPointsAndTheFile) {
  const std::string path = written("many.ply", bytesOf(std::vector<Row>(40000, splat(45))));
  const std::uint64_t need = geometryMemory(path), size = test::contents(path).size();
  EXPECT_GT(need, size + 40000 * 150);
  EXPECT_LT(need, size + 80000000);  // with one pass
  test::expectOverLimit(size, [&] { readGeometry(path); });
}

TEST(SplatFile, MassIsForSplats) {
  const auto file = readGeometry(written(
      "cloud.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n0 0 0\n"));
  EXPECT_THROW(carryGeometry(file->geometry, stay, {.splats = SplatOpacity::mass}), SettingError);
  const auto splats = readGeometry(written("one.ply", bytesOf({splat(9)})));
  EXPECT_THROW(
      carryGeometry(splats->geometry, stay, {.subdivide = 0.1, .splats = SplatOpacity::mass}),
      SettingError);
}

TEST(SplatFile, CappedOpacitiesAreCounted) {
  const auto shrink = [](const Points& points, bool jacobians) {
    CarriedPoints out = stay(points, jacobians);
    for (Mat3& j : out.jacobians) j = {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}};
    return out;
  };
  std::vector<Row> rows(3, splat(0));
  rows[1].set("opacity", -3);  // a twentieth
  const auto file = readGeometry(written("splats.ply", bytesOf(rows)));
  EXPECT_EQ(file->cappedOpacities(carryGeometry(file->geometry, shrink, {})), 0u);
  EXPECT_EQ(
      file->cappedOpacities(carryGeometry(file->geometry, shrink, {.splats = SplatOpacity::mass})),
      2u);
}

}  // namespace
}  // namespace innermap
