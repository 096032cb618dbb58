#include <algorithm>
#include <cmath>

#include "innermap/fit/mapped_solid.h"

namespace innermap {
namespace {

constexpr std::size_t kPlaces = 16;

// The exposed surface with corners of its own for each triangle, whose values may jump where two
// parts meet, and where these go.
struct Exposed {
  Mesh surface;
  Points targets;
};

Exposed exposedOf(const BoundaryPair& boundary) {
  const Mesh& mesh = boundary.solid().surface();
  Exposed out;
  std::vector<SurfacePoint> corners;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<int>(out.surface.vertices.size());
    out.surface.triangles.push_back({first, first + 1, first + 2});
    for (int c = 0; c < 3; ++c) {
      out.surface.vertices.push_back(
          mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][static_cast<std::size_t>(c)])]);
      SurfacePoint corner{static_cast<int>(t), {0, 0, 0}};
      corner.barycentric[static_cast<std::size_t>(c)] = 1;
      corners.push_back(corner);
    }
  }
  const Matrix to = boundary.targetsOf(corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
    out.targets.push_back({to(i, 0), to(i, 1), to(i, 2)});
  return out;
}

void addPlaces(const ProofCells& cells, Points& places) {
  for (const ProofCell& cell : cells.places)
    if (places.size() < kPlaces) places.push_back(cell.center);
}

bool boundaryIsInjective(const ExpandedMap& map, const BoundaryPair& boundary,
                         const ProofSettings& settings) {
  if (boundary.source.check.selfIntersections > 0) return false;
  const EmbeddingProof proof = proveEmbedding(map, boundary.solid().repaired().mesh, settings);
  return proof.proven && proof.connected;
}

}  // namespace

ProofFigures proveMap(const ComposedMap& map, const BoundaryPair& boundary,
                      const ProofSettings& settings, bool full) {
  const ExpandedMap expanded = map;
  const SenseProof sense = proveSense(expanded, boundary.solid().repaired().mesh, settings);
  ProofFigures out;
  out.cells = sense.proven.count + sense.undecided.count + sense.negative.count;
  out.undecided = sense.undecided.count;
  out.negative = sense.negative.count;
  out.proven = sense.provenShare;
  out.undecidedShare = sense.undecided.share;
  out.negativeShare = sense.negative.share;
  out.mirrored = sense.mirrored;
  out.least = sense.least;
  addPlaces(sense.negative, out.places);
  addPlaces(sense.undecided, out.places);
  const Exposed exposed = exposedOf(boundary);
  const double error =
      proveBoundaryError(expanded, exposed.surface, exposed.targets, settings).error;
  if (std::isfinite(error)) out.boundaryError = error;
  if (full) out.oneToOne = sense.whole() && boundaryIsInjective(expanded, boundary, settings);
  return out;
}

}  // namespace innermap
