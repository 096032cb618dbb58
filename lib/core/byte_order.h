// Numbers in a file's byte order. Machines that innermap runs on have the least byte first.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>

namespace innermap {

// big: the file has the greatest byte first. bytes: sizeof(Number) of them are there.
template <class Number>
Number numberAt(const char* bytes, bool big = false) {
  char ordered[sizeof(Number)];
  std::memcpy(ordered, bytes, sizeof(Number));
  if (big) std::reverse(ordered, ordered + sizeof(Number));
  Number value;
  std::memcpy(&value, ordered, sizeof(Number));
  return value;
}

template <class Number>
void putNumber(char* bytes, Number value, bool big = false) {
  std::memcpy(bytes, &value, sizeof(Number));
  if (big) std::reverse(bytes, bytes + sizeof(Number));
}

template <class Number>
void appendNumber(std::string& to, Number value, bool big = false) {
  to.resize(to.size() + sizeof(Number));
  putNumber(to.data() + to.size() - sizeof(Number), value, big);
}

}  // namespace innermap
