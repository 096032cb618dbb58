// Numbers as compact text that assets/data.js reads: whole numbers of 16 or 32 bits, each less
// the one before it, first the low bytes, then the higher ones, compressed (zlib), base64.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace innermap {

std::string encoded(const std::vector<std::uint16_t>& numbers);
std::string encoded(const std::vector<std::uint32_t>& numbers);

// Values in 16 bits: 0 where there is none, 1 to 65535 from least to greatest, linear or, where
// all are positive and span decades, by their logarithm.
struct Quantised {
  double least = 0, greatest = 0;
  bool logarithmic = false;
  std::string codes;  // encoded
};

template <class Number>
Quantised quantised(const std::vector<Number>& values);

}  // namespace innermap
