#include "surface/detail/topology/meridians.h"

#include <fmt/format.h>

#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "surface/detail/topology/linking.h"

namespace innermap {
namespace {

// Residuals of embedded surfaces are of the order of rounding.
constexpr double kResidual = 0.05;
constexpr int kSmoothings = 6;  // 1, 2, 4, ... steps

IntegerMatrix transposed(const IntegerMatrix& m) {
  IntegerMatrix out(m.empty() ? 0 : m[0].size(), Integers(m.size()));
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t j = 0; j < m[i].size(); ++j) out[j][i] = m[i][j];
  return out;
}

// Loops pushed to both sides differ by the crossings; half of all classes bound on either side.
bool consistent(const LinkingNumbers& linking, const HomologyBasis& basis,
                const BoundingClasses& classes) {
  if (linking.residual > kResidual) return false;
  for (std::size_t i = 0; i < basis.size(); ++i)
    for (std::size_t j = 0; j < basis.size(); ++j)
      if (linking.matrix[i][j] - linking.matrix[j][i] != -basis.crossings[i][j]) return false;
  return 2 * classes.inside.size() == basis.size() && 2 * classes.outside.size() == basis.size();
}

// Each vertex half way to the mean of its neighbours.
Points smoothed(const Points& vertices, const HalfEdges& edges) {
  Points sum(vertices.size());
  std::vector<double> valence(vertices.size(), 0);
  for (int h = 0; h < edges.size(); ++h) {
    sum[edges.tail(h)] += vertices[edges.head(h)];
    valence[edges.tail(h)] += 1;
  }
  for (std::size_t v = 0; v < vertices.size(); ++v)
    sum[v] = valence[v] > 0 ? 0.5 * (vertices[v] + sum[v] / valence[v]) : vertices[v];
  return sum;
}

}  // namespace

BoundingClasses boundingClasses(const ClosedSurface& surface, const HalfEdges& edges,
                                const HomologyBasis& basis) {
  Points vertices = surface.vertices;
  for (int attempt = 0, steps = 0; attempt <= kSmoothings; ++attempt) {
    const LinkingNumbers linking = linkingNumbers(vertices, edges, basis.loops);
    const BoundingClasses classes{leftKernel(linking.matrix),
                                  leftKernel(transposed(linking.matrix))};
    if (consistent(linking, basis, classes)) return classes;
    for (const int until = 1 << attempt; steps < until; ++steps) {
      throwIfCancelled();
      vertices = smoothed(vertices, edges);
    }
  }
  throw DataError(fmt::format(
      "{}: cannot tell which loops around its handles bound inside; it probably passes through "
      "itself there (see `innermap check`): repair it",
      surface.name));
}

TorusClasses torusClasses(const ClosedSurface& surface, const HalfEdges& edges,
                          const HomologyBasis& basis) {
  const BoundingClasses classes = boundingClasses(surface, edges, basis);
  TorusClasses out{classes.inside[0], classes.outside[0]};
  const long long crossing = crossingNumber(basis, out.meridian, out.longitude);
  if (std::abs(crossing) != 1)
    throw DataError(
        fmt::format("{}: passes through itself where its handle closes (see `innermap check`), so "
                    "no loop around the handle bounds a disc inside; repair it",
                    surface.name));
  for (long long& c : out.longitude) c *= crossing;
  return out;
}

}  // namespace innermap
