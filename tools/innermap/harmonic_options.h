// What `harmonic` and `weights` share: a field from conditions on a mesh, its grids, its file.
#pragma once

#include <string>
#include <vector>

#include "command.h"
#include "grid_options.h"
#include "innermap/fit/fit_harmonic.h"

namespace innermap::tool {

struct HarmonicOptions {
  std::string mesh, output, field;
  HarmonicFitSettings fit;
  double creaseAngle = BoundaryConditions{}.creaseAngle;
  bool bestEffort = false;
  LatticeChoice grid;
  std::string grids;  // comma list
  NamingScheme names = NamingScheme::innermap;
};

void addHarmonicOptions(Command& command, HarmonicOptions& options,
                        const std::string& defaultGrids);

// What is known on the surface, with the channels' names.
struct NamedConditions {
  BoundaryConditions conditions;
  std::vector<std::string> names;
};

// Fits, evaluates and writes. conditionsOf: called with the mesh.
void runHarmonic(const HarmonicOptions& options,
                 const std::function<NamedConditions(const Mesh& mesh)>& conditionsOf,
                 Context& context);

}  // namespace innermap::tool
