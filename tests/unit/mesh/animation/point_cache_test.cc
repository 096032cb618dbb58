#include "mesh/animation/detail/point_cache.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/byte_order.h"
#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::TemporaryFolder;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Point i of frame f; floats hold it.
Vec3 placeOf(std::size_t frame, std::size_t i) {
  return {static_cast<double>(frame) + 0.25 * static_cast<double>(i), -2.5 * static_cast<double>(i),
          8.0};
}

std::string places(int frames, int points, bool big) {
  std::string out;
  for (int f = 0; f < frames; ++f)
    for (int i = 0; i < points; ++i)
      for (int a = 0; a < 3; ++a) appendNumber(out, static_cast<float>(placeOf(f, i)[a]), big);
  return out;
}

std::string mdd(int frames, int points) {
  std::string out;
  appendNumber(out, frames, true);
  appendNumber(out, points, true);
  for (int f = 0; f < frames; ++f) appendNumber(out, 0.5f * static_cast<float>(f), true);
  return out + places(frames, points, true);
}

std::string pc2(int frames, int points, float start = 0, float step = 1) {
  std::string out("POINTCACHE2\0", 12);
  appendNumber(out, 1, false);
  appendNumber(out, points, false);
  appendNumber(out, start, false);
  appendNumber(out, step, false);
  appendNumber(out, frames, false);
  return out + places(frames, points, false);
}

class PointCaches : public ::testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const std::string& name, const std::string& content,
                                    const AnimationSettings& settings = {}) {
    return openFrames({folder_.write(name, content)}, settings);
  }

  std::string refusal(const std::string& name, const std::string& content) {
    return test::refusalOf([&] {
      const auto source = open(name, content);
      for (std::size_t i = 0; i < source->numbers.size(); ++i) source->read(i, rest_);
    });
  }

  void expectRefused(const std::string& name, const std::string& content, const std::string& word) {
    const std::string text = refusal(name, content);
    EXPECT_NE(text.find(word), std::string::npos) << text;
    EXPECT_NE(text.find(name), std::string::npos) << text;
  }

  TemporaryFolder folder_;
  const Mesh rest_ = testing::cube();  // 8 points
};

TEST_F(PointCaches, EachFrameIsReadByItself) {
  for (const std::string& name : {std::string("a.mdd"), std::string("a.PC2")}) {
    const auto source = open(name, name == "a.mdd" ? mdd(3, 8) : pc2(3, 8));
    ASSERT_EQ(source->numbers.size(), 3u);
    for (const std::size_t frame : {2u, 0u, 1u}) {
      const Mesh mesh = source->read(frame, rest_);
      EXPECT_EQ(mesh.triangles, rest_.triangles);
      for (std::size_t i = 0; i < 8; ++i)
        for (int a = 0; a < 3; ++a) EXPECT_EQ(mesh.vertices[i][a], placeOf(frame, i)[a]);
    }
    EXPECT_NE(source->fingerprint(0), source->fingerprint(1));
  }
}

TEST_F(PointCaches, FramesAreNumberedAsTheFileOrTheCallerSays) {
  using Numbers = std::vector<std::int64_t>;
  EXPECT_EQ(open("a.mdd", mdd(3, 8))->numbers, (Numbers{1, 2, 3}));
  EXPECT_EQ(open("a.pc2", pc2(3, 8, 4.6f))->numbers, (Numbers{5, 6, 7}));
  EXPECT_EQ(open("a.pc2", pc2(3, 8, -4, 2))->numbers, (Numbers{-4, -2, 0}));
  EXPECT_EQ(open("a.mdd", mdd(2, 8), {.firstFrame = 101})->numbers, (Numbers{101, 102}));
  const auto halves = open("a.pc2", pc2(3, 8, 1, 0.5f), {.firstFrame = 101});
  EXPECT_EQ(halves->numbers, (Numbers{101, 102, 103}));
  EXPECT_EQ(halves->notes.size(), 1u);
}

