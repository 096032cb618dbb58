#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/transfer/geometry.h"

namespace innermap {
namespace {

using Edge = std::array<int, 2>;

constexpr int kMostRounds = 30;
constexpr std::size_t kEdgesTogether = std::size_t{1} << 18;  // edges
// Of a new point with what is between it: an element or two, places in tables.
constexpr std::uint64_t kPointBytes = 400;

// Those whose straight image leaves the curved one by more than the tolerance.
std::vector<Edge> bentEdges(const Geometry& geometry, const std::vector<Edge>& edges,
                            const PointCarry& carry, double tolerance) {
  std::vector<Edge> bent;
  for (std::size_t begin = 0; begin < edges.size(); begin += kEdgesTogether) {
    const std::size_t end = std::min(edges.size(), begin + kEdgesTogether);
    Points at;
    for (std::size_t e = begin; e < end; ++e) {
      const Vec3 &a = geometry.points[edges[e][0]], &b = geometry.points[edges[e][1]];
      for (int k = 0; k <= 4; ++k) at.push_back(a + 0.25 * k * (b - a));
    }
    const CarriedPoints images = carry(at, false);
    for (std::size_t e = begin; e < end; ++e) {
      const std::size_t first = 5 * (e - begin);
      bool known = true;
      double away = 0;
      for (std::size_t k = 0; k <= 4; ++k) {
        known = known && images.fates[first + k] == PointFate::carried;
        const Vec3 straight =
            images.points[first] +
            0.25 * static_cast<double>(k) * (images.points[first + 4] - images.points[first]);
        away = std::max(away, norm(images.points[first + k] - straight));
      }
      if (known && away > tolerance) bent.push_back(edges[e]);
    }
  }
  return bent;
}

void subdivide(Geometry& geometry, const PointCarry& carry, const CarryGeometrySettings& settings) {
  std::vector<Edge> straight;  // known to need no split
  for (int round = 0; round < kMostRounds; ++round) {
    throwIfCancelled();
    const std::vector<Edge> all = edgesOf(geometry);
    std::vector<Edge> fresh, bent;
    std::set_difference(all.begin(), all.end(), straight.begin(), straight.end(),
                        std::back_inserter(fresh));
    bent = bentEdges(geometry, fresh, carry, settings.subdivide);
    if (bent.empty()) return;
    requireMemory(fmt::format("splitting {} edges", bent.size()),
                  kPointBytes * (geometry.points.size() + bent.size()),
                  "take a larger --subdivide");
    straight.clear();
    std::set_difference(all.begin(), all.end(), bent.begin(), bent.end(),
                        std::back_inserter(straight));
    splitEdges(geometry, bent);
  }
}

bool needsJacobians(const Geometry& geometry) {
  return !geometry.directions.empty() || geometry.splats.degree >= 0;
}

void carryDirections(const Geometry& geometry, bool mirrored, CarriedGeometry& out) {
  for (const Directions& directions : geometry.directions) {
    Points turned(directions.values.size());
    for (std::size_t i = 0; i < turned.size(); ++i) {
      const Mat3& j = out.points.jacobians[static_cast<std::size_t>(directions.points[i])];
      turned[i] = directions.kind == DirectionKind::normal ? carriedNormal(j, directions.values[i])
                                                           : carriedVector(j, directions.values[i]);
    }
    out.directions.push_back(std::move(turned));
  }
  for (const Mat3& j : out.points.jacobians)
    if (!((mirrored ? -determinant(j) : determinant(j)) > 0)) ++out.folded;
}

void numberThose(const Geometry& geometry, CarriedGeometry& out) {
  const Elements& elements = geometry.elements;
  out.number.resize(geometry.ownPoints);
  int next = 0;
  for (std::size_t i = 0; i < geometry.ownPoints; ++i)
    out.number[i] = out.points.fates[i] == PointFate::cut ? -1 : next++;
  out.stays.assign(elements.size(), 1);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    // Of a set of points the others stay.
    const bool whole = elements.kinds[e] != Elements::Kind::points;
    for (std::size_t k = elements.start[e]; whole && k < elements.start[e + 1]; ++k)
      if (const int p = elements.corners[k].point;
          p >= 0 && out.number[static_cast<std::size_t>(p)] < 0)
        out.stays[e] = 0;
    out.cutElements += !out.stays[e];
  }
}

}  // namespace

CarriedGeometry carryGeometry(Geometry& geometry, const PointCarry& carry,
                              const CarryGeometrySettings& settings) {
  requireNumber("subdivide", settings.subdivide, {0});
  if (settings.splats == SplatOpacity::mass && geometry.splats.degree < 0)
    throw SettingError("splats", "is for Gaussian splats; there are none, so leave it out");
  CarriedGeometry out;
  out.ownPoints = geometry.ownPoints;
  out.splats.degree = geometry.splats.degree;
  out.splats.opacity = settings.splats;
  if (settings.subdivide > 0) {
    if (!geometry.splittable)
      throw SettingError("subdivide",
                         "edges of this kind of file cannot be split; only those of "
                         ".obj and .ply, without strips of triangles or splats");
    subdivide(geometry, carry, settings);
  }
  out.added = geometry.ownPoints - out.ownPoints;
  out.points = carry(geometry.points, needsJacobians(geometry));
  carryDirections(geometry, settings.mirrored, out);
  numberThose(geometry, out);
  return out;
}

std::uint64_t carryGeometryMemory(const Geometry& geometry) {
  std::uint64_t bytes = carryPointsMemory(geometry.points.size(), needsJacobians(geometry));
  for (const Directions& directions : geometry.directions)
    bytes += directions.values.size() * sizeof(Vec3);
  return bytes + geometry.ownPoints * sizeof(int) + geometry.elements.size();
}

Setting subdivideSetting(double* share) {
  return Setting("subdivide", "T", share,
                 "of geometry: split edges of meshes and curves until their straight images are "
                 "nowhere farther than this from the curved ones; 0 splits none")
      .in("fraction of the diagonal of the solid carried to")
      .from(0, 1);
}

}  // namespace innermap
