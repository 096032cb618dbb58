#include "innermap/correspond/mesh_correspondence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "fit/volume_judge.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr std::uint64_t kJudged = 24'000'000;  // bytes: the insides of the ways that are tried
constexpr double kOffTarget = 0.01;            // of the target's diagonal

void requireCorrespondMemory(const Mesh& a, const Mesh& b) {
  requireMemory("the correspondence", correspondMemory(a.vertices.size(), b.vertices.size()),
                "use coarser meshes");
}

// Addresses on the shells' mesh become addresses on the mesh as given.
std::vector<SurfacePoint> onGiven(const LaidOutMesh& b, const std::vector<SurfacePoint>& points,
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

// Fills source, changed, positions, onTarget, farthestFromOuter.
void carryBack(MeshCorrespondence& out, bool toOwnVertices) {
  const LaidOutMesh &a = out.a, &b = out.b;
  std::vector<SurfacePoint> onTarget;
  if (a.outer && toOwnVertices) {
    const SurfaceImages images = imagesOf(a.mesh.vertices, out.map, b.shells());
    out.source = a.mesh;
    out.positions = images.positions;
    onTarget = images.onTarget;
    out.farthestFromOuter = images.farthest / boundingBox(a.mesh).diagonal();
  } else {
    const Correspondence& map = out.map;
    out.changed = a.outer || map.source.vertices.size() > a.shells().mesh.vertices.size() ||
                  a.shells().splitVertices > 0;
    out.source = out.changed ? map.source : a.mesh;
    const auto count = static_cast<std::ptrdiff_t>(out.source.vertices.size());
    out.positions.assign(map.positions.begin(), map.positions.begin() + count);
    onTarget.assign(map.onTarget.begin(), map.onTarget.begin() + count);
  }
  out.onTarget = onGiven(b, onTarget, out.positions);
}

// By the inside, where the shells have one.
std::shared_ptr<const MapJudge> judgeOf(const ClosedSurface& a, const ClosedSurface& b) {
  const auto volume = [](const ClosedSurface& s) {
    Mesh mesh;
    mesh.vertices = s.vertices;
    mesh.triangles = s.triangles;
    return signedVolume(mesh);
  };
  if (!(volume(a) > 0 && volume(b) > 0)) return nullptr;
  try {
    const auto judge = std::make_shared<const VolumeJudge>(a, volume(b));
    return std::make_shared<const MapJudge>(
        MapJudge{judge->at(), [judge](const Points& images) { return judge->score(images); }});
  } catch (const DataError&) {  // too thin for charges: the surfaces' energy must do
    return nullptr;
  }
}

CorrespondSettings settingsOf(const MeshCorrespondenceSettings& settings) {
  CorrespondSettings out;
  out.aligned = settings.aligned;
  out.candidates = settings.candidates;
  out.way = settings.way;
  out.refine = settings.refine;
  out.judge = [](const ClosedSurface& a, const ClosedSurface& b) { return judgeOf(a, b); };
  out.seed = settings.seed;
  out.subdivide = settings.subdivide;
  return out;
}

double landmarkErrorOf(const MeshCorrespondence& out, const std::vector<Landmark>& landmarks) {
  const Mesh& target = out.b.shells().mesh;
  double farthest = 0;
  for (const Landmark& landmark : landmarks)
    farthest = std::max(
        farthest, norm(out.map.positions[landmark.vertex] - positionOf(target, landmark.onTarget)));
  return farthest / boundingBox(target).diagonal();
}

void warnOf(MeshCorrespondence& out) {
  const MapQuality& q = out.quality;
  if (q.flips > 0)
    out.warnings.push_back(
        fmt::format("{} triangles are flipped in the layouts, so the map is not one-to-one there; "
                    "check the meshes for degenerate parts",
                    q.flips));
  if (q.targetSelfIntersections > 0)
    out.warnings.push_back(fmt::format(
        "{} has {} pair{} of triangles that pass through each other; no map onto its inside can "
        "be one-to-one there (see innermap check)",
        out.b.mesh.name, q.targetSelfIntersections, q.targetSelfIntersections == 1 ? "" : "s"));
}

}  // namespace

Mesh MeshCorrespondence::target(const std::string& name) const {
  Mesh mesh = source;
  mesh.name = name;
  mesh.vertices = positions;
  return mesh;
}

std::optional<MeshCorrespondence> MeshCorrespondence::otherWay() const {
  if (!map.shells.front().other) return {};
  MeshCorrespondence out = *this;
  ShellCorrespondence& shell = out.map.shells.front();
  shell.surface = shell.other->surface;
  shell.image = shell.other->image;
  return out;
}

MeshCorrespondence correspondMeshes(Mesh a, Mesh b, const MeshCorrespondenceSettings& settings) {
  requireCorrespondMemory(a, b);
  auto [laidA, laidB] = layOutMeshes(std::move(a), std::move(b), settings.layOut);
  return correspondMeshes(std::move(laidA), std::move(laidB), settings);
}

