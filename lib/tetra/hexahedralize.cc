#include "innermap/tetra/hexahedralize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/fit/fit_map.h"
#include "lattice/sharp_edges.h"
#include "mesh/triangle_tree.h"
#include "tetra/detail/hex_shaping.h"

namespace innermap {
namespace {

constexpr int kMostPieces = 16;
// Vertices of the polycube's surface: enough for a good map, few enough for a quick one.
constexpr double kSurfaceVertices = 3000;
// The map of the inside need only be near: what it carries is shaped afterwards.
constexpr double kTolerance = 5e-3;
constexpr std::size_t kMaxSources = 6000;
constexpr int kRetries = 2;
constexpr double kMoreBlocks = 1.15;  // each time, across
constexpr std::size_t kFeatureSamples = 20000, kHexahedraBlock = 256;
// Measured: of shaping; and what the correspondence and the map keep while the other is made.
// Of the time that is left: what comes after, shaping above all, needs the rest.
constexpr double kFittingShare = 0.4;
constexpr std::uint64_t kBytesAHexahedron = 2560, kBeside = 30'000'000;

int surfacePieces(const BlockSet& blocks) {
  const double faces = static_cast<double>(blockSurface(blocks, 1).triangles.size()) / 2;
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(kSurfaceVertices / faces))));
}

// The solid's boundary, and where the hexahedra of the blocks are carried in it.
struct Carried {
  Mesh surface;
  BlockHexahedra hexes;
  std::vector<SurfacePoint> onSurface;  // of the skin
};

Carried carry(const Mesh& mesh, const HexahedralizeSettings& settings, Hexahedralization& out) {
  Carried carried;
  MeshCorrespondenceSettings laying;
  laying.aligned = true;
  laying.seed = settings.seed;
  const MeshCorrespondence map = timed(out.seconds, "boundary map", [&] {
    const PartOfTime time(kLayingTimeShare);
    return correspondMeshes(blockSurface(out.polycube.blocks, surfacePieces(out.polycube.blocks)),
                            mesh, laying);
  });
  out.boundaryMap = map.quality;
  carried.surface.name = mesh.name;
  carried.surface.vertices = map.b.shells().mesh.vertices;
  carried.surface.triangles = map.b.shells().mesh.triangles;
  carried.hexes = blockHexahedra(out.polycube.blocks, settings.pieces);
  out.inBlocks = carried.hexes.mesh;
  timed(out.seconds, "map", [&] {
    FitMapSettings fitting;
    fitting.tolerance = kTolerance;
    fitting.maxSources = kMaxSources;
    fitting.oneToOne = OneToOne::off;
    fitting.seed = settings.seed;
    const MapFit fit = [&] {
      const PartOfTime time(kFittingShare);
      return fitMap(map.source, map.target("polycube on " + mesh.name), fitting);
    }();
    EvaluateFieldSettings evaluating;
    evaluating.accuracy = 1e-5 * fit.solid().diagonal();
    Points& at = carried.hexes.mesh.vertices;
    const Matrix moved = fit.map.evaluate(at, evaluating).values;
    for (std::size_t v = 0; v < at.size(); ++v) at[v] = {moved(v, 0), moved(v, 1), moved(v, 2)};
    Points skin;
    for (const auto& s : carried.hexes.skin) skin.push_back(out.inBlocks.vertices[s.outer]);
    SurfaceImages images = imagesOf(skin, map.map, map.b.shells());
    for (std::size_t s = 0; s < skin.size(); ++s)
      at[carried.hexes.skin[s].outer] = images.positions[s];
    carried.onSurface = std::move(images.onTarget);
  });
  return carried;
}

// At equal distances along the curves, about kFeatureSamples in all.
Points samplesOf(const SharpEdges& sharp, double length) {
  Points out;
  for (const SharpCurve& curve : sharp.curves)
    for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
      const Vec3 from = curve.points[i], way = curve.points[i + 1] - from;
      const int pieces =
          std::max(1, static_cast<int>(std::ceil(norm(way) / length * kFeatureSamples)));
      for (int k = 0; k < pieces; ++k) out.push_back(from + (k + 0.5) / pieces * way);
    }
  return out;
}

// Of the solid's sharp edges from the hexahedra's surface.
void measureFeatures(const Mesh& surface, const HexahedralizeSettings& settings,
                     Hexahedralization& out) {
  const SharpEdges sharp = sharpEdges(surface, settings.featureAngle);
  for (const SharpCurve& curve : sharp.curves) out.featureLength += curve.length;
  const Points samples = samplesOf(sharp, out.featureLength);
  if (samples.empty()) return;
  const TriangleTree tree(out.mesh.vertices, boundaryTriangles(out.mesh));
  std::vector<double> lengths(samples.size());
  parallelBlocks(samples.size(), kHexahedraBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) lengths[i] = tree.closest(samples[i]).distance;
  });
  const double diagonal = boundingBox(surface).diagonal();
  double squares = 0;
  for (const double length : lengths) {
    squares += length * length;
    out.fromFeatures.max = std::max(out.fromFeatures.max, length / diagonal);
  }
  out.fromFeatures.rms = std::sqrt(squares / static_cast<double>(samples.size())) / diagonal;
}

