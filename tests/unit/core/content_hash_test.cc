#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

std::string writeFile(const std::string& bytes) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("innermap-hash-" + std::to_string(getpid())))
          .string();
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

TEST(ContentHash, EveryByteAndTheLengthCount) {
  std::set<std::uint64_t> seen;
  std::string text(100, 'a');
  seen.insert(hashOf(text));
  for (std::size_t i = 0; i < text.size(); ++i)
    for (const char c : {'b', '\0', '\xff'}) {
      std::string other = text;
      other[i] = c;
      EXPECT_TRUE(seen.insert(hashOf(other)).second) << i;
    }
  for (std::size_t zeros = 0; zeros < 40; ++zeros)
    EXPECT_TRUE(seen.insert(hashOf(std::string(zeros, '\0'))).second) << zeros;
}

TEST(ContentHash, FilesAreHashedAsTheirBytes) {
  // Over several blocks, with a rest that is no whole word.
  std::string bytes(2'500'003, ' ');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i % 251);
  const std::string path = writeFile(bytes);
  const std::string before = fingerprintOf(path);
  EXPECT_EQ(before, fmt::format("2500003-{:016x}", hashOf(bytes)));
  bytes[2'000'000] ^= 1;
  writeFile(bytes);
  EXPECT_NE(fingerprintOf(path), before);
  std::filesystem::remove(path);
  EXPECT_THROW(fingerprintOf(path), FileError);
  EXPECT_THROW(fingerprintOf(std::filesystem::temp_directory_path().string()), FileError);
}

TEST(ContentHash, CanBeCancelled) {
  const std::string path = writeFile("abc");
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(fingerprintOf(path), Cancelled);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace innermap
