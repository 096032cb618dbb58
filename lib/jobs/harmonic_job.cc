#include "jobs/harmonic_job.h"

#include <fmt/format.h>

#include <algorithm>

namespace innermap {

HarmonicJob harmonicJob(Mesh mesh, BoundaryConditions conditions, double creaseAngle) {
  conditions.creaseAngle = creaseAngle;
  std::string joined = joinedText(removeJumps(mesh, conditions));
  return {makeSourceBoundary(std::move(mesh)), std::move(conditions), std::move(joined)};
}

HarmonicFit HarmonicJob::fit(const HarmonicFitSettings& settings) const {
  HarmonicFit out = fitHarmonic(boundary, conditions, settings);
  if (!joined.empty()) out.notes.push_back(joined);
  return out;
}

MemoryNeed harmonicNeed(std::size_t vertices) {
  return {"the harmonic field", fitMapMemory({}, vertices)};
}

MemoryNeed fieldGridNeed(const Solid& solid, std::size_t channels, const LatticeChoice& grid,
                         const HarmonicGridSettings& settings) {
  return gridNeed("evaluating the field on a grid", grid,
                  [&solid, channels, settings](const LatticeChoice& choice) {
                    return harmonicGridMemory(solid, channels, choice.in(settings));
                  });
}

std::vector<std::string> channelNames(std::size_t count) {
  if (count == 1) return {"value"};
  std::vector<std::string> out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(fmt::format("value{}", k));
  return out;
}

const SurfaceGroup* findGroup(const std::vector<SurfaceGroup>& groups, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const SurfaceGroup& g) { return g.name == name; });
  return found == groups.end() ? nullptr : &*found;
}

std::string noGroup(const std::vector<SurfaceGroup>& groups, const std::string& name) {
  std::vector<std::string> known;
  for (const SurfaceGroup& group : groups) known.push_back(group.name);
  return fmt::format("has no group '{}'; it has {}", name,
                     known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")));
}

}  // namespace innermap
