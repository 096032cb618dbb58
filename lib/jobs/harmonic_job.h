// The job of a harmonic field, from what is known on a surface.
#pragma once

#include <string>
#include <vector>

#include "innermap/fit/fit_harmonic.h"
#include "jobs/needs.h"

namespace innermap {

struct HarmonicJob {
  SourceBoundary boundary;
  BoundaryConditions conditions;
  std::string joined;  // what became of values that jump where groups touch; empty: there are none

  HarmonicFit fit(const HarmonicFitSettings& settings) const;
};

HarmonicJob harmonicJob(Mesh mesh, BoundaryConditions conditions, double creaseAngle);

// Of the fit on a mesh of so many vertices; of the grids of so many channels.
MemoryNeed harmonicNeed(std::size_t vertices);
MemoryNeed fieldGridNeed(const Solid& solid, std::size_t channels, const LatticeChoice& grid,
                         const HarmonicGridSettings& settings);

// Of so many channels that nobody named.
std::vector<std::string> channelNames(std::size_t count);

// null: there is none of this name, which noGroup() says, with those that there are.
const SurfaceGroup* findGroup(const std::vector<SurfaceGroup>& groups, const std::string& name);
std::string noGroup(const std::vector<SurfaceGroup>& groups, const std::string& name);

}  // namespace innermap
