#include "innermap/fit/boundary_pair.h"

#include <fmt/format.h>

#include <cmath>

#include "fit/tangle.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr double kNoVolume = 1e-9;  // of the diagonal cubed
constexpr double kFlat = 1e-9;      // of the diagonal

// Whether all points of the triangles lie in one plane.
bool isFlat(const Mesh& mesh) {
  Vec3 origin, normal;
  double largest = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Vec3 area = areaVector(mesh, t);
    if (norm(area) <= largest) continue;
    largest = norm(area);
    normal = area / largest;
    origin = mesh.vertices[mesh.triangles[t][0]];
  }
  const double thickness = kFlat * boundingBox(mesh).diagonal();
  for (const Triangle& t : mesh.triangles)
    for (const int v : t)
      if (std::abs(dot(normal, mesh.vertices[v] - origin)) > thickness) return false;
  return true;
}

// Of the union where parts overlap; 0 where they cancel.
double volumeOf(const Mesh& closed, bool overlaps) {
  if (!overlaps) return std::abs(signedVolume(closed));
  try {
    return Solid(closed).volume();
  } catch (const DataError&) {
    return 0;
  }
}

void warnOfCrossings(const std::string& what, const MeshReport& report, const std::string& meaning,
                     std::vector<std::string>& warnings) {
  if (report.crossings.empty()) return;
  const Crossing& c = report.crossings.front();
  warnings.push_back(fmt::format(
      "{} has {} pair{} of triangles that pass through each other, the first near ({:.6g}, {:.6g}, "
      "{:.6g}); {}",
      what, report.selfIntersections, report.selfIntersections == 1 ? "" : "s", c.place.x,
      c.place.y, c.place.z, meaning));
}

}  // namespace

SourceBoundary makeSourceBoundary(Mesh mesh) {
  StageSeconds seconds;
  const MeshReport checked = timed(seconds, "check", [&] { return checkCrossings(mesh); });
  refuseTangle(mesh, checked.selfIntersections);
  const Solid solid = timed(seconds, "solid", [&] { return Solid(mesh); });
  SourceBoundary out{std::move(mesh), checked, solid, {}, {}, std::move(seconds)};
  for (const std::string& note : solid.repaired().notes)
    out.notes.push_back(out.mesh.name + ": " + note);
  warnOfCrossings("source", checked,
                  "parts that overlap are united, slight crossings do little harm", out.warnings);
  return out;
}

Matrix TargetBoundary::targetsOf(const Solid& source,
                                 const std::vector<SurfacePoint>& onSurface) const {
  std::vector<SurfacePoint> addresses;
  addresses.reserve(onSurface.size());
  for (const SurfacePoint& p : onSurface) addresses.push_back(source.address(p));
  const Points points = interpolate(moved, source.repaired().mesh.triangles, addresses);
  Matrix values(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int a = 0; a < 3; ++a) values(i, static_cast<std::size_t>(a)) = points[i][a];
  return values;
}

Mesh TargetBoundary::mesh(const Solid& source, const std::string& name) const {
  Mesh out;
  out.name = name;
  out.vertices = moved;
  out.triangles = source.repaired().mesh.triangles;
  return out;
}

TargetBoundary makeTargetBoundary(const Solid& source, const Mesh& target) {
  TargetBoundary out;
  out.moved = repairedPositions(source.repaired(), target.vertices);
  const Mesh moved = out.mesh(source, target.name);
  requireNearOrigin(moved);
  out.diagonal = boundingBox(moved).diagonal();
  if (!(out.diagonal > 0))
    throw DataError(target.name + ": all vertices are in one place; give a target with extent");
  if (isFlat(moved))
    throw DataError(target.name + ": lies in a plane, so it has no inside; give another target");
  out.volume = timed(out.seconds, "solid", [&] { return volumeOf(moved, source.overlaps()); });
  if (!(out.volume > kNoVolume * std::pow(out.diagonal, 3))) {
    out.volume = 0;
    out.warnings.push_back(target.name +
                           ": its parts cancel to no volume, so it is inside out somewhere; the "
                           "harmonic energy is not scaled to unit volume");
  }
  return out;
}

BoundaryPair makeBoundaryPair(Mesh source, Mesh target) {
  if (source.triangles != target.triangles)
    throw DataError(target.name + ": has other triangles than " + source.name +
                    "; lay the one onto the other first (mesh_correspondence.h)");
  SourceBoundary from = makeSourceBoundary(std::move(source));
  StageSeconds seconds = from.seconds;
  const MeshReport checked = timed(seconds, "check", [&] { return checkCrossings(target); });
  refuseTangle(target, checked.selfIntersections);
  TargetBoundary to = makeTargetBoundary(from.solid, target);
  addSeconds(seconds, to.seconds);
  std::vector<std::string> notes = from.notes, warnings = from.warnings;
  warnings.insert(warnings.end(), to.warnings.begin(), to.warnings.end());
  warnOfCrossings("target", checked, "no map onto it can be one-to-one there (see innermap check)",
                  warnings);
  return {std::move(from),  std::move(target),   checked,           std::move(to),
          std::move(notes), std::move(warnings), std::move(seconds)};
}

Solid makeTargetSolid(const BoundaryPair& pair) {
  return Solid(pair.target.mesh(pair.solid(), pair.targetMesh.name));
}

}  // namespace innermap
