#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <functional>
#include <optional>

#include "fit/tangle.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/mesh/check.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

// Measured, bytes: what coarsened surfaces take, and a vertex of meshes of up to 160,000.
constexpr std::uint64_t kCoarse = 24'000'000, kBytesPerVertex = 2200;

std::size_t crossings(const Points& vertices, const std::vector<Triangle>& triangles) {
  std::size_t count = 0;
  forEachSelfIntersection(vertices, triangles, [&](const Crossing&) { ++count; });
  return count;
}

// How many pairs of triangles pass through each other.
std::size_t crossings(const SurfaceShells& shells) {
  Points vertices;
  std::vector<Triangle> triangles;
  for (const ClosedSurface& surface : shells.shells) {
    const int first = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), surface.vertices.begin(), surface.vertices.end());
    for (const auto& [a, b, c] : surface.triangles)
      triangles.push_back({a + first, b + first, c + first});
  }
  return crossings(vertices, triangles);
}

// Why the mesh itself cannot be mapped, if so, and the handles of a mesh that is of one piece.
struct Obstacle {
  std::string why;
  std::size_t crossings = 0;  // pairs of triangles
  std::optional<int> handles;
};

// Throws DataError when there is no solid.
Obstacle obstacleOf(const Mesh& mesh) {
  repair(mesh);
  ClosedSurfaceSettings settings;
  settings.closeHoles = true;
  try {
    const SurfaceShells shells = closedSurfaces(mesh, settings);
    Obstacle out;
    out.crossings = crossings(shells);
    if (out.crossings > 0)
      out.why = fmt::format("{}: runs through itself, {} pair{} of triangles cross", mesh.name,
                            out.crossings, out.crossings == 1 ? "" : "s");
    if (shells.shells.size() == 1) out.handles = shells.shells[0].genus;
    return out;
  } catch (const DataError& error) {
    const std::string why = error.what();
    return {why.substr(0, why.rfind("; ")), crossings(mesh.vertices, mesh.triangles), {}};
  }
}

OuterSurface outerSurfaceOf(const Mesh& mesh, const Obstacle& obstacle,
                            const LayOutSettings& settings) {
  refuseTangle(mesh, obstacle.crossings);
  OuterSurfaceSettings how;
  how.resolution = settings.outerResolution;
  how.handles = settings.handles ? settings.handles : obstacle.handles;
  how.onePiece = obstacle.handles.has_value();
  return outerSurface(Solid(mesh), how);
}

constexpr std::size_t kNotedChanges = 3;
constexpr double kFewInsideOut = 0.005;  // of the surface: slivers where parts cross

std::string placesOf(const std::vector<TopologyChange>& changes) {
  std::string places;
  for (std::size_t c = 0; c < std::min(kNotedChanges, changes.size()); ++c) {
    const auto& [at, size] = changes[c];
    places += fmt::format("{}({:.4g}, {:.4g}, {:.4g}), {:.2g} across", c ? "; " : "", at.x, at.y,
                          at.z, size);
  }
  return fmt::format("{} place{}: {}{}", changes.size(), changes.size() == 1 ? "" : "s", places,
                     changes.size() > kNotedChanges ? "; smaller ones" : "");
}

std::vector<std::string> notesOn(const OuterSurface& outer, const std::string& name) {
  std::vector<std::string> notes;
  const SolidTopology& t = outer.topology;
  notes.push_back(fmt::format(
      "{}: innermap maps the outer surface of its solid: {} vertices, {}; 99% of the mesh's "
      "visible part lies within {:.2g} of the diagonal of it, all of it within {:.2g}",
      name, outer.mesh.vertices.size(), describe(t), outer.apartP99, outer.apartMax));
  if (!outer.caps.empty())
    notes.push_back(fmt::format("{}: {} hole{} capped", name, outer.caps.size(),
                                outer.caps.size() == 1 ? "" : "s"));
  if (outer.insideOut > kFewInsideOut)
    notes.push_back(
        fmt::format("{}: {:.2g}% of its surface is turned inside out (winding number -1), and the "
                    "part inside it is left out; flip those faces, or move that part back",
                    name, 100 * outer.insideOut));
  if (outer.leftOut > 0)
    notes.push_back(
        fmt::format("{}: {} left out, {:.2g}% of the volume", name,
                    outer.leftOut == 1 ? "1 part is" : fmt::format("{} parts are", outer.leftOut),
                    100 * outer.leftOutShare));
  if (!outer.plugs.empty())
    notes.push_back(fmt::format("{}: innermap closed tunnels that its mesh does not have, in {}",
                                name, placesOf(outer.plugs)));
  if (!outer.cuts.empty())
    notes.push_back(fmt::format("{}: innermap cut its parts apart where they meet, in {}", name,
                                placesOf(outer.cuts)));
  return notes;
}

CleanSurface checked(const Mesh& mesh, const LayOutSettings& settings, StageSeconds& seconds) {
  return timed(seconds, "check", [&] { return cleanSurface(mesh, settings); });
}

// Where the mesh has the handles of a union and the other has fewer: those of the other.
void makeAlike(const Mesh& mesh, const Mesh& other, LayOutSettings settings, CleanSurface& clean,
               const CleanSurface& like, StageSeconds& seconds) {
  if (!clean.handlesOfUnion || !clean.handles || !like.handles || *clean.handles <= *like.handles)
    return;
  settings.handles = like.handles;
  CleanSurface cut;
  try {
    cut = checked(mesh, settings, seconds);
  } catch (const DataError&) {
    return;  // no part has so many: the two are refused for what they have
  }
  cut.notes.push_back(fmt::format(
      "{}: its parts together have {} handle{}; innermap cuts it until it has {}, like {}",
      mesh.name, *clean.handles, *clean.handles == 1 ? "" : "s", *like.handles, other.name));
  clean = std::move(cut);
}