TEST_F(PointCaches, DamagedOnesAreRefused) {
  for (const std::string& name : {std::string("a.mdd"), std::string("a.pc2")}) {
    const std::string good = name == "a.mdd" ? mdd(3, 8) : pc2(3, 8);
    EXPECT_EQ(refusal(name, good), "accepted");
    for (const std::size_t size : {std::size_t(3), std::size_t(31), good.size() - 1})
      expectRefused(name, good.substr(0, size), "cut short");
    expectRefused(name, good + "abcd", "4 bytes more");
    std::string broken = good;
    std::string bytes;
    appendNumber(bytes, kNan, name == "a.mdd");
    broken.replace(broken.size() - 8, 4, bytes);
    expectRefused(name, broken, "point 7");
    expectRefused(name, name == "a.mdd" ? mdd(2, 7) : pc2(2, 7), "7 points");
  }
  expectRefused("a.mdd", mdd(0, 8), "0 frames");
  expectRefused("a.pc2", pc2(1, 8, kNan), "start");
  expectRefused("a.pc2", pc2(1, 8, 0, 0), "rate");
  expectRefused("a.pc2", "POINTCACHE1" + pc2(1, 8).substr(11), "POINTCACHE2");
}

// Counts whose product is over 64 bits: nothing of the kind is allocated.
TEST_F(PointCaches, CountsBeyondTheFileAreRefused) {
  const int most = std::numeric_limits<int>::max();
  for (const auto& [frames, points] : {std::pair{most, most}, {most, 1}, {1, most}, {-1, 8}}) {
    std::string a;
    appendNumber(a, frames, true);
    appendNumber(a, points, true);
    EXPECT_NE(refusal("a.mdd", a + std::string(500, '\0')), "accepted");
    std::string b = pc2(0, points).substr(0, 28);
    appendNumber(b, frames, false);
    EXPECT_NE(refusal("a.pc2", b + std::string(500, '\0')), "accepted");
  }
}

TEST_F(PointCaches, StandAlone) {
  const std::string a = folder_.write("a.mdd", mdd(1, 8)), b = folder_.write("b.mdd", mdd(1, 8));
  EXPECT_THROW(openFrames({a, b}), FileError);
  EXPECT_THROW(openFrames({(folder_.path() / "none.pc2").string()}), FileError);
  for (const char* scene : {"walk.0001.abc", "walk.USDC", "walk.fbx"})
    EXPECT_THROW(openFrames({scene}), FileError);
}

class WritePointCache : public PointCaches {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  void write(const std::string& name, const std::vector<std::int64_t>& numbers,
             std::size_t frames) const {
    writePointCache(path(name), {8, numbers, 25}, [&](const auto& add) {
      for (std::size_t f = 0; f < frames; ++f) {
        Points points;
        for (std::size_t i = 0; i < 8; ++i) points.push_back(placeOf(f, i));
        add(points);
      }
    });
  }
};

TEST_F(WritePointCache, ReadsBack) {
  for (const char* name : {"a.mdd", "a.pc2"}) {
    write(name, {3, 5, 7}, 3);
    const auto source = openFrames({path(name)});
    for (std::size_t f = 0; f < 3; ++f) {
      const Mesh mesh = source->read(f, rest_);
      for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(mesh.vertices[i].x, placeOf(f, i).x);
    }
  }
  EXPECT_EQ(openFrames({path("a.pc2")})->numbers, (std::vector<std::int64_t>{3, 5, 7}));
  const std::vector<float> seconds = readAnimationInfo(path("a.mdd")).seconds;
  ASSERT_EQ(seconds.size(), 3u);
  EXPECT_FLOAT_EQ(seconds[2], 4 / 25.0f);
}

TEST_F(WritePointCache, AppearsWholeOrNotAtAll) {
  EXPECT_THROW(write("a.mdd", {1, 2, 3}, 2), DataError);
  EXPECT_THROW(write("a.pc2", {1, 2, 4}, 3), FileError);
  EXPECT_THROW(write("a.pc2", {}, 0), DataError);
  EXPECT_THROW(writePointCache(path("a.pc2"), {8, {1}}, [](const auto& add) { add(Points(7)); }),
               DataError);
  EXPECT_THROW(writePointCache(path("a.pc2"), {1, {1}},
                               [](const auto& add) {
                                 add({{1e300, 0, 0}});
                               }),
               DataError);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace innermap
