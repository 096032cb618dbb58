#include "innermap/core/memory.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

TEST(Memory, SizesAreRead) {
  EXPECT_EQ(parseBytes("m", "800M"), 800000000u);
  EXPECT_EQ(parseBytes("m", "1.5GB"), 1500000000u);
  EXPECT_EQ(parseBytes("m", "2GiB"), 2147483648u);
  EXPECT_EQ(parseBytes("m", "12345"), 12345u);
  EXPECT_EQ(parseBytes("m", "64kb"), 64000u);
  EXPECT_EQ(parseBytes("m", "1e9"), 1000000000u);
  EXPECT_EQ(parseBytes("m", "0.001EB"), 1000000000000000u);
}

TEST(Memory, WhatIsNoSizeIsRefused) {
  for (const char* text : {"", "x", "-1", "1Q", "5iB", "nan", "inf", "1e30", "1GBs", " 1", "1e",
                           "1E", "0x10", "0x10M", "1e999"})
    EXPECT_THROW(parseBytes("--max-memory", text), SettingError) << text;
}

TEST(Memory, SizesAreSaidInThreeDigits) {
  EXPECT_EQ(formatBytes(0), "0 B");
  EXPECT_EQ(formatBytes(999), "999 B");
  EXPECT_EQ(formatBytes(1234567), "1.23 MB");
  EXPECT_EQ(formatBytes(999999999), "1 GB");
}

TEST(Memory, OverTheLimitIsRefusedWithAdvice) {
  EXPECT_NO_THROW(requireMemory("x", 100, 100, ""));
  EXPECT_NO_THROW(requireMemory("x", ~0ull, ""));
  EXPECT_EQ(test::refusalOf<MemoryError>(
                [] { requireMemory("the grid", 2000000000, 1000000000, "use larger voxels"); }),
            "the grid needs 2 GB of memory, more than the limit of 1 GB; use larger voxels");
}

TEST(Memory, PeakGrowsWithUse) {
  const std::uint64_t before = peakMemory();
  std::vector<char> block(1 << 27);
  for (std::size_t i = 0; i < block.size(); i += 4096) block[i] = static_cast<char>(i);
  EXPECT_GE(peakMemory(), std::max<std::uint64_t>(before, 1 << 27));
  EXPECT_GE(availableMemory(), peakMemory());
}

TEST(Memory, ThatOfTheProcessCountsWhatItHolds) {
  const std::uint64_t before = processMemory(0);
  EXPECT_GE(before, peakMemory());
  EXPECT_GE(processMemory(1'000'000'000), 1'000'000'000u);
  EXPECT_LE(processMemory(1'000'000'000), 1'001'000'000u + before);
  {
    std::vector<char> block(1 << 28);
    for (std::size_t i = 0; i < block.size(); i += 4096) block[i] = static_cast<char>(i);
    EXPECT_GE(processMemory(1'000'000'000), 1'000'000'000u + block.size());
  }
  // What was freed is there to be used again.
  EXPECT_LT(processMemory(1'000'000'000), 1'000'000'000u + before + (1u << 27));
  EXPECT_EQ(processMemory(~0ull), ~0ull);
}

TEST(Memory, TheLimitIsTheRuns) {
  EXPECT_FALSE(limitsMemory());
  EXPECT_EQ(memoryLeft(), ~0ull);
  {
    const MemoryLimit limit(1000);
    EXPECT_TRUE(limitsMemory());
    EXPECT_EQ(memoryLimit(), 1000u);
    EXPECT_EQ(memoryLeft(), 1u);
    EXPECT_THROW(requireMemory("x", 1001, ""), MemoryError);
    EXPECT_NO_THROW(requireMemory("x", 1000, ""));
    const PartOfStage part(0, 0.5);
    EXPECT_EQ(memoryLimit(), 1000u);
    parallelBlocks(64, 1, [](std::size_t, std::size_t) { EXPECT_EQ(memoryLimit(), 1000u); });
  }
  const MemoryLimit limit(8'000'000'000);
  const std::uint64_t left = memoryLeft();
  EXPECT_GT(left, 7'000'000'000u);
  EXPECT_NEAR(double(processMemory(left)), 8e9, 1e7);
}

TEST(Memory, SaysWhatSizeWouldFit) {
  const SizeOption size{"points", 1, 1000, [](std::uint64_t n) { return 10 * n; }};
  EXPECT_NO_THROW(requireMemoryFor("this", 400, 500, size, "wait"));
  const auto said = [&](std::uint64_t limit) {
    return test::refusalOf<MemoryError>(
        [&] { requireMemoryFor("this", 600, limit, size, "wait"); });
  };
  EXPECT_NE(said(505).find("points 50 "), std::string::npos) << said(505);
  EXPECT_NE(said(5), "accepted");
  EXPECT_EQ(said(5).find("points 1 "), std::string::npos) << said(5);
}

}  // namespace
}  // namespace innermap