MeshCorrespondence correspondMeshes(LaidOutMesh a, LaidOutMesh b,
                                    const MeshCorrespondenceSettings& settings) {
  requireCorrespondMemory(a.shells().mesh, b.shells().mesh);
  MeshCorrespondence out(std::move(a), std::move(b));
  CorrespondSettings how = settingsOf(settings);
  if (!settings.landmarks.pairs.empty()) {
    PlacedLandmarks placed = placeLandmarks(settings.landmarks, out.a, out.b);
    if (!placed.note.empty()) (placed.far ? out.warnings : out.notes).push_back(placed.note);
    how.landmarks = std::move(placed.landmarks);
  }
  out.map = correspond(out.a.embedded, out.b.embedded, how);
  for (const auto& [stage, seconds] : out.map.seconds) addSeconds(out.seconds, stage, seconds);
  out.notes.insert(out.notes.end(), out.map.notes.begin(), out.map.notes.end());
  timed(out.seconds, "carry back", [&] { carryBack(out, settings.carryBack); });
  MapQualitySettings measure;
  out.quality = timed(out.seconds, "measure", [&] { return mapQuality(out.map, measure); });
  out.landmarks = how.landmarks.size();
  out.landmarkError = landmarkErrorOf(out, how.landmarks);
  warnOf(out);
  return out;
}

std::uint64_t correspondMemory(std::size_t verticesA, std::size_t verticesB) {
  return layOutMemory(verticesA + verticesB) + kJudged;
}

bool sameConnectivity(const Mesh& a, const Mesh& b) {
  if (a.vertices.size() != b.vertices.size()) return false;
  // A polygon may be cut in other ways.
  const bool polygons = !a.polygonStart.empty() && a.polygonStart == b.polygonStart &&
                        a.polygonCorners == b.polygonCorners;
  return polygons || a.triangles == b.triangles;
}

void writeCorrespondence(const std::string& path, const MeshCorrespondence& map) {
  writeCorrespondence(path, map.source, map.positions, map.onTarget);
}

void writeCorrespondence(const std::string& path, const Mesh& source, const Points& positions,
                         const std::vector<SurfacePoint>& onTarget) {
  Mesh moved;
  moved.name = path;
  moved.vertices = positions;
  moved.triangles = source.triangles;
  std::vector<std::int32_t> triangles;
  std::array<std::vector<double>, 3> weights;
  for (const SurfacePoint& p : onTarget) {
    triangles.push_back(p.triangle);
    for (std::size_t k = 0; k < 3; ++k) weights[k].push_back(p.barycentric[k]);
  }
  PlyExtras extras;
  extras.comment = "triangle, b0, b1, b2: place of the vertex on the other mesh";
  extras.properties.push_back({"triangle", std::move(triangles)});
  for (std::size_t k = 0; k < 3; ++k)
    extras.properties.push_back({fmt::format("b{}", k), std::move(weights[k])});
  writePly(path, moved, extras);
}

Mesh readCorrespondence(const std::string& path, const Mesh& source) {
  try {
    return readMeshLike(path, source);
  } catch (const DataError& error) {
    throw DataError(std::string(error.what()) +
                    "; where triangles were split for it, the source is the .source.ply beside it");
  }
}

void requireOnTarget(const Mesh& moved, const Mesh& target) {
  const TriangleTree tree(target.vertices, target.triangles);
  std::vector<double> distances;
  for (const Vec3& p : moved.vertices) distances.push_back(tree.closest(p).distance);
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double share = *middle / boundingBox(target).diagonal();
  if (!(share <= kOffTarget))
    throw DataError(fmt::format(
        "{}: does not lie on {}, half of its vertices are {:.2g} of the diagonal away or more; "
        "give the two that belong together",
        moved.name, target.name, share));
}

std::vector<Setting> describe(MeshCorrespondenceSettings& s) {
  std::vector<Setting> out{
      Setting("aligned", &s.aligned,
              "prefer agreeing normals and places, if both stand in the same pose and orientation"),
      Setting("candidates", "N", &s.candidates,
              "refine this many ways to lay one on the other, and take the one whose harmonic map "
              "stretches and folds the inside least")
          .from(1, 64)
          .rare(),
      Setting("choose", "N", &s.way.choose,
              "take the N-th best of the ways that differ; a note appears if the second is about "
              "as good as the first")
          .from(1, 64),
      Setting("mirror", &s.way.mirror,
              "take the best way that swaps left and right, for bodies that are the same on both "
              "sides"),
      Setting("refine", &s.refine, "take the best way without refining it: fast, rough").rare(),
      Setting("subdivide", "T", &s.subdivide,
              "split the source's triangles until they follow the target within T, and write the "
              "split source too; 0: never")
          .in("fraction of the target's diagonal")
          .from(0, 1)
          .rare(),
      seedSetting(&s.seed)};
  for (Setting& setting : describe(s.layOut)) out.push_back(std::move(setting));
  return out;
}

}  // namespace innermap
