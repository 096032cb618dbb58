#include "boundary_pair.h"

#include <fmt/format.h>

#include "innermap/core/error.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/read.h"

namespace innermap::tool {
namespace {

constexpr double kNoVolume = 1e-9;  // of the diagonal cubed

MeshReport check(const Mesh& mesh, Context& context) {
  CheckSettings settings;
  settings.listed = 1;
  settings.progress = context.progress();
  return checkMesh(mesh, settings);
}

ReportMesh reportOf(const Mesh& mesh, const MeshReport& report, int caps) {
  ReportMesh out;
  out.path = mesh.name;
  out.vertices = report.vertices;
  out.triangles = report.triangles;
  out.boundaryLoops = static_cast<int>(report.boundaryLoops.size());
  out.caps = caps;
  out.genus = report.genus;
  out.diagonal = report.box.diagonal();
  return out;
}

// Whether all points of the triangles lie in one plane, to a billionth of the diagonal.
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
  const double thickness = 1e-9 * boundingBox(mesh).diagonal();
  for (const Triangle& t : mesh.triangles)
    for (const int v : t)
      if (std::abs(dot(normal, mesh.vertices[v] - origin)) > thickness) return false;
  return true;
}

// Of the union where parts overlap; 0 where they cancel.
double volumeOf(const Mesh& closed, bool overlaps, const SolidSettings& settings) {
  if (!overlaps) return std::abs(signedVolume(closed));
  try {
    return Solid(closed, settings).volume();
  } catch (const DataError&) {
    return 0;
  }
}

void warnOfCrossings(const std::string& what, const MeshReport& report, const std::string& meaning,
                     Context& context) {
  context.report().set(what + ".self_intersections",
                       static_cast<std::int64_t>(report.selfIntersections));
  if (report.crossings.empty()) return;
  const Crossing& c = report.crossings.front();
  context.warning(fmt::format(
      "{} has {} pair{} of triangles that pass through each other, the first near ({:.6g}, {:.6g}, "
      "{:.6g}); {}",
      what, report.selfIntersections, report.selfIntersections == 1 ? "" : "s", c.place.x,
      c.place.y, c.place.z, meaning));
}

}  // namespace

Matrix BoundaryPair::targetsOf(const std::vector<SurfacePoint>& onSurface) const {
  std::vector<SurfacePoint> addresses;
  addresses.reserve(onSurface.size());
  for (const SurfacePoint& p : onSurface) addresses.push_back(solid.address(p));
  const Points points = interpolate(moved, solid.repaired().mesh.triangles, addresses);
  Matrix values(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int a = 0; a < 3; ++a) values(i, a) = points[i][a];
  return values;
}

Mesh movedMesh(const Solid& source, const TargetBoundary& target, const std::string& name) {
  Mesh moved;
  moved.name = name;
  moved.vertices = target.moved;
  moved.triangles = source.repaired().mesh.triangles;
  return moved;
}

Solid makeSourceSolid(const Mesh& source, Context& context) {
  MeshReport checked;
  context.timed("check", [&] { checked = check(source, context); });
  SolidSettings settings;
  settings.progress = context.progress();
  std::optional<Solid> solid;
  context.timed("solid", [&] { solid.emplace(source, settings); });
  const RepairedMesh& repaired = solid->repaired();
  for (const std::string& note : repaired.notes) context.note(source.name + ": " + note);
  Report& report = context.report();
  report.source = reportOf(source, checked, repaired.caps);
  report.source->volume = solid->volume();
  warnOfCrossings("source", checked,
                  "parts that overlap are united, slight crossings do little harm", context);
  return *solid;
}

TargetBoundary makeTargetBoundary(const Solid& source, const Mesh& target, Context& context) {
  TargetBoundary out;
  out.moved = repairedPositions(source.repaired(), target.vertices);
  const Mesh moved = movedMesh(source, out, target.name);
  out.diagonal = boundingBox(moved).diagonal();
  if (!(out.diagonal > 0))
    throw DataError(target.name + ": all vertices are in one place; give a target with extent");
  if (isFlat(moved))
    throw DataError(target.name + ": lies in a plane, so it has no inside; give another target");
  SolidSettings settings;
  settings.progress = context.progress();
  context.timed("solid", [&] { out.volume = volumeOf(moved, source.overlaps(), settings); });
  if (!(out.volume > kNoVolume * std::pow(out.diagonal, 3))) {
    out.volume = 0;
    context.warning(
        target.name +
        ": its parts cancel to no volume, so it is turned inside out somewhere; the harmonic "
        "energy is not scaled to its unit volume");
  }
  return out;
}

BoundaryPair makeBoundaryPair(Mesh source, Mesh target, Context& context) {
  const Solid solid = makeSourceSolid(source, context);
  MeshReport checked;
  context.timed("check", [&] { checked = check(target, context); });
  TargetBoundary boundary = makeTargetBoundary(solid, target, context);
  context.report().target = reportOf(target, checked, solid.repaired().caps);
  context.report().target->volume = boundary.volume;
  warnOfCrossings("target", checked, "no map onto it can be one-to-one there (see innermap check)",
                  context);
  return {std::move(source),         std::move(target), solid,
          std::move(boundary.moved), boundary.volume,   boundary.diagonal};
}

BoundaryPair readBoundaryPair(const std::string& sourcePath, const std::string& targetPath,
                              Context& context) {
  Mesh source, target;
  context.timed("read", [&] {
    ReadSettings settings;
    settings.progress = context.progress();
    source = readMesh(sourcePath, settings);
    target = readMeshLike(targetPath, source, settings);
  });
  return makeBoundaryPair(std::move(source), std::move(target), context);
}

}  // namespace innermap::tool
