// A map together with the solid that it maps: all that evaluating it, or carrying things through
// it, needs. It is what a map's file holds.
#pragma once

#include <string>

#include "innermap/boundary/boundary_pair.h"
#include "innermap/boundary/injectivity.h"
#include "innermap/field/field_file.h"
#include "innermap/field/harmonic_map.h"

namespace innermap {

struct MappedSolid {
  ComposedMap map;
  BoundaryPair boundary;
  // How the map was made and how good it is, as its file says it: version, source, target, method,
  // interpolation, seed, regularization, rank, boundary_error_rms, boundary_error_p99,
  // boundary_error_max, boundary_error_samples, boundary_error_p99_bound, boundary_error_bound,
  // boundary_error_confidence, boundary_error_smooth_bound, c_error, and boundary_error_triangles
  // or boundary_error_vertices_max, and distance, radius_ratio, tolerance, tolerance_reached,
  // tolerance_met where they apply; those of injectivityFacts.
  Facts facts;
  // As far as points tell; what grids tell, evaluateOnGrid adds.
  Injectivity injectivity;

  const Solid& solid() const { return boundary.solid(); }
};

// One step of a map in steps.
struct MapStep {
  double from = 0, to = 0;  // the part of the way that it goes, in [0, 1]
  std::size_t sources = 0;
  double error = 0;   // its own, at 99% of its boundary, fraction of its target's diagonal
  double folded = 0;  // share of the points inside that it folds
};

// The map's file: one PLY, see field_file.h. Throws FileError when it cannot be written; it appears
// whole or not at all.
void writeMap(const std::string& path, const MappedSolid& mapped);

// Reads it and makes the solid again. Throws FileError for what is not the file of a map with its
// boundary, DataError as makeBoundaryPair does, Cancelled.
MappedSolid readMap(const std::string& path);

// How accurate sums of charges have to be, a fraction of the target's diagonal, in [1e-9, 1e-5]:
// well below the map's own error as its facts state that.
double sumAccuracy(const MappedSolid& mapped);

// The same for a map whose boundary error has that root mean square.
double sumAccuracy(double boundaryErrorRms);

}  // namespace innermap
