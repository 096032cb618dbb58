#include "innermap/boundary/laid_out_mesh.h"

#include <fmt/format.h>

#include "innermap/core/stage_seconds.h"
#include "innermap/levelset/isosurface.h"
#include "innermap/mesh/repair.h"
#include "innermap/mesh/self_intersection.h"
#include "innermap/mesh/triangle_tree.h"

namespace innermap {
namespace {

// Measured, bytes: what coarsened surfaces take, and a vertex of meshes of up to 160,000.
constexpr std::uint64_t kCoarse = 24'000'000, kBytesPerVertex = 2200;

// Whether parts that are not connected pass through each other, so that the shells are not the
// boundary of the solid.
bool shellsCross(const SurfaceShells& shells, Progress* progress) {
  if (shells.shells.size() < 2) return false;
  Points vertices;
  std::vector<Triangle> triangles;
  std::vector<std::size_t> shell;
  for (std::size_t s = 0; s < shells.shells.size(); ++s) {
    const int first = static_cast<int>(vertices.size());
    const ClosedSurface& surface = shells.shells[s];
    vertices.insert(vertices.end(), surface.vertices.begin(), surface.vertices.end());
    for (const auto& [a, b, c] : surface.triangles) {
      triangles.push_back({a + first, b + first, c + first});
      shell.push_back(s);
    }
  }
  bool cross = false;
  SelfIntersectionSettings settings;
  settings.progress = progress;
  const auto visit = [&](const Crossing& c) {
    cross = cross ||
            shell[static_cast<std::size_t>(c.first)] != shell[static_cast<std::size_t>(c.second)];
  };
  forEachSelfIntersection(vertices, triangles, visit, settings);
  return cross;
}

// Why the mesh itself cannot be mapped; empty when it can. Throws DataError when there is no solid.
std::string obstacle(const Mesh& mesh, bool close, Progress* progress) {
  RepairSettings repairSettings;
  repairSettings.progress = progress;
  repair(mesh, repairSettings);
  ClosedSurfaceSettings settings;
  settings.closeHoles = close;
  settings.progress = progress;
  try {
    if (!shellsCross(closedSurfaces(mesh, settings), progress)) return "";
    return mesh.name +
           ": has parts that overlap one another; unite them, or map the solid's own surface (an "
           "isosurface) instead";
  } catch (const DataError& error) {
    return error.what();
  }
}

Isosurface standInFor(const Mesh& mesh, const LayOutSettings& settings) {
  SolidSettings solidSettings;
  solidSettings.progress = settings.progress;
  IsosurfaceSettings how;
  how.resolution = settings.standInResolution;
  how.maxMemory = settings.maxMemory;
  how.progress = settings.progress;
  return isosurfaceOf(Solid(mesh, solidSettings), how);
}

std::string standInNote(const LaidOutMesh& laid, int resolution, std::size_t leftOut) {
  const std::size_t shells = laid.shells().shells.size();
  return fmt::format(
      "{}: its solid's own surface is mapped, {} vertices of an isosurface at {} voxels across, "
      "genus {}{}{}",
      laid.mesh.name, laid.shells().mesh.vertices.size(), resolution, laid.handles(),
      shells == 1 ? "" : fmt::format(" ({} shells)", shells),
      leftOut == 0   ? ""
      : leftOut == 1 ? "; 1 tiny part of it left out"
                     : fmt::format("; {} tiny parts of it left out", leftOut));
}

void check(const LayOutSettings& settings) {
  const int resolution = settings.standInResolution;
  if (resolution != 0 && (resolution < 8 || resolution > 2048))
    throw SettingError("standInResolution", "must be from 8 to 2048, or 0 for none");
}

// Places on the sphere of the first `count` vertices of the shells' mesh.
Points placesOf(const LaidOutMesh& laid, std::size_t count) {
  const SurfaceShells& shells = laid.shells();
  std::vector<Triangle> triangles;
  for (const std::vector<int>& list : shells.meshTriangle)
    for (const int t : list) triangles.push_back(shells.mesh.triangles[t]);
  const auto place = [&](int v) {
    const ShellVertex at = shells.shellVertex[v];
    return laid.embedded.layout(static_cast<std::size_t>(at.shell)).place[at.vertex];
  };
  const TriangleTree tree(shells.mesh.vertices, triangles);
  Points places(count);
  for (std::size_t v = 0; v < count; ++v) {
    if (shells.shellVertex[v].shell >= 0) {
      places[v] = place(static_cast<int>(v));
      continue;
    }
    const SurfacePoint nearest = tree.closest(shells.mesh.vertices[v]).address;
    Vec3 sum;
    for (int k = 0; k < 3; ++k)
      sum += nearest.barycentric[k] * place(triangles[nearest.triangle][k]);
    places[v] = sum / norm(sum);
  }
  return places;
}

}  // namespace

int LaidOutMesh::handles() const {
  int sum = 0;
  for (const ClosedSurface& shell : shells().shells) sum += shell.genus;
  return sum;
}

double LaidOutMesh::volume() const {
  double sum = 0;
  for (const ClosedSurface& shell : shells().shells)
    sum += signedVolume(shell.vertices, shell.triangles);
  return sum;
}

LaidOutMesh layOutMesh(Mesh mesh, const LayOutSettings& settings) {
  check(settings);
  Progress* progress = settings.progress;
  StageSeconds seconds;
  const auto embed = [&](const Mesh& surface, bool close) {
    EmbeddingSettings how;
    how.closeHoles = close;
    how.progress = progress;
    return timed(seconds, "lay out", [&] { return EmbeddedSurface(surface, how); });
  };
  const std::string why =
      timed(seconds, "check", [&] { return obstacle(mesh, settings.closeHoles, progress); });
  if (why.empty()) {
    const EmbeddedSurface embedded = embed(mesh, settings.closeHoles);
    LaidOutMesh laid(std::move(mesh), embedded);
    laid.seconds = std::move(seconds);
    for (const std::string& note : laid.shells().notes)
      laid.notes.push_back(laid.mesh.name + ": " + note);
    if (settings.standInResolution)
      laid.notes.push_back(laid.mesh.name + ": is closed and clean, so it is mapped as it is");
    return laid;
  }
  if (!settings.standInResolution)
    throw UnfitMesh(why, !settings.closeHoles && obstacle(mesh, true, progress).empty());
  const Isosurface standIn =
      timed(seconds, "isosurface", [&] { return standInFor(mesh, settings); });
  const EmbeddedSurface embedded = embed(standIn.mesh, false);
  LaidOutMesh laid(std::move(mesh), embedded);
  laid.standIn = true;
  laid.voxelSize = standIn.voxelSize;
  laid.seconds = std::move(seconds);
  laid.notes = {why.substr(0, why.rfind("; ")),
                standInNote(laid, settings.standInResolution, standIn.leftOut)};
  return laid;
}

std::uint64_t layOutMemory(std::size_t vertices) {
  return kCoarse + kBytesPerVertex * static_cast<std::uint64_t>(vertices);
}

MeshOnSphere onSphere(const LaidOutMesh& laid) {
  const SurfaceShells& shells = laid.shells();
  for (const ClosedSurface& shell : shells.shells)
    if (shell.genus != 0)
      throw DataError(fmt::format(
          "{}: has {} handle{}, a sphere has none; innermap correspond maps solids with handles "
          "onto each other",
          laid.mesh.name, shell.genus, shell.genus == 1 ? "" : "s"));
  const bool own = laid.ownNumbers() && shells.splitVertices == 0;
  MeshOnSphere out;
  out.mesh.name = laid.mesh.name;
  out.mesh.triangles = own ? laid.mesh.triangles : shells.mesh.triangles;
  out.mesh.vertices = placesOf(laid, own ? laid.mesh.vertices.size() : shells.mesh.vertices.size());
  std::vector<LayoutQuality> qualities;
  for (std::size_t s = 0; s < shells.shells.size(); ++s)
    qualities.push_back(layoutQuality(shells.shells[s].triangles, shells.shells[s].vertices,
                                      laid.embedded.layout(s)));
  out.quality = together(qualities);
  return out;
}

}  // namespace innermap
