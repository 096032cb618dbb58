#include "correspondence.h"

#include <fmt/format.h>

#include "innermap/core/memory.h"
#include "innermap/io/solid_pictures.h"
#include "inputs.h"
#include "map_report.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

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
  c.flag("--close", &close, "no longer needed: innermap caps the holes of an open mesh").advanced();
}

}  // namespace

void addSurfaceOptions(Command& c, SurfaceOptions& o) {
  addClose(c, o.close);
  c.settings(describe(o.layOut));
}

void addCorrespondOptions(Command& c, CorrespondOptions& o) {
  c.group("laying SOURCE onto TARGET");
  c.option("--landmarks", "FILE", &o.landmarks, "pairs of places that the result keeps exactly")
      .reads();
  c.settings(without(describe(o.map), {"seed"}));
  addClose(c, o.close);
}

Mesh takeCleanSurface(Mesh mesh, const LayOutSettings& settings, Context& context) {
  CleanSurface clean = context.timed("surface", [&] { return cleanSurface(mesh, settings); });
  for (const std::string& note : clean.notes) context.note(note);
  context.report().add("outer_surface", outerSurfaceFigures(clean.outer));
  return clean.outer ? std::move(clean.outer->mesh) : std::move(mesh);
}

Mesh readCleanSurface(const std::string& path, const SurfaceOptions& options, Context& context) {
  return takeCleanSurface(readMeshFile(path, context), options.layOut, context);
}

LaidOutMesh layOut(Mesh mesh, const SurfaceOptions& options, Context& context) {
  LaidOutMesh laid = layOutMesh(std::move(mesh), options.layOut);
  tell(laid, context);
  return laid;
}

void reportLaidOut(const std::string& section, const LaidOutMesh& laid, Report& report) {
  ReportMesh out = reportOf(laid.mesh, laid.volume());
  if (!laid.outer) out.capPlaces = laid.caps();
  out.boundaryLoops = out.caps = laid.shells().caps;
  out.genus = laid.handles();
  report.add(section, figures(out));
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
  MeshCorrespondenceSettings settings = options.map;
  if (!options.landmarks.empty()) settings.landmarks = readLandmarks(options.landmarks);
  auto [laidA, laidB] = layOutMeshes(std::move(a), std::move(b), settings.layOut);
  tell(laidA, context);
  tell(laidB, context);
  reportLaidOut("source", laidA, context.report());
  reportLaidOut("target", laidB, context.report());
  MeshCorrespondence map = innermap::correspondMeshes(std::move(laidA), std::move(laidB), settings);
  context.tell(map);
  context.report().add("correspondence", correspondenceFigures(&map));
  context.detail(
      qualityText(map.quality, map.map.shells.front().image.space, map.a.outer || map.b.outer));
  return map;
}

}  // namespace innermap::tool
