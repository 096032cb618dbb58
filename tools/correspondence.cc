#include "correspondence.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"
#include "innermap/core/stage_seconds.h"

namespace innermap::tool {
namespace {

MeshCorrespondenceSettings settingsOf(const CorrespondOptions& options) {
  MeshCorrespondenceSettings settings;
  settings.aligned = options.aligned;
  settings.candidates = options.candidates;
  settings.refine = !options.noRefine;
  settings.subdivide = options.subdivide.value_or(0);
  return settings;
}

template <class Result>
void tell(const Result& result, Context& context) {
  for (const std::string& note : result.notes) context.note(note);
  addSeconds(context.report().seconds, result.seconds);
}

void reportQuantiles(Report& report, const std::string& key, const Quantiles& q) {
  report.set(key + ".median", q.median);
  report.set(key + ".p99", q.p99);
  report.set(key + ".max", q.max);
}

void reportMap(const MeshCorrespondence& map, Report& report) {
  const MapQuality& q = map.quality;
  const auto set = [&](const char* key, ReportValue value) {
    report.set(std::string("correspondence.") + key, std::move(value));
  };
  if (map.farthestFromStandIn) set("farthest_from_stand_in", *map.farthestFromStandIn);
  set("flips", static_cast<std::int64_t>(q.flips));
  set("degree", q.degree);
  set("area_ratio_log10", q.areaRatioLog10);
  set("energy_forward", q.energyForward);
  set("energy_backward", q.energyBackward);
  set("energy_sum", q.energyForward + q.energyBackward);
  reportQuantiles(report, "correspondence.stretch", q.stretch);
  reportQuantiles(report, "correspondence.triangle_stretch", q.triangleStretch);
  set("unmeasured", q.unmeasured);
  set("inverted_triangles", static_cast<std::int64_t>(q.invertedTriangles));
  set("inverted_share", q.invertedShare);
  reportQuantiles(report, "correspondence.deviation", q.deviation);
  reportQuantiles(report, "correspondence.deviation_of_target", q.backDeviation);
  set("image_self_intersections", static_cast<std::int64_t>(q.imageSelfIntersections));
  set("target_self_intersections", static_cast<std::int64_t>(q.targetSelfIntersections));
  set("landmarks", static_cast<std::int64_t>(map.landmarks));
  if (map.landmarks > 0) set("landmark_error", map.landmarkError);
  set("vertices", static_cast<std::int64_t>(map.source.vertices.size()));
  set("target_vertices", static_cast<std::int64_t>(map.b.mesh.vertices.size()));
  set("subdivided", map.changed);
  set("source_isosurface", map.a.standIn);
  set("target_isosurface", map.b.standIn);
}

std::string qualityText(const MapQuality& q, ModelSpace space, bool standIn) {
  return fmt::format(
      "on the {}: {} flip{}, degree {:.9f}\n"
      "energy: {:.2f} there and {:.2f} back, {:.2f} in all (4 + 4 at best)\n"
      "stretch: median {:.2f}, 99% {:.2f}, max {:.2f}\n"
      "image: {:.3g}% of its triangles inverted; {:.3g}% of the diagonal from B at 99% of it, "
      "{:.3g}% "
      "at most; {} self-intersection{}, {} of B itself\n{}",
      space == ModelSpace::sphere ? "sphere" : "torus", q.flips, q.flips == 1 ? "" : "s", q.degree,
      q.energyForward, q.energyBackward, q.energyForward + q.energyBackward, q.stretch.median,
      q.stretch.p99, q.stretch.max, 100 * q.invertedShare, 100 * q.deviation.p99,
      100 * q.deviation.max, q.imageSelfIntersections, q.imageSelfIntersections == 1 ? "" : "s",
      q.targetSelfIntersections, standIn ? "(figures of the isosurface that stands in)\n" : "");
}

}  // namespace

void addSurfaceOptions(Command& c, SurfaceOptions& o) {
  c.flag("--close", &o.close, "close the holes of an open mesh by caps");
  c.option("--surface-resolution", "N", &o.resolution,
           "for a mesh that is open, not manifold or made of overlapping parts: the solid's own "
           "surface, an isosurface at N voxels across, is mapped instead, and its values are "
           "carried back to the mesh by closest points")
      .range(8, 2048)
      .defaults("such a mesh is refused");
}

void addCorrespondOptions(Command& c, CorrespondOptions& o) {
  c.option("--landmarks", "FILE", &o.landmarks, "pairs of places that are kept exactly");
  c.flag("--aligned", &o.aligned,
         "the two stand in the same pose and orientation: prefer agreeing normals and places");
  c.option("--candidates", "N", &o.candidates,
           "ways to lay A on B that are refined; the one of least energy is taken")
      .range(1, 64);
  c.flag("--no-refine", &o.noRefine, "only the best way to lay A on B, not refined: fast, rough");
  c.option("--subdivide", "T", &o.subdivide,
           "split A's triangles until they follow B within T, and write A so split too; 0: never")
      .unit("fraction of B's diagonal")
      .range(0, 1)
      .defaults(fmt::format("{:g}", o.subdivide.value_or(0)));
  addSurfaceOptions(c, o.surfaces);
}

double correspondSeconds(std::size_t a, std::size_t b, const CorrespondOptions& options) {
  return innermap::correspondSeconds(a, b, settingsOf(options));
}

void requirePly(const std::string& option, const std::string& path) {
  const std::string extension = path.size() < 5 ? "" : path.substr(path.size() - 4);
  if (extension != ".ply" && extension != ".PLY")
    throw UsageError(option + ": '" + path + "' must end in .ply");
}

LaidOutMesh layOut(Mesh mesh, const SurfaceOptions& options, Context& context) {
  LayOutSettings settings;
  settings.closeHoles = options.close;
  settings.standInResolution = options.resolution.value_or(0);
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  try {
    LaidOutMesh laid = layOutMesh(std::move(mesh), settings);
    tell(laid, context);
    return laid;
  } catch (const UnfitMesh& error) {
    throw DataError(std::string(error.what()) +
                    (error.closingHelps() ? " (--close; --surface-resolution N for larger holes)"
                                          : " (--surface-resolution N)"));
  }
}

ReportMesh reportOf(const LaidOutMesh& laid) {
  ReportMesh out;
  out.path = laid.mesh.name;
  out.vertices = laid.mesh.vertices.size();
  out.triangles = laid.mesh.triangles.size();
  out.boundaryLoops = out.caps = laid.shells().caps;
  out.volume = laid.volume();
  out.genus = laid.handles();
  out.diagonal = boundingBox(laid.mesh).diagonal();
  return out;
}

MeshCorrespondence correspondMeshes(Mesh a, Mesh b, const CorrespondOptions& options,
                                    std::uint64_t seed, Context& context) {
  requireMemory("the correspondence", correspondMemory(a.vertices.size(), b.vertices.size()),
                context.maxMemory(), "use coarser meshes");
  MeshCorrespondenceSettings settings = settingsOf(options);
  if (!options.landmarks.empty()) settings.landmarks = readLandmarks(options.landmarks);
  settings.seed = seed;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  LaidOutMesh laidA = layOut(std::move(a), options.surfaces, context);
  LaidOutMesh laidB = layOut(std::move(b), options.surfaces, context);
  context.report().source = reportOf(laidA);
  context.report().target = reportOf(laidB);
  MeshCorrespondence map = innermap::correspondMeshes(std::move(laidA), std::move(laidB), settings);
  tell(map, context);
  for (const std::string& warning : map.warnings) context.warning(warning);
  reportMap(map, context.report());
  context.print(
      qualityText(map.quality, map.map.shells.front().image.space, map.a.standIn || map.b.standIn));
  return map;
}

}  // namespace innermap::tool
