#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/detail/exposed_pair.h"
#include "fit/detail/solid_proof.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {
namespace {

constexpr double kProofSeconds = 5e-4;  // a charge, on two cores; most take less

bool boundaryIsInjective(const ExpandedMap& map, const BoundaryPair& boundary,
                         const ProofSettings& settings) {
  if (!isEmbedded(boundary.source)) return false;
  const EmbeddingProof proof = proveEmbedding(map, boundary.solid().repaired().mesh, settings);
  return proof.proven && proof.connected;
}

}  // namespace

SenseProof proveSolid(const ExpandedMap& map, const Solid& solid, ProofSettings settings) {
  if (solid.overlaps())
    settings.volume =
        std::max(solid.volume() - solid.area() * solid.gap(), std::numeric_limits<double>::min());
  return proveSense(map, solid.repaired().mesh, settings);
}

bool isEmbedded(const SourceBoundary& source) {
  const RepairedMesh& repaired = source.solid.repaired();
  return source.check.selfIntersections == 0 &&
         (repaired.caps == 0 ||
          selfIntersections(repaired.mesh.vertices, repaired.mesh.triangles).empty());
}

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
  const SenseProof sense = proveSolid(expanded, boundary.solid(), settings);
  const ExposedPair exposed = exposedPair(boundary);
  ProofFigures out =
      proofFigures(sense, proveBoundaryError(expanded, exposed.surface, exposed.targets, settings));
  if (full) out.oneToOne = sense.whole() && boundaryIsInjective(expanded, boundary, settings);
  return out;
}

ProofFigures tryProof(const ComposedMap& map, const BoundaryPair& boundary, Prove prove,
                      double cells, std::vector<std::string>& warnings) {
  if (prove == Prove::off || outOfTime(kProofSeconds * static_cast<double>(map.sources())))
    return {};
  ProofSettings s;
  s.cellsPerCharge = prove == Prove::full ? std::max(cells, ProofSettings().cellsPerCharge) : cells;
  try {
    return proveMap(map, boundary, s, prove == Prove::full);
  } catch (const DataError& e) {
    warnings.push_back(std::string("nothing is proven: ") + e.what());
  } catch (const MemoryError& e) {
    warnings.push_back(std::string("nothing is proven: ") + e.what());
  }
  return {};
}

}  // namespace innermap
