#include "correspondence.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"
#include "map_report.h"

namespace innermap::tool {
namespace {

void reportQuantiles(Report& report, const std::string& key, const Quantiles& q) {
  report.set(key + ".median", q.median);
  report.set(key + ".p99", q.p99);
  report.set(key + ".max", q.max);
}

void reportMap(const MeshCorrespondence& map, Report& report) {
  const MapQuality& q = map.quality;
  const auto set = [&](const char* key, auto value) {
    report.set(std::string("correspondence.") + key, value);
  };
  if (map.farthestFromStandIn) set("farthest_from_stand_in", *map.farthestFromStandIn);
  set("flips", q.flips);
  set("degree", q.degree);
  set("area_ratio_log10", q.areaRatioLog10);
  set("energy_forward", q.energyForward);
  set("energy_backward", q.energyBackward);
  set("energy_sum", q.energyForward + q.energyBackward);
  reportQuantiles(report, "correspondence.stretch", q.stretch);
  reportQuantiles(report, "correspondence.triangle_stretch", q.triangleStretch);
  set("unmeasured", q.unmeasured);
  set("inverted_triangles", q.invertedTriangles);
  set("inverted_share", q.invertedShare);
  reportQuantiles(report, "correspondence.deviation", q.deviation);
  reportQuantiles(report, "correspondence.deviation_of_target", q.backDeviation);
  set("image_self_intersections", q.imageSelfIntersections);
  set("target_self_intersections", q.targetSelfIntersections);
  set("landmarks", map.landmarks);
  if (map.landmarks > 0) set("landmark_error", map.landmarkError);
  set("vertices", map.source.vertices.size());
  set("target_vertices", map.b.mesh.vertices.size());
  set("subdivided", map.changed);
  set("source_isosurface", map.a.standIn);
  set("target_isosurface", map.b.standIn);
}

// First maps of the first shell, which the inside chose between, best first.
void reportConsidered(const std::vector<ConsideredMap>& maps, Report& report) {
  if (maps.empty()) return;
  std::vector<std::string> origins;
  for (const ConsideredMap& m : maps) origins.push_back(m.origin);
  report.set("correspondence.considered.origin", origins);
  report.setColumn("correspondence.considered.energy", maps, [](auto& m) { return m.energy; });
  report.setColumn("correspondence.considered.score", maps, [](auto& m) { return m.score; });
}

std::string qualityText(const MapQuality& q, ModelSpace space, bool standIn) {
  return fmt::format(
      "on the {}: {} flip{}, degree {:.9f}\n"
      "energy: {:.2f} there and {:.2f} back, {:.2f} in all (4 + 4 at best)\n"
      "stretch: median {:.2f}, 99% {:.2f}, max {:.2f}\n"
      "image: {:.3g}% of its triangles inverted; {:.3g}% of the diagonal from TARGET at 99% of it, "
      "{:.3g}% "
      "at most; {} self-intersection{}, {} of TARGET itself\n{}",
      space == ModelSpace::sphere ? "sphere" : "torus", q.flips, q.flips == 1 ? "" : "s", q.degree,
      q.energyForward, q.energyBackward, q.energyForward + q.energyBackward, q.stretch.median,
      q.stretch.p99, q.stretch.max, 100 * q.invertedShare, 100 * q.deviation.p99,
      100 * q.deviation.max, q.imageSelfIntersections, q.imageSelfIntersections == 1 ? "" : "s",
      q.targetSelfIntersections, standIn ? "(figures of the isosurface that stands in)\n" : "");
}

}  // namespace

void addSurfaceOptions(Command& c, LayOutSettings& o) {
  c.flag("--close", &o.closeHoles, "close the holes of an open mesh by caps");
  c.option("--surface-resolution", "N", &o.standInResolution,
           "for a mesh that is open, not manifold or made of overlapping parts: the solid's own "
           "surface, an isosurface at N voxels across, is mapped instead, and its values are "
           "carried back to the mesh by closest points")
      .range(8, 2048)
      .defaults("such a mesh is refused")
      .advanced();
}

void addCorrespondOptions(Command& c, CorrespondOptions& o) {
  c.group("laying SOURCE onto TARGET");
  c.option("--landmarks", "FILE", &o.landmarks, "pairs of places that are kept exactly").reads();
  c.flag("--aligned", &o.map.aligned,
         "the two stand in the same pose and orientation: prefer agreeing normals and places");
  c.option("--candidates", "N", &o.map.candidates,
           "ways to lay SOURCE on TARGET that are refined: those whose coarse harmonic maps of the "
           "inside "
           "stretch and fold it least; of them the one that does so least is taken")
      .range(1, 64)
      .advanced();
  c.flag("--no-refine", &o.noRefine,
         "only the best way to lay SOURCE on TARGET, not refined: fast, rough")
      .advanced();
  c.option("--subdivide", "T", &o.map.subdivide,
           "split SOURCE's triangles until they follow TARGET within T, and write it so split too; "
           "0: never")
      .unit("fraction of TARGET's diagonal")
      .range(0, 1)
      .advanced();
  addSurfaceOptions(c, o.surfaces);
}

MeshCorrespondenceSettings correspondSettings(const CorrespondOptions& options,
                                              const Context& context) {
  auto settings = context.settings(options.map);
  settings.refine = !options.noRefine;
  return settings;
}

void requirePly(const std::string& option, const std::string& path) {
  const std::string extension = path.size() < 5 ? "" : path.substr(path.size() - 4);
  if (extension != ".ply" && extension != ".PLY")
    throw UsageError(option + ": '" + path + "' must end in .ply");
}

LaidOutMesh layOut(Mesh mesh, const LayOutSettings& options, Context& context) {
  try {
    LaidOutMesh laid = layOutMesh(std::move(mesh), context.settings(options));
    for (const std::string& note : laid.notes) context.note(note);
    addSeconds(context.report().seconds, laid.seconds);
    return laid;
  } catch (const UnfitMesh& error) {
    throw DataError(std::string(error.what()) +
                    (error.closingHelps() ? " (--close; --surface-resolution N for larger holes)"
                                          : " (--surface-resolution N)"));
  }
}

ReportMesh reportOf(const LaidOutMesh& laid) {
  ReportMesh out = reportOf(laid.mesh, laid.volume());
  out.boundaryLoops = out.caps = laid.shells().caps;
  out.genus = laid.handles();
  return out;
}

MeshCorrespondence correspondMeshes(Mesh a, Mesh b, const CorrespondOptions& options,
                                    Context& context) {
  context.requireMemory("the correspondence",
                        correspondMemory(a.vertices.size(), b.vertices.size()),
                        "use coarser meshes");
  auto settings = correspondSettings(options, context);
  if (!options.landmarks.empty()) settings.landmarks = readLandmarks(options.landmarks);
  LaidOutMesh laidA = layOut(std::move(a), options.surfaces, context);
  LaidOutMesh laidB = layOut(std::move(b), options.surfaces, context);
  context.report().source = reportOf(laidA);
  context.report().target = reportOf(laidB);
  MeshCorrespondence map = innermap::correspondMeshes(std::move(laidA), std::move(laidB), settings);
  context.tell(map);
  reportMap(map, context.report());
  reportConsidered(map.map.shells.front().considered, context.report());
  context.print(
      qualityText(map.quality, map.map.shells.front().image.space, map.a.standIn || map.b.standIn));
  return map;
}

}  // namespace innermap::tool
