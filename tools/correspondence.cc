#include "correspondence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "correspondence_picture.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/triangle_tree.h"
#include "innermap/surface/map_quality.h"
#include "innermap/surface/surface_image.h"
#include "landmarks.h"

namespace innermap::tool {
namespace {

// Measured: up to 10,000 bytes a vertex for small meshes, less for large ones.
constexpr std::uint64_t kProgram = 64'000'000, kBytesPerVertex = 6000, kPicture = 300'000'000;

// Addresses on the shells' mesh become addresses on the file's.
std::vector<SurfacePoint> onFile(const SurfaceInput& b, const std::vector<SurfacePoint>& points,
                                 const Points& positions) {
  const std::size_t own = b.mesh.triangles.size();
  const TriangleTree tree(b.mesh.vertices, b.mesh.triangles);
  std::vector<SurfacePoint> result = points;
  for (std::size_t i = 0; i < result.size(); ++i) {
    SurfacePoint& p = result[i];
    const std::size_t t = static_cast<std::size_t>(p.triangle);
    if (!b.ownNumbers() || t >= own)
      p = tree.closest(positions[i]).address;
    else if (b.shells().turned[t])
      std::swap(p.barycentric[1], p.barycentric[2]);
  }
  return result;
}

MovedMesh movedMesh(const SurfaceInput& a, const SurfaceInput& b, const Correspondence& map,
                    Context& context) {
  MovedMesh moved;
  std::vector<SurfacePoint> onTarget;
  if (a.standIn) {
    const SurfaceImages images = imagesOf(a.mesh.vertices, map, b.shells(), context.progress());
    moved.source = a.mesh;
    moved.positions = images.positions;
    onTarget = images.onTarget;
    context.report().set("correspondence.farthest_from_stand_in",
                         images.farthest / boundingBox(a.mesh).diagonal());
  } else {
    moved.changed = map.source.vertices.size() > a.shells().mesh.vertices.size() ||
                    a.shells().splitVertices > 0;
    moved.source = moved.changed ? map.source : a.mesh;
    const auto count = static_cast<std::ptrdiff_t>(moved.source.vertices.size());
    moved.positions.assign(map.positions.begin(), map.positions.begin() + count);
    onTarget.assign(map.onTarget.begin(), map.onTarget.begin() + count);
  }
  moved.onTarget = onFile(b, onTarget, moved.positions);
  return moved;
}

CorrespondSettings settingsOf(const CorrespondOptions& options, std::uint64_t seed,
                              Context& context) {
  CorrespondSettings settings;
  settings.aligned = options.aligned;
  settings.candidates = options.candidates;
  settings.refine = !options.noRefine;
  settings.seed = seed;
  settings.subdivide = options.subdivide.value_or(0);
  settings.progress = context.progress();
  return settings;
}

void reportQuantiles(Report& report, const std::string& key, const Quantiles& q) {
  report.set(key + ".median", q.median);
  report.set(key + ".p99", q.p99);
  report.set(key + ".max", q.max);
}

void reportQuality(const MapQuality& q, Report& report) {
  const auto set = [&](const char* key, ReportValue value) {
    report.set(std::string("correspondence.") + key, std::move(value));
  };
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

void reportLandmarks(const std::vector<Landmark>& landmarks, const SurfaceInput& b,
                     const Correspondence& map, Report& report) {
  double farthest = 0;
  for (const Landmark& landmark : landmarks)
    farthest = std::max(farthest, norm(map.positions[landmark.vertex] -
                                       positionOf(b.shells().mesh, landmark.onTarget)));
  report.set("correspondence.landmarks", static_cast<std::int64_t>(landmarks.size()));
  if (!landmarks.empty())
    report.set("correspondence.landmark_error", farthest / boundingBox(b.shells().mesh).diagonal());
}

void warnOf(const MapQuality& q, const SurfaceInput& b, Context& context) {
  if (q.flips > 0)
    context.warning(
        fmt::format("{} triangles are flipped in the layouts, so the map is not "
                    "one-to-one there; check the meshes for degenerate parts",
                    q.flips));
  if (q.targetSelfIntersections > 0)
    context.warning(fmt::format(
        "{} has {} pair{} of triangles that pass through each other; no map onto its inside can "
        "be one-to-one there (see innermap check)",
        b.mesh.name, q.targetSelfIntersections, q.targetSelfIntersections == 1 ? "" : "s"));
}

}  // namespace

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

Mesh MovedMesh::target(const std::string& name) const {
  Mesh mesh = source;
  mesh.name = name;
  mesh.vertices = positions;
  return mesh;
}

// Measured on two cores: trying first maps on coarsened surfaces takes about as long for all but
// small meshes, the rest grows with the number of vertices.
double correspondSeconds(std::size_t verticesA, std::size_t verticesB,
                         const CorrespondOptions& options) {
  const double vertices = static_cast<double>(verticesA + verticesB);
  const double refine = options.noRefine ? 0 : 3.0 * options.candidates;
  return 1 + (10 + refine) * vertices / (vertices + 2000) + 0.5e-3 * vertices;
}

std::uint64_t correspondMemory(std::size_t verticesA, std::size_t verticesB,
                               const CorrespondOptions&) {
  return layOutMemory(verticesA + verticesB) + kPicture;
}

std::uint64_t layOutMemory(std::size_t vertices) {
  return kProgram + kBytesPerVertex * static_cast<std::uint64_t>(vertices);
}

void requirePly(const std::string& option, const std::string& path) {
  const std::string extension = path.size() < 5 ? "" : path.substr(path.size() - 4);
  if (extension != ".ply" && extension != ".PLY")
    throw UsageError(option + ": '" + path + "' must end in .ply");
}

MovedMesh correspondMeshes(Mesh meshA, Mesh meshB, const CorrespondOptions& options,
                           std::uint64_t seed, Context& context) {
  requireMemory("the correspondence",
                correspondMemory(meshA.vertices.size(), meshB.vertices.size(), options),
                context.maxMemory(), "use coarser meshes");
  std::vector<LandmarkLine> lines;
  if (!options.landmarks.empty()) lines = readLandmarks(options.landmarks);
  const auto inputA = std::make_shared<const SurfaceInput>(
                 embedSurface(std::move(meshA), options.surfaces, context)),
             inputB = std::make_shared<const SurfaceInput>(
                 embedSurface(std::move(meshB), options.surfaces, context));
  const SurfaceInput &a = *inputA, &b = *inputB;
  CorrespondSettings settings = settingsOf(options, seed, context);
  if (!lines.empty()) settings.landmarks = placeLandmarks(options.landmarks, lines, a, b, context);
  Report& report = context.report();
  report.source = reportOf(a);
  report.target = reportOf(b);
  const auto result =
      std::make_shared<const Correspondence>(correspond(a.embedded, b.embedded, settings));
  const Correspondence& map = *result;
  for (const auto& [stage, seconds] : map.seconds) report.seconds.emplace_back(stage, seconds);
  for (const std::string& note : map.notes) context.note(note);
  MovedMesh moved;
  context.timed("carry back", [&] { moved = movedMesh(a, b, map, context); });
  MapQuality quality;
  context.timed("measure", [&] {
    MapQualitySettings measure;
    measure.progress = context.progress();
    quality = mapQuality(map, measure);
  });
  reportQuality(quality, report);
  reportLandmarks(settings.landmarks, b, map, report);
  report.set("correspondence.vertices", static_cast<std::int64_t>(moved.source.vertices.size()));
  report.set("correspondence.target_vertices", static_cast<std::int64_t>(b.mesh.vertices.size()));
  report.set("correspondence.subdivided", moved.changed);
  report.set("correspondence.source_isosurface", a.standIn);
  report.set("correspondence.target_isosurface", b.standIn);
  warnOf(quality, b, context);
  context.print(qualityText(quality, map.shells.front().image.space, a.standIn || b.standIn));
  moved.drawPicture = [inputA, inputB, result, &context](const std::string& path) {
    context.timed("picture",
                  [&] { writeCorrespondencePicture(path, *inputA, *inputB, *result, context); });
  };
  return moved;
}

}  // namespace innermap::tool
