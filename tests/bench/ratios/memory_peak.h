// The largest resident size since it was last asked to forget.
#pragma once

#include <malloc.h>

#include <cstdint>
#include <fstream>
#include <string>

namespace innermap::bench {

// Starts the peak anew from the present size, without what was freed; Linux only, elsewhere the
// peak stays what it was.
inline void forgetPeakMemory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

inline std::uint64_t statusBytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key + ":", 0) == 0) return 1024 * std::stoull(line.substr(key.size() + 1));
  return 0;
}

inline std::uint64_t residentMemory() { return statusBytes("VmRSS"); }
inline std::uint64_t peakSinceForgotten() { return statusBytes("VmHWM"); }

}  // namespace innermap::bench
