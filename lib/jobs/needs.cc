#include "jobs/needs.h"

#include <fmt/format.h>

#include "innermap/core/setting.h"
#include "innermap/correspond/mesh_correspondence.h"

namespace innermap {

void requireMemory(const MemoryNeed& need, std::uint64_t held, std::uint64_t limit,
                   const SettingSpelling& spelled) {
  const std::string advice = withNames(need.advice, spelled);
  if (!need.size) return requireMemory(need.doing, held + need.bytes, limit, advice);
  const auto inAll = [&](std::uint64_t value) { return held + need.size->need(value); };
  requireMemoryFor(need.doing, held + need.bytes, limit,
                   {spelled(need.size->setting), need.size->least, need.size->most, inAll}, advice);
}

MemoryNeed gridNeed(const std::string& doing, const LatticeChoice& grid,
                    const std::function<std::uint64_t(const LatticeChoice&)>& need) {
  const auto at = [need](std::uint64_t resolution) {
    LatticeChoice other;
    other.resolution = static_cast<int>(resolution);
    return need(other);
  };
  MemoryNeed out{doing, need(grid)};
  out.size = {"resolution", kLeastVoxels, kMostVoxels, at};
  return out;
}

MemoryNeed mapGridNeed(const Solid& solid, const LatticeChoice& grid, const MapGridKind& kind) {
  return gridNeed("evaluating the map on a grid", grid, [&solid, kind](const LatticeChoice& o) {
    return mapGridMemory(solid, o.in<MapGridSettings>(), kind);
  });
}

MemoryNeed correspondNeed(std::size_t verticesA, std::size_t verticesB) {
  return {"the correspondence", correspondMemory(verticesA, verticesB), "use coarser meshes"};
}

MemoryNeed fitNeed(const FitMapSettings& settings, std::size_t vertices) {
  MemoryNeed out{"the first level of charges", fitMapMemory(settings, vertices)};
  if (!settings.shell) return out;
  const std::size_t sources = settings.shell->sources;
  const double points =
      static_cast<double>(shellCollocation(*settings.shell)) / static_cast<double>(sources);
  out.doing = fmt::format("fitting {} charges", sources);
  out.size = {"charges", 1, sources, [=](std::uint64_t fewer) {
                FitMapSettings other = settings;
                other.shell->sources = fewer;
                other.shell->collocation =
                    static_cast<std::size_t>(points * static_cast<double>(fewer));
                return fitMapMemory(other, vertices);
              }};
  return out;
}

}  // namespace innermap
