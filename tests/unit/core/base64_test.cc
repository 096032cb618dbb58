#include "core/base64.h"

#include <gtest/gtest.h>

#include <sstream>

namespace innermap {
namespace {

std::string encoded(std::string_view bytes, std::size_t pieces = 1) {
  std::ostringstream out;
  {
    Base64Writer writer(out);
    for (std::size_t i = 0; i < pieces; ++i) writer.addBytes(bytes);
  }
  return out.str();
}

// RFC 4648, section 10.
TEST(Base64, TestVectors) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded(std::string_view("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Base64, Digits) {
  EXPECT_EQ(base64Digit('A'), 0);
  EXPECT_EQ(base64Digit('z'), 51);
  EXPECT_EQ(base64Digit('/'), 63);
  for (const char c : {'=', '-', ' ', '\n', '\xff'}) EXPECT_EQ(base64Digit(c), -1);
}

TEST(Base64, PiecesHaveNoSeams) {
  EXPECT_EQ(encoded("fo", 3), "Zm9mb2Zv");
  const std::string many = encoded("foo", 400000);  // more than is written at once
  EXPECT_EQ(many.size(), 1600000u);
  EXPECT_EQ(many.substr(many.size() - 8), "Zm9vZm9v");
}

TEST(Base64, NumbersAreTheirBytes) {
  std::ostringstream out;
  { Base64Writer(out).add<std::uint16_t>(0x6f66); }
  EXPECT_EQ(out.str(), "Zm8=");
}

}  // namespace
}  // namespace innermap
