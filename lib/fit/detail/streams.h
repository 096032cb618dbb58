// Seeds of the sets of boundary points that belong to one fit, so that none has a point of another.
#pragma once

#include <cstdint>

namespace innermap {

enum class Stream : std::uint64_t {
  collocation = 0,
  heldOut = 1,
  fresh = 2,
  sources = 3,
  vertices = 4
};

inline std::uint64_t seedOf(std::uint64_t seed, Stream stream) {
  return 4 * seed + static_cast<std::uint64_t>(stream);
}

// Another one for each index; seeds stay below 2^53.
inline std::uint64_t seedOf(std::uint64_t seed, Stream stream, std::uint64_t index) {
  return seedOf(seed, stream) + (index << 53);
}

}  // namespace innermap
