#include "core/base64.h"

#include <array>

namespace innermap {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<signed char, 256> makeBits() {
  std::array<signed char, 256> bits{};
  for (signed char& b : bits) b = -1;
  for (std::size_t d = 0; d < kDigits.size(); ++d)
    bits[static_cast<unsigned char>(kDigits[d])] = static_cast<signed char>(d);
  return bits;
}

}  // namespace

int base64Digit(char letter) {
  static constexpr std::array<signed char, 256> kBits = makeBits();
  return kBits[static_cast<unsigned char>(letter)];
}

Base64Writer::~Base64Writer() {
  if (held_ > 0) put(held_);
  stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
}

void Base64Writer::addBytes(std::string_view bytes) {
  for (const char byte : bytes) {
    bits_ = bits_ << 8 | static_cast<unsigned char>(byte);
    if (++held_ == 3) put(3);
  }
}

void Base64Writer::put(int bytes) {
  constexpr std::size_t kAtOnce = 1u << 20;
  const std::uint32_t bits = bits_ << (8 * (3 - bytes));
  for (int k = 0; k < 4; ++k)
    text_.push_back(k <= bytes ? kDigits[bits >> (18 - 6 * k) & 63] : '=');
  bits_ = 0;
  held_ = 0;
  if (text_.size() < kAtOnce) return;
  stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
  text_.clear();
}

}  // namespace innermap