// At the same time. Where both fail, it is the first one's error.
void forBoth(const std::function<void()>& first, const std::function<void()>& second) {
  std::array<std::exception_ptr, 2> failed;
  parallelBlocks(2, 1, [&](std::size_t begin, std::size_t) {
    try {
      (begin == 0 ? first : second)();
    } catch (...) {
      failed[begin] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failed)
    if (failure) std::rethrow_exception(failure);
}

struct CleanPair {
  CleanSurface a, b;
  StageSeconds secondsA, secondsB;
};

CleanPair cleanPair(const Mesh& a, const Mesh& b, const LayOutSettings& settings) {
  CleanPair out;
  forBoth([&] { out.a = checked(a, settings, out.secondsA); },
          [&] { out.b = checked(b, settings, out.secondsB); });
  makeAlike(a, b, settings, out.a, out.b, out.secondsA);
  makeAlike(b, a, settings, out.b, out.a, out.secondsB);
  return out;
}

SurfaceShells shellsOf(const Mesh& mesh, const CleanSurface& clean) {
  ClosedSurfaceSettings closing;
  closing.closeHoles = true;
  return closedSurfaces(clean.outer ? clean.outer->mesh : mesh, closing);
}

void requireNoHandles(const SurfaceShells& shells, const std::string& name) {
  for (const ClosedSurface& shell : shells.shells)
    if (shell.genus != 0)
      throw DataError(fmt::format(
          "{}: has {} handle{}, a sphere has none; innermap correspond maps solids with handles "
          "onto each other",
          name, shell.genus, shell.genus == 1 ? "" : "s"));
}

LaidOutMesh laidOut(Mesh mesh, CleanSurface clean, StageSeconds seconds) {
  EmbeddingSettings how;
  how.closeHoles = true;
  const EmbeddedSurface embedded = timed(seconds, "lay out", [&] {
    return EmbeddedSurface(clean.outer ? clean.outer->mesh : mesh, how);
  });
  LaidOutMesh laid(std::move(mesh), embedded);
  laid.outer = std::move(clean.outer);
  laid.notes = std::move(clean.notes);
  laid.seconds = std::move(seconds);
  if (!laid.outer)
    for (const std::string& note : laid.shells().notes)
      laid.notes.push_back(laid.mesh.name + ": " + note);
  return laid;
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

std::vector<Box3> LaidOutMesh::caps() const {
  if (outer) return outer->caps;
  const Mesh& capped = shells().mesh;
  return capBoxes(capped.vertices, capped.triangles, mesh.vertices.size(), mesh.triangles.size());
}

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

CleanSurface cleanSurface(const Mesh& mesh, const LayOutSettings& settings) {
  const Obstacle obstacle = obstacleOf(mesh);
  CleanSurface out;
  out.handles = obstacle.handles;
  if (obstacle.why.empty()) return out;
  out.outer = outerSurfaceOf(mesh, obstacle, settings);
  const SolidTopology& topology = out.outer->topology;
  out.handles.reset();
  if (topology.components == 1 && topology.cavities == 0) out.handles = topology.handles;
  out.handlesOfUnion = !settings.handles && !obstacle.handles;
  out.notes = notesOn(*out.outer, mesh.name);
  out.notes.insert(out.notes.begin(), obstacle.why);
  return out;
}

LaidOutMesh layOutMesh(Mesh mesh, const LayOutSettings& settings) {
  StageSeconds seconds;
  CleanSurface clean = checked(mesh, settings, seconds);
  return laidOut(std::move(mesh), std::move(clean), std::move(seconds));
}

std::pair<LaidOutMesh, LaidOutMesh> layOutMeshes(Mesh a, Mesh b, const LayOutSettings& settings) {
  CleanPair clean = cleanPair(a, b, settings);
  std::optional<LaidOutMesh> laidA, laidB;
  forBoth([&] { laidA = laidOut(std::move(a), std::move(clean.a), std::move(clean.secondsA)); },
          [&] { laidB = laidOut(std::move(b), std::move(clean.b), std::move(clean.secondsB)); });
  return {std::move(*laidA), std::move(*laidB)};
}

void requireLayable(const Mesh& a, const Mesh& b, const LayOutSettings& settings) {
  const CleanPair clean = cleanPair(a, b, settings);
  const SurfaceShells shellsA = shellsOf(a, clean.a), shellsB = shellsOf(b, clean.b);
  requireSameTopology(shellsA, shellsB);
}

std::uint64_t layOutMemory(std::size_t vertices) {
  return kCoarse + kBytesPerVertex * static_cast<std::uint64_t>(vertices);
}

void requireSphere(const Mesh& mesh, const LayOutSettings& settings) {
  requireNoHandles(shellsOf(mesh, cleanSurface(mesh, settings)), mesh.name);
}

MeshOnSphere onSphere(const LaidOutMesh& laid) {
  const SurfaceShells& shells = laid.shells();
  requireNoHandles(shells, laid.mesh.name);
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

std::vector<Setting> describe(LayOutSettings& s) {
  return {
      Setting("surface_resolution", "N", &s.outerResolution,
              "cells across the outer surface, which replaces a mesh that runs through itself, "
              "overlaps or is not manifold")
          .from(8, 1024)
          .otherwise(0, "80, more for thin solids")
          .rare(),
      Setting("genus", "N", &s.handles, "handles of the outer surface")
          .from(0, 1000)
          .otherwise("the mesh's own; for several pieces, those that other resolutions have too")
          .rare()};
}

}  // namespace innermap
