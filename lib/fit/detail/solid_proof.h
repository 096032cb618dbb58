// Proofs about the solid of a map.
#pragma once

#include <string>
#include <vector>

#include "innermap/fit/boundary_pair.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

// Of the solid as it was fitted. Where parts overlap, shares are those of what they fill together.
SenseProof proveSolid(const ExpandedMap& map, const Solid& solid, ProofSettings settings);

// What is said of both proofs.
ProofFigures proofFigures(const SenseProof& sense, const BoundaryProof& boundary);

// Whether the surface, with its caps, bounds the solid without crossing itself.
bool isEmbedded(const SourceBoundary& source);

// proveMap(), for a map that stands without it: where time or memory is out, or the solid allows no
// proof, there is none, and `warnings` say why. cells: for each charge. Throws Cancelled.
ProofFigures tryProof(const ComposedMap& map, const BoundaryPair& boundary, Prove prove,
                      double cells, std::vector<std::string>& warnings);

}  // namespace innermap
