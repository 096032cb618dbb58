// What each job needs of memory, and the refusal where that is too much: the same for all who have
// jobs done, the program and the Python module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "innermap/core/memory.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"

namespace innermap {

struct MemoryNeed {
  std::string doing;        // "evaluating the map on a grid"
  std::uint64_t bytes = 0;  // beside what the process holds
  // What else would help, its settings as "{name}".
  std::string advice = "raise {max_memory}";
  std::optional<SizeOption> size = {};  // a setting that lowers the need, as the library calls it
};

// A setting as the caller's users write it: "--max-memory".
using SettingSpelling = std::function<std::string(const std::string&)>;
inline std::string asCalled(const std::string& setting) { return setting; }

// Throws MemoryError when the need and `held` bytes are over `limit`, with the largest size that
// would fit.
void requireMemory(const MemoryNeed& need, std::uint64_t held, std::uint64_t limit,
                   const SettingSpelling& spelled);

// Of grids, by how fine they are. need: bytes.
MemoryNeed gridNeed(const std::string& doing, const LatticeChoice& grid,
                    const std::function<std::uint64_t(const LatticeChoice&)>& need);

MemoryNeed mapGridNeed(const Solid& solid, const LatticeChoice& grid, const MapGridKind& kind);

// Of meshes of so many vertices.
MemoryNeed correspondNeed(std::size_t verticesA, std::size_t verticesB);

// Of a fit to so many vertices of the source.
MemoryNeed fitNeed(const FitMapSettings& settings, std::size_t vertices);

}  // namespace innermap
