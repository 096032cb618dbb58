// Memory that is refused with the setting that would do.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace innermap::tool {

// A whole number that --`option` gives, and the bytes that it needs: more for more.
struct SizeOption {
  std::string option;
  std::uint64_t least = 1, most = 1;
  std::function<std::uint64_t(std::uint64_t)> need;
};

// Throws MemoryError when `bytes` are over `limit`, with the largest size that would fit; with
// `otherwise` where none does. doing: "fitting 2000 charges".
void requireMemoryFor(const std::string& doing, std::uint64_t bytes, std::uint64_t limit,
                      const SizeOption& size, const std::string& otherwise = "raise --max-memory");

}  // namespace innermap::tool
