#include "io/exr/detail/exr_verify.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <sstream>
#include <string>

#include "core/expect.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

std::string little(std::int32_t value) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xff);
  return out;
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
  return name + '\0' + type + '\0' + little(static_cast<std::int32_t>(value.size())) + value;
}

std::string channel(const std::string& name, std::int32_t pixels) {
  return name + '\0' + little(pixels) + little(0) + little(1) + little(1);
}

// What is said of a header of these channels.
std::string saidOf(const std::string& channels) {
  const std::string window = little(0) + little(0) + little(3) + little(3);
  const std::string file = little(20000630) + little(2) +
                           attribute("channels", "chlist", channels + '\0') +
                           attribute("dataWindow", "box2i", window) + '\0' + std::string(64, 'x');
  std::istringstream stream(file);
  return test::refusalOf<FileError>([&] { verifyExr("a.exr", stream, file.size()); });
}

// OpenImageIO ends the program at the first two.
TEST(ExrVerify, ChannelsAreOfKnownTypes) {
  EXPECT_NE(saidOf("").find("no channels"), std::string::npos);
  EXPECT_NE(saidOf(channel("R", 3)).find("type"), std::string::npos);
  EXPECT_NE(saidOf(channel("R", 1) + channel("G", -1)).find("type"), std::string::npos);
  for (const std::int32_t pixels : {0, 1, 2})
    EXPECT_EQ(saidOf(channel("R", pixels) + channel("Z", 2)), "accepted");
}

}  // namespace
}  // namespace innermap
