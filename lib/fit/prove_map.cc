#include <algorithm>
#include <cmath>

#include "fit/detail/exposed_pair.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {
namespace {

bool boundaryIsInjective(const ExpandedMap& map, const BoundaryPair& boundary,
                         const ProofSettings& settings) {
  if (boundary.source.check.selfIntersections > 0) return false;
  const EmbeddingProof proof = proveEmbedding(map, boundary.solid().repaired().mesh, settings);
  return proof.proven && proof.connected;
}

}  // namespace

ProofFigures proofFigures(const SenseProof& sense, const BoundaryProof& boundary) {
  ProofFigures out;
  out.cells = sense.proven.count + sense.undecided.count + sense.negative.count;
  out.undecided = sense.undecided.count;
  out.negative = sense.negative.count;
  out.proven = sense.provenShare;
  out.undecidedShare = sense.undecided.share;
  out.negativeShare = sense.negative.share;
  out.mirrored = sense.mirrored;
  out.least = sense.least;
  out.negativeCells = sense.negative.places;
  out.undecidedCells = sense.undecided.places;
  if (std::isfinite(boundary.error)) out.boundaryError = boundary.error;
  return out;
}

ProofFigures proveMap(const ComposedMap& map, const BoundaryPair& boundary,
                      const ProofSettings& settings, bool full) {
  const ExpandedMap expanded = map;
  const SenseProof sense = proveSense(expanded, boundary.solid().repaired().mesh, settings);
  const ExposedPair exposed = exposedPair(boundary);
  ProofFigures out =
      proofFigures(sense, proveBoundaryError(expanded, exposed.surface, exposed.targets, settings));
  if (full) out.oneToOne = sense.whole() && boundaryIsInjective(expanded, boundary, settings);
  return out;
}

}  // namespace innermap
