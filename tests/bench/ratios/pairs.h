// Pairs of meshes to map: poses, and copies bent and twisted by a fixed smooth function of
// position.
#pragma once

#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "section.h"

namespace innermap::bench {

struct Pair {
  std::string name, source, target;  // mesh files
};

// The horse's five poses.
std::vector<Pair> poses(const Options& options);

// Turned about the longest axis of the box, in proportion to the place along it, by 90 degrees from
// end to end; then bent along it into an eighth of a circle.
Vec3 bentAndTwisted(const Vec3& p, const Box3& box);

// NAME.obj of the models onto its bent and twisted copy, which is written into the scratch folder.
Pair bentAndTwistedPair(const std::string& name, const Options& options);

struct FreshError {
  double rms = 0, p99 = 0, max = 0;  // fractions of the target's diagonal
};

// At boundary points that no fit has seen, the same for every field of a pair.
FreshError freshError(const HarmonicField& field, const Pair& pair);

}  // namespace innermap::bench
