// The certificate of a map, against its boundary's triangles and against what these may stand for.
#pragma once

#include <cstdint>

#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/boundary_pair.h"

namespace innermap {

struct MapCertificateSettings {
  bool smooth = false;   // the map was fitted to the vertices, not to the triangles
  double tolerance = 0;  // as CertificateSettings has it, fraction of the target's diagonal
  std::uint64_t seed = 1;
};

// Fractions of the target's diagonal.
struct MapCertificate {
  BoundaryError error;     // from the triangles
  double triangles = 0;    // about the largest distance of these from smooth data, unless `smooth`
  double verticesMax = 0;  // the largest at the vertices, if `smooth`
  // The map is nowhere farther from a smooth map through the vertices, with kCertificateConfidence.
  double smoothBound = 0;
  double accuracy = 0;  // of the sums by which all that was measured, world units of the target
};

// Throws Cancelled.
MapCertificate certifyMap(const ComposedMap& map, const BoundaryPair& pair,
                          const MapCertificateSettings& settings = {});

}  // namespace innermap
