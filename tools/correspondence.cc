#include "correspondence.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"
#include "innermap/io/picture/mesh_picture.h"
#include "inputs.h"
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
  if (map.farthestFromOuter) set("farthest_from_outer_surface", *map.farthestFromOuter);
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
  reportOuter("correspondence.source_outer_surface", map.a.outer, report);
  reportOuter("correspondence.target_outer_surface", map.b.outer, report);
}

// First maps of the first shell, which the inside chose between, best first; and the way taken.
void reportConsidered(const ShellCorrespondence& shell, Report& report) {
  const std::vector<ConsideredMap>& maps = shell.considered;
  report.set("correspondence.way", shell.way);
  if (shell.other) {
    report.set("correspondence.other_way.way", shell.other->way);
    report.setColumn("correspondence.other_way.score", shell.other->score,
                     [](auto s) { return s; });
    report.setColumn("correspondence.other_way.turn", shell.other->turn, [](auto t) { return t; });
  }
  if (maps.empty()) return;
  std::vector<std::string> origins;
  for (const ConsideredMap& m : maps) origins.push_back(m.origin);
  report.set("correspondence.considered.origin", origins);
  report.setColumn("correspondence.considered.energy", maps, [](auto& m) { return m.energy; });
  report.setColumn("correspondence.considered.score", maps, [](auto& m) { return m.score; });
  report.setColumn("correspondence.considered.turn", maps, [](auto& m) { return m.turn; });
  report.setColumn("correspondence.considered.way", maps, [](auto& m) { return m.way; });
}

std::string qualityText(const MapQuality& q, ModelSpace space, bool outer) {
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
      q.targetSelfIntersections, outer ? "(of the outer surface)\n" : "");
}

void tell(const LaidOutMesh& laid, Context& context) {
  for (const std::string& note : laid.notes) context.note(note);
  addSeconds(context.report().seconds, laid.seconds);
}

void addClose(Command& c, bool& close) {
  c.flag("--close", &close, "no longer needed: the holes of an open mesh are closed by caps")
      .advanced();
}

}  // namespace

void addSurfaceOptions(Command& c, SurfaceOptions& o) {
  addClose(c, o.close);
  c.settings(describe(o.layOut));
}

void addCorrespondOptions(Command& c, CorrespondOptions& o) {
  c.group("laying SOURCE onto TARGET");
  c.option("--landmarks", "FILE", &o.landmarks, "pairs of places that are kept exactly").reads();
  c.settings(without(describe(o.map), {"seed"}));
  addClose(c, o.close);
}

void requirePly(const std::string& option, const std::string& path) {
  const std::string extension = path.size() < 5 ? "" : path.substr(path.size() - 4);
  if (extension != ".ply" && extension != ".PLY")
    throw UsageError(option + ": '" + path + "' must end in .ply");
}

Mesh takeCleanSurface(Mesh mesh, const LayOutSettings& settings, Context& context) {
  CleanSurface clean = context.timed("surface", [&] { return cleanSurface(mesh, settings); });
  for (const std::string& note : clean.notes) context.note(note);
  reportOuter("outer_surface", clean.outer, context.report());
  return clean.outer ? std::move(clean.outer->mesh) : std::move(mesh);
}

Mesh readCleanSurface(const std::string& path, const SurfaceOptions& options, Context& context) {
  return takeCleanSurface(readMeshFile(path, context), options.layOut, context);
}

void reportOuter(const std::string& key, const std::optional<OuterSurface>& taken, Report& report) {
  report.set(key + ".taken", taken.has_value());
  if (!taken) return;
  const OuterSurface& outer = *taken;
  report.set(key + ".edge", outer.edge);
  report.set(key + ".vertices", outer.mesh.vertices.size());
  report.set(key + ".handles", outer.topology.handles);
  report.set(key + ".inside_out", outer.insideOut);
  report.set(key + ".left_out", outer.leftOut);
  report.set(key + ".left_out_share", outer.leftOutShare);
  report.set(key + ".apart_p99", outer.apartP99);
  report.set(key + ".apart_max", outer.apartMax);
  reportCaps(key, outer.caps, report);
  report.setColumn(key + ".cuts.x", outer.cuts, [](auto& c) { return c.place.x; });
  report.setColumn(key + ".cuts.y", outer.cuts, [](auto& c) { return c.place.y; });
  report.setColumn(key + ".cuts.z", outer.cuts, [](auto& c) { return c.place.z; });
  report.setColumn(key + ".cuts.size", outer.cuts, [](auto& c) { return c.size; });
}

LaidOutMesh layOut(Mesh mesh, const SurfaceOptions& options, Context& context) {
  LaidOutMesh laid = layOutMesh(std::move(mesh), options.layOut);
  tell(laid, context);
  return laid;
}

ReportMesh reportOf(const LaidOutMesh& laid) {
  ReportMesh out = reportOf(laid.mesh, laid.volume());
  out.boundaryLoops = out.caps = laid.shells().caps;
  out.genus = laid.handles();
  return out;
}

void writeCorrespondencePictures(const std::string& path, const MeshCorrespondence& map,
                                 const WritePicture& write) {
  const MeshPictureSettings settings;
  write(path, [&](const std::string& to) { writeCorrespondencePicture(to, map, settings); });
  if (const std::optional<MeshCorrespondence> other = map.otherWay())
    write(otherPicture(path),
          [&](const std::string& to) { writeCorrespondencePicture(to, *other, settings); });
}

std::string otherPicture(const std::string& path) {
  return path.substr(0, path.size() - 4) + ".other.png";
}

MeshCorrespondence correspondMeshes(Mesh a, Mesh b, const CorrespondOptions& options,
                                    Context& context) {
  context.requireMemory("the correspondence",
                        correspondMemory(a.vertices.size(), b.vertices.size()),
                        "use coarser meshes");
  MeshCorrespondenceSettings settings = options.map;
  if (!options.landmarks.empty()) settings.landmarks = readLandmarks(options.landmarks);
  auto [laidA, laidB] = layOutMeshes(std::move(a), std::move(b), settings.layOut);
  tell(laidA, context);
  tell(laidB, context);
  context.report().source = reportOf(laidA);
  context.report().target = reportOf(laidB);
  if (!laidA.outer) reportCaps("source", laidA.caps(), context.report());
  if (!laidB.outer) reportCaps("target", laidB.caps(), context.report());
  MeshCorrespondence map = innermap::correspondMeshes(std::move(laidA), std::move(laidB), settings);
  context.tell(map);
  reportMap(map, context.report());
  reportConsidered(map.map.shells.front(), context.report());
  context.print(
      qualityText(map.quality, map.map.shells.front().image.space, map.a.outer || map.b.outer));
  return map;
}

}  // namespace innermap::tool
