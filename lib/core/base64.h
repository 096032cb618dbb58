// Bytes as text of 64 letters (RFC 4648), for files that are text.
#pragma once

#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <string_view>

namespace innermap {

// The six bits that a letter stands for; -1 for what is no digit.
int base64Digit(char letter);

// Of bytes that come in pieces; the end, with its padding, is written when it is destroyed.
class Base64Writer {
 public:
  explicit Base64Writer(std::ostream& stream) : stream_(stream) {}
  ~Base64Writer();
  Base64Writer(const Base64Writer&) = delete;
  Base64Writer& operator=(const Base64Writer&) = delete;

  void addBytes(std::string_view bytes);

  // The bytes of a number as the machine has them.
  template <class T>
  void add(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    addBytes({bytes, sizeof(T)});
  }

 private:
  void put(int bytes);

  std::ostream& stream_;
  std::string text_;
  std::uint32_t bits_ = 0;
  int held_ = 0;
};

}  // namespace innermap
