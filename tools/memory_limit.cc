#include "memory_limit.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"

namespace innermap::tool {

void requireMemoryFor(const std::string& doing, std::uint64_t bytes, std::uint64_t limit,
                      const SizeOption& size, const std::string& otherwise) {
  std::uint64_t lower = size.least, upper = size.most;
  while (lower < upper) {
    const std::uint64_t middle = lower + (upper - lower + 1) / 2;
    if (size.need(middle) <= limit)
      lower = middle;
    else
      upper = middle - 1;
  }
  requireMemory(doing, bytes, limit,
                size.need(lower) <= limit
                    ? fmt::format("use {} {} or raise --max-memory", size.option, lower)
                    : otherwise);
}

}  // namespace innermap::tool
