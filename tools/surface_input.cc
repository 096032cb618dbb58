#include "surface_input.h"

#include <fmt/format.h>

#include <numeric>

#include "innermap/levelset/isosurface.h"
#include "innermap/mesh/repair.h"
#include "innermap/mesh/self_intersection.h"

namespace innermap::tool {
namespace {

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
  const auto visit = [&](const Crossing& c) {
    cross = cross ||
            shell[static_cast<std::size_t>(c.first)] != shell[static_cast<std::size_t>(c.second)];
  };
  forEachSelfIntersection(vertices, triangles, visit, {progress});
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

// The options that would help.
std::string advice(const Mesh& mesh, bool close, Progress* progress) {
  const bool capsHelp = !close && obstacle(mesh, true, progress).empty();
  return capsHelp ? " (--close; --surface-resolution N for larger holes)"
                  : " (--surface-resolution N)";
}

Isosurface standInFor(const Mesh& mesh, int resolution, Context& context) {
  SolidSettings solidSettings;
  solidSettings.progress = context.progress();
  IsosurfaceSettings settings;
  settings.resolution = resolution;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  Isosurface result;
  context.timed("isosurface", [&] { result = isosurfaceOf(Solid(mesh, solidSettings), settings); });
  return result;
}

void tellStandIn(const SurfaceInput& input, int resolution, std::size_t leftOut, Context& context) {
  context.note(fmt::format(
      "{}: its solid's own surface is mapped, {} vertices of an isosurface at {} voxels across, "
      "{}{}",
      input.mesh.name, input.shells().mesh.vertices.size(), resolution,
      topologyText(input.shells()),
      leftOut == 0   ? ""
      : leftOut == 1 ? "; 1 tiny part of it left out"
                     : fmt::format("; {} tiny parts of it left out", leftOut)));
}

EmbeddedSurface embed(const Mesh& mesh, bool close, Context& context) {
  EmbeddingSettings settings;
  settings.closeHoles = close;
  settings.progress = context.progress();
  std::optional<EmbeddedSurface> embedded;
  context.timed("lay out", [&] { embedded.emplace(mesh, settings); });
  return *embedded;
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

SurfaceInput embedSurface(Mesh mesh, const SurfaceOptions& options, Context& context) {
  std::string why;
  context.timed("check", [&] { why = obstacle(mesh, options.close, context.progress()); });
  if (!why.empty() && !options.resolution)
    throw DataError(why + advice(mesh, options.close, context.progress()));
  if (why.empty()) {
    EmbeddedSurface embedded = embed(mesh, options.close, context);
    for (const std::string& note : embedded.surfaces().notes) context.note(mesh.name + ": " + note);
    if (options.resolution)
      context.note(mesh.name + ": is closed and clean, so it is mapped as it is");
    return {std::move(mesh), std::move(embedded), false, 0};
  }
  context.note(why.substr(0, why.rfind("; ")));
  const Isosurface standIn = standInFor(mesh, *options.resolution, context);
  SurfaceInput input{std::move(mesh), embed(standIn.mesh, false, context), true, standIn.voxelSize};
  tellStandIn(input, *options.resolution, standIn.leftOut, context);
  return input;
}

ReportMesh reportOf(const SurfaceInput& input) {
  ReportMesh out;
  out.path = input.mesh.name;
  out.vertices = input.mesh.vertices.size();
  out.triangles = input.mesh.triangles.size();
  out.boundaryLoops = out.caps = input.shells().caps;
  for (const ClosedSurface& shell : input.shells().shells) {
    Mesh part;
    part.vertices = shell.vertices;
    part.triangles = shell.triangles;
    out.volume += signedVolume(part);
    out.genus += shell.genus;
  }
  out.diagonal = boundingBox(input.mesh).diagonal();
  return out;
}

std::string topologyText(const SurfaceShells& shells) {
  const int genus =
      std::accumulate(shells.shells.begin(), shells.shells.end(), 0,
                      [](int sum, const ClosedSurface& shell) { return sum + shell.genus; });
  if (shells.shells.size() == 1) return fmt::format("genus {}", genus);
  return fmt::format("genus {} ({} shells)", genus, shells.shells.size());
}

}  // namespace innermap::tool
