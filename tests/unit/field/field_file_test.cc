#include "innermap/field/field_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/expect.h"
#include "core/temporary_folder.h"
#include "field/sphere_problem.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

using testing::withGradients;

class FieldFileTest : public ::testing::Test {
 protected:
  FieldFile sample() const {
    FieldFile f{
        {testing::someField()}, {{"method", "tikhonov"}, {"note", "two words"}}, {}, {}, {}};
    f.boundary = testing::randomPoints(5, 1);
    f.boundaryTarget = testing::randomPoints(5, 2);
    f.boundaryTriangles = {{0, 1, 2}, {2, 3, 4}};
    return f;
  }

  std::string contents() const { return test::contents(path_); }
  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }

  test::TemporaryFolder folder_;
  std::string path_ = folder_.file("map.ply");
};

TEST_F(FieldFileTest, ReadsBackTheSameBits) {
  const FieldFile before = sample();
  writeField(path_, before);
  const FieldFile after = readField(path_);
  const Points points = testing::randomPoints(200, 3);
  const FieldSamples a = before.steps[0].evaluate(points, withGradients()),
                     b = after.steps[0].evaluate(points, withGradients());
  EXPECT_EQ(0, std::memcmp(a.values.data(), b.values.data(), 600 * sizeof(double)));
  EXPECT_EQ(0, std::memcmp(a.gradients.data(), b.gradients.data(), 1800 * sizeof(double)));
  EXPECT_EQ(after.facts, before.facts);
  EXPECT_EQ(after.boundaryTriangles, before.boundaryTriangles);
  EXPECT_EQ(after.boundary[4].z, before.boundary[4].z);
  EXPECT_EQ(after.boundaryTarget[0].x, before.boundaryTarget[0].x);
}

TEST_F(FieldFileTest, StepsComeBackInOrder) {
  FieldFile before = sample();
  Affine affine;
  affine.coefficients = Matrix(4, 3);
  before.steps.push_back(HarmonicField({{1, 2, 3}}, Matrix(1, 3), affine));
  before.steps.push_back(before.steps[0]);
  writeField(path_, before);
  const FieldFile after = readField(path_);
  ASSERT_EQ(after.steps.size(), 3u);
  EXPECT_EQ(after.steps[1].sources()[0].z, 3);
  EXPECT_EQ(after.facts, before.facts);
  const Points points = testing::randomPoints(20, 3);
  for (const std::size_t step : {0, 2}) {
    const Matrix a = before.steps[step].evaluate(points).values,
                 b = after.steps[step].evaluate(points).values;
    EXPECT_EQ(0, std::memcmp(a.data(), b.data(), 60 * sizeof(double)));
  }
  const std::string good = contents();
  const std::size_t counts = good.find("step_sources 30 1 30");
  ASSERT_NE(counts, std::string::npos);
  for (const char* lie : {"step_sources 30 2 30", "step_sources 61 0   ", "step_sources 30 31  "}) {
    std::string bad = good;
    write(bad.replace(counts, 20, lie));
    EXPECT_THROW(readField(path_), FileError) << lie;
  }
  before.steps[1] = HarmonicField({}, Matrix(0, 2), Affine{{}, Matrix(4, 2)});
  EXPECT_THROW(writeField(path_, before), DataError);
}

TEST_F(FieldFileTest, IsToldFromOtherFiles) {
  EXPECT_FALSE(isFieldFile(path_));
  write("ply\nformat ascii 1.0\n");
  EXPECT_FALSE(isFieldFile(path_));
  writeField(path_, sample());
  EXPECT_TRUE(isFieldFile(path_));
}

TEST_F(FieldFileTest, TruncatedAtAnyPlaceIsRefused) {
  writeField(path_, sample());
  const std::string whole = contents();
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 8) {
    write(whole.substr(0, size));
    EXPECT_THROW(readField(path_), FileError) << size;
  }
  write(whole + "x");
  EXPECT_THROW(readField(path_), FileError);
}

TEST_F(FieldFileTest, LyingHeaderIsRefusedBeforeAllocating) {
  writeField(path_, sample());
  std::string text = contents();
  text.replace(text.find("element vertex 30"), 17, "element vertex 400000000000");
  write(text);
  EXPECT_THROW(readField(path_), FileError);
}

TEST_F(FieldFileTest, CorruptBytesNeverCrash) {
  writeField(path_, sample());
  const std::string whole = contents();
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CounterRandom random(seed, 1);
    std::string text = whole;
    for (int i = 0; i < 4; ++i)
      text[random.bits(2 * i) % text.size()] = static_cast<char>(random.bits(2 * i + 1));
    write(text);
    test::refusalOf([&] { readField(path_); });
  }
}

// Maps of version 0.1.0, as the fuzzers' corpus keeps them.
TEST_F(FieldFileTest, FilesOfEarlierVersionsAreRead) {
  const std::filesystem::path kept =
      std::filesystem::path(INNERMAP_SAMPLES) / ".." / "tests" / "fuzz" / "corpus" / "map.ply";
  const FieldFile one = readField(kept / "one.map.ply");
  ASSERT_EQ(one.steps.size(), 1u);
  EXPECT_EQ(one.steps[0].sources().size(), 4u);
  EXPECT_EQ(one.steps[0].channels(), 3u);
  EXPECT_EQ(one.boundary.size(), 6u);
  EXPECT_EQ(one.boundaryTriangles.size(), 8u);
  EXPECT_EQ(factText(one.facts, "source"), "a.obj");
  EXPECT_DOUBLE_EQ(*factNumber(one.facts, "boundary_error_rms"), 1e-4);
  const FieldFile composed = readField(kept / "composed.map.ply");
  ASSERT_EQ(composed.steps.size(), 3u);
  EXPECT_EQ(composed.steps[0].sources().size(), 3u);
}

TEST_F(FieldFileTest, NewerFormatsAreRefusedInWords) {
  writeField(path_, sample());
  std::string text = contents();
  const std::string line = "comment innermap field ";
  const auto refusal = [&](const std::string& format) {
    std::string other = text;
    other.replace(other.find(line) + line.size(), 1, format);
    write(other);
    return test::refusalOf<FileError>([&] { readField(path_); });
  };
  EXPECT_NE(refusal("3").find("newer"), std::string::npos);
  EXPECT_NE(refusal("17").find("17"), std::string::npos);
  for (const char* none : {"0", "", "x", "-1", "123456789"})
    EXPECT_EQ(refusal(none).find("newer"), std::string::npos) << none;
}

TEST_F(FieldFileTest, MissingFolderAndBadSettingsAreRefused) {
  EXPECT_THROW(writeField(folder_.file("no/map.ply"), sample()), FileError);
  FieldFile bad = sample();
  bad.facts.emplace_back("x", "two\nlines");
  EXPECT_THROW(writeField(path_, bad), DataError);
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_THROW(readField(path_), FileError);
}

}  // namespace
}  // namespace innermap