void measure(const Mesh& surface, const HexahedralizeSettings& settings, Hexahedralization& out) {
  out.after = checkHexahedra(out.mesh);
  out.quality = cellQuality(out.mesh);
  out.proof.cells = out.mesh.hexahedra.size();
  out.proof.inverted = out.after.inverted;
  out.proof.undecided = out.after.undecided;
  out.proof.exact = out.after.exact;
  setQualityFields(out.mesh, out.quality);
  BoundaryFitSettings fitting;
  fitting.seed = settings.seed + 1;  // other points than those that shaped the hexahedra
  out.boundary = boundaryFit(out.mesh, Solid(surface), fitting);
  measureFeatures(surface, settings, out);
}

void tell(Hexahedralization& out) {
  const HexahedronCheck& check = out.after;
  if (!check.proven())
    out.warnings.push_back(
        fmt::format("{} hexahedra are inverted somewhere, {} of them at a corner, and {} are not "
                    "proven right side out; try other numbers of blocks",
                    check.inverted, check.invertedCorners, check.undecided));
  const auto& parts = out.polycube.missedParts;
  if (!parts.empty())
    out.notes.push_back(
        fmt::format("no block covers {} part{} of the solid, the largest ({:.2g} of its volume) "
                    "about ({:.4g}, {:.4g}, {:.4g}): hexahedra stretch into {} from the side",
                    parts.size(), parts.size() == 1 ? "" : "s", parts[0].volume, parts[0].centre.x,
                    parts[0].centre.y, parts[0].centre.z, parts.size() == 1 ? "it" : "them"));
}

Hexahedralization attempt(const Mesh& mesh, const HexahedralizeSettings& settings, int blocks) {
  Hexahedralization out;
  PolycubeSettings cubes;
  cubes.blocks = blocks;
  out.polycube = timed(out.seconds, "polycube", [&] { return makePolycube(mesh, cubes); });
  out.notes = out.polycube.notes;
  out.pieces = settings.pieces;
  Carried carried = carry(mesh, settings, out);
  out.before = checkHexahedra(carried.hexes.mesh);
  HexShapingSettings shaping;
  shaping.seed = settings.seed;
  timed(out.seconds, "shape",
        [&] { shapeHexahedra(carried.hexes, carried.surface, carried.onSurface, shaping); });
  out.mesh = std::move(carried.hexes.mesh);
  out.mesh.name = mesh.name;
  timed(out.seconds, "measure", [&] { measure(carried.surface, settings, out); });
  tell(out);
  return out;
}

}  // namespace

Hexahedralization hexahedralize(const Mesh& mesh, const HexahedralizeSettings& settings) {
  requireDescribed(settings);
  requireMemory("hexahedra of " + mesh.name, hexahedralizeMemory(mesh, settings),
                "use fewer blocks, or fewer pieces a block");
  Hexahedralization best = attempt(mesh, settings, settings.polycube.blocks);
  for (int retry = 0; retry < kRetries && settings.polycube.blocks == 0 && !best.after.proven();
       ++retry) {
    const int more = static_cast<int>(std::ceil(kMoreBlocks * best.polycube.across));
    if (more > kMostAcross || outOfTime()) break;
    try {
      Hexahedralization other = attempt(mesh, settings, more);
      const auto bad = [](const Hexahedralization& h) {
        return h.after.inverted + h.after.undecided;
      };
      other.notes.push_back(fmt::format("{} blocks across, as some hexahedra of {} stayed inverted",
                                        more, best.polycube.across));
      if (bad(other) < bad(best)) best = std::move(other);
    } catch (const DataError&) {
      break;  // so many blocks have another topology
    }
  }
  return best;
}

std::uint64_t hexahedralizeMemory(const Mesh& mesh, const HexahedralizeSettings& settings) {
  PolycubeSettings cubes;
  cubes.blocks = settings.polycube.blocks;
  FitMapSettings fitting;
  fitting.tolerance = kTolerance;
  fitting.maxSources = kMaxSources;
  const double blocks = expectedBlocks(mesh, settings.polycube.blocks);
  const double pieces = settings.pieces;
  // Of the layer: one on each square of the boundary, of which a set of so many blocks has about
  // twice as many as a cube.
  const double hexahedra =
      pieces * pieces * (blocks * pieces + 12 * std::cbrt(blocks) * std::cbrt(blocks));
  return std::max({correspondMemory(static_cast<std::size_t>(2 * kSurfaceVertices),
                                    mesh.vertices.size()),
                   fitMapMemory(fitting, static_cast<std::size_t>(2 * kSurfaceVertices)),
                   polycubeMemory(mesh, cubes)}) +
         kBeside + static_cast<std::uint64_t>(hexahedra) * kBytesAHexahedron;
}

std::vector<Setting> describe(HexahedralizeSettings& s) {
  std::vector<Setting> out = describe(s.polycube);
  out.insert(
      out.end(),
      {Setting("pieces", "K", &s.pieces, "hexahedra along a block's edge").from(1, kMostPieces),
       Setting("feature_angle", "A", &s.featureAngle,
               "edges whose faces' normals differ by more count as sharp in the report")
           .in("degrees")
           .from(1, 179)
           .rare(),
       seedSetting(&s.seed)});
  return out;
}

}  // namespace innermap
