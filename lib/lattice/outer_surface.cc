#include "innermap/lattice/outer_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/check.h"
#include "lattice/detail/buried_sheets.h"
#include "lattice/detail/close_tunnels.h"
#include "lattice/detail/grow_solid.h"
#include "lattice/detail/inside_distances.h"
#include "lattice/detail/lattice_topology.h"
#include "lattice/detail/simple_changes.h"
#include "lattice/detail/smooth_surface.h"
#include "lattice/detail/surface_cuts.h"
#include "lattice/detail/thin_parts.h"
#include "lattice/fit_boundary.h"
#include "lattice/stuffing.h"
#include "levelset/level_set_settings.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr int kUsualAcross = 80, kLeastAcross = 8, kMostAcross = 1024;
// Of the resolution: a handle of the solid, and not of the lattice, is there at all of them.
constexpr std::array<double, 2> kOtherResolutions = {0.8, 1.25};
constexpr std::size_t kCompared = 20000;  // points of the solid's surface
constexpr int kMostHandles = 64;          // that nobody asked for
constexpr int kUncrossings = 8;
// Bytes of a node beyond what tetrahedra take: sides, orders, queues.
constexpr double kGrownNodeBytes = 60;

// OpenVDB's voxels have a least size: a smaller solid is taken a thousand units across.
constexpr double kSmallestSide = kMostAcross * kSmallestVoxel, kEnlargedSide = 1000;

double spacingFor(const Solid& solid, const OuterSurfaceSettings& settings) {
  if (settings.resolution == 0) {
    // Thin solids get more voxels by themselves.
    const double usual = voxelSizeFor(solid, {}) * kUsualResolution / kUsualAcross;
    return std::max(usual, longestSide(solid) / kMostAcross);
  }
  requireNumber("resolution", settings.resolution, {kLeastAcross, kMostAcross}, "cells across");
  return longestSide(solid) / settings.resolution;
}

// Each node inside or outside. Thin walls are inside, narrow gaps outside as far as they are opened
// from outside without a hole in the walls beside them: a hole would be cut to the wall's rim.
LatticeSigns signsOf(const Solid& solid, double spacing) {
  LatticeSigns signs = latticeSigns(solid, spacing);
  const ThinParts thin = thinParts(solid, signs);
  for (const std::size_t node : thin.walls) signs.side[node] = NodeSide::inside;
  Sides wanted = signs.side;
  for (const std::size_t node : thin.gaps) wanted[node] = NodeSide::outside;
  fillPockets(signs.lattice, signs.side);
  changeWithoutPiercing(signs, wanted, NodeSide::outside, signs.distance);
  return signs;
}

std::vector<int> handlesOf(const LatticeSigns& signs, const SolidParts& parts) {
  LatticeSigns alone = signs;
  std::vector<int> handles;
  for (const Sides& part : parts.parts) {
    alone.side = part;
    handles.push_back(latticeTopology(alone).handles);
  }
  return handles;
}

void refuseTangles(const std::vector<int>& handles, const std::string& name) {
  const int most = *std::max_element(handles.begin(), handles.end());
  if (most > kMostHandles)
    throw DataError(fmt::format(
        "{}: its outer surface has {} handles, more than {}: the mesh crosses itself nearly "
        "everywhere; repair it, or ask for fewer (genus)",
        name, most, kMostHandles));
}

// Of each part.
std::vector<int> wantedHandles(const Solid& solid, const LatticeSigns& signs,
                               const SolidParts& parts, const OuterSurfaceSettings& settings) {
  if (settings.handles) {
    requireNumber("handles", *settings.handles, {0});
    std::vector<int> handles(parts.parts.size(), 0);
    handles[0] = *settings.handles;
    return handles;
  }
  std::vector<int> handles = handlesOf(signs, parts);
  for (const double factor : kOtherResolutions) {
    if (std::all_of(handles.begin(), handles.end(), [](int h) { return h == 0; })) break;
    const LatticeSigns other = signsOf(solid, signs.lattice.spacing() / factor);
    const SolidParts there = partsOf(other, settings.onePiece);
    if (there.parts.size() != parts.parts.size()) continue;
    const std::vector<int> found = handlesOf(other, there);
    for (std::size_t p = 0; p < handles.size(); ++p) handles[p] = std::min(handles[p], found[p]);
  }
  refuseTangles(handles, solid.repaired().mesh.name);
  return handles;
}

Sides united(const std::vector<Sides>& parts) {
  Sides all(parts.front().size(), NodeSide::outside);
  for (const Sides& part : parts)
    for (std::size_t n = 0; n < all.size(); ++n)
      if (part[n] == NodeSide::inside) all[n] = NodeSide::inside;
  return all;
}

// Sets the sides. A part that cannot be grown with its handles keeps those it has, unless they were
// asked for. order: of growingOrder().
void grow(const Solid& solid, const SolidParts& parts, const std::vector<int>& handles, bool asked,
          const std::vector<float>& order, LatticeSigns& signs) {
  std::vector<Sides> grown;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    if (!growWithHandles(signs, parts.parts[p], handles[p], order) && asked)
      throw DataError(fmt::format(
          "{}: its outer surface cannot be given {} handle{}: no part of what it encloses has that "
          "many; give another number (genus) or a finer lattice (surface resolution)",
          solid.repaired().mesh.name, handles[p], handles[p] == 1 ? "" : "s"));
    grown.push_back(signs.side);
  }
  signs.side = united(grown);
}

// Adds to the parts what closes tunnels: its nodes. signs.side: the parts'.
std::vector<std::size_t> closeTunnels(const Solid& solid, const LatticeSigns& signs,
                                      const std::vector<int>& handles,
                                      const std::vector<float>& order, SolidParts& parts) {
  std::vector<std::size_t> all;
  for (std::size_t p = 0; p < parts.parts.size(); ++p)
    for (const std::size_t n :
         tunnelsToClose(solid, signs, parts.parts[p], signs.side, handles[p], order)) {
      parts.parts[p][n] = NodeSide::inside;
      all.push_back(n);
    }
  return all;
}

std::vector<TopologyChange> changesAt(const std::vector<std::size_t>& nodes,
                                      const LatticeSigns& signs) {
  std::vector<TopologyChange> changes;
  for (const Box3& box : boxesOf(nodes, signs))
    changes.push_back({box.center(), norm(box.extent()) + signs.lattice.spacing()});
  return changes;
}

// Vertices that were moved onto the solid's surface go back where that made triangles cross, as in
// gaps narrower than a cell; where they were, none do.
void uncross(const Points& before, Mesh& mesh) {
  for (int pass = 0; pass < kUncrossings; ++pass) {
    std::vector<bool> back(mesh.vertices.size(), pass + 1 == kUncrossings);
    bool any = false;
    forEachSelfIntersection(mesh.vertices, mesh.triangles, [&](const Crossing& c) {
      any = true;
      for (const int t : {c.first, c.second})
        for (const int v : mesh.triangles[t]) back[v] = true;
    });
    if (!any) return;
    for (std::size_t v = 0; v < back.size(); ++v)
      if (back[v]) mesh.vertices[v] = before[v];
  }
}

// The lattice's boundary as a mesh.
Mesh surfaceOf(const Solid& solid, LatticeSigns& signs) {
  const double spacing = signs.lattice.spacing();
  warpNodes(signs);
  StuffedMesh stuffing = stuffed(signs);
  holdWarped(stuffing);
  const Points before(stuffing.vertices.begin() + stuffing.firstBoundary, stuffing.vertices.end());
  fitBoundary(solid, spacing, stuffing);
  Mesh mesh;
  mesh.name = solid.repaired().mesh.name;
  mesh.triangles = boundaryOf(stuffing);
  mesh.vertices.assign(stuffing.vertices.begin() + stuffing.firstBoundary, stuffing.vertices.end());
  for (Triangle& t : mesh.triangles)
    for (int& v : t) v -= stuffing.firstBoundary;
  uncross(before, mesh);
  const Points rough = mesh.vertices;
  mesh.vertices = smoothedWhereRough(solid, spacing, mesh);
  uncross(rough, mesh);
  return mesh;
}

void compare(const Solid& solid, OuterSurface& out) {
  const Mesh& surface = solid.surface();
  std::vector<double> sums{0};
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    sums.push_back(sums.back() + norm(areaVector(surface, static_cast<int>(t))));
  const TriangleTree tree(out.mesh.vertices, out.mesh.triangles);
  const CounterRandom random(1, 72);
  std::vector<double> apart(kCompared);
  parallelBlocks(
      kCompared, 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const double at =
              sums.back() * (static_cast<double>(i) + random.uniform(3 * i)) / kCompared;
          const auto above = std::upper_bound(sums.begin(), sums.end() - 1, at);
          const Triangle& t = surface.triangles[static_cast<std::size_t>(
              std::max<std::ptrdiff_t>(above - sums.begin() - 1, 0))];
          const double s = std::sqrt(random.uniform(3 * i + 1)), u = random.uniform(3 * i + 2);
          const Points& v = surface.vertices;
          apart[i] =
              tree.closest((1 - s) * v[t[0]] + s * (1 - u) * v[t[1]] + s * u * v[t[2]]).distance;
        }
      },
      "comparing the surfaces");
  std::sort(apart.begin(), apart.end());
  out.apartP99 = apart[kCompared * 99 / 100] / solid.diagonal();
  out.apartMax = apart.back() / solid.diagonal();
}

// Estimate of the peak need in bytes, beyond the solid.
std::uint64_t memoryFor(const Solid& solid, const OuterSurfaceSettings& settings) {
  const double spacing = spacingFor(solid, settings);
  const Vec3 e = solid.box().extent();
  const double nodes = 2 * (e.x / spacing + 7) * (e.y / spacing + 7) * (e.z / spacing + 7);
  return stuffingNeed(solid, spacing).memory + static_cast<std::uint64_t>(kGrownNodeBytes * nodes);
}

OuterSurface enlargedOuterSurface(const Solid& solid, const OuterSurfaceSettings& settings) {
  const double scale = kEnlargedSide / longestSide(solid);
  const Vec3 centre = solid.box().center();
  Mesh mesh = solid.repaired().mesh;
  for (Vec3& v : mesh.vertices) v = scale * (v - centre);
  OuterSurface out = outerSurface(Solid(mesh), settings);
  out.edge /= scale;
  for (Vec3& v : out.mesh.vertices) v = centre + v / scale;
  for (Box3& cap : out.caps) cap = {centre + cap.lower / scale, centre + cap.upper / scale};
  for (auto* changes : {&out.cuts, &out.plugs})
    for (TopologyChange& c : *changes) c = {centre + c.place / scale, c.size / scale};
  return out;
}

}  // namespace

OuterSurface outerSurface(const Solid& solid, const OuterSurfaceSettings& settings) {
  if (longestSide(solid) < kSmallestSide) return enlargedOuterSurface(solid, settings);
  const std::string& name = solid.repaired().mesh.name;
  OuterSurface out;
  out.edge = spacingFor(solid, settings);
  requireMemory("the outer surface of " + name, memoryFor(solid, settings),
                "a coarser lattice takes less (surface resolution)");
  LatticeSigns signs = signsOf(solid, out.edge);
  SolidParts parts = partsOf(signs, settings.onePiece);
  if (parts.parts.empty())
    throw DataError(name +
                    ": has no outer surface, all parts are thinner than a cell of the lattice; "
                    "give a finer one (surface resolution)");
  out.caps = capBoxes(solid.repaired());
  out.insideOut = solid.insideOut();
  out.leftOut = parts.leftOut;
  out.leftOutShare = parts.leftOutShare;
  const std::vector<int> handles = wantedHandles(solid, signs, parts, settings);
  signs.side = united(parts.parts);
  const std::vector<float> depth = depthsInside(signs);
  const std::vector<float> order = growingOrder(solid, signs, depth);
  const std::vector<std::size_t> plugged = closeTunnels(solid, signs, handles, order, parts);
  grow(solid, parts, handles, settings.handles.has_value(), order, signs);
  const std::vector<std::size_t> cut = cutNodes(united(parts.parts), signs);
  out.plugs = changesAt(plugged, signs);
  out.cuts = changesAt(cut, signs);
  thickenPlugs(plugged, cut, signs);
  openCuts(cut, depth, signs);
  out.mesh = surfaceOf(solid, signs);
  const BoundaryTopology made = boundaryTopology(out.mesh.vertices, out.mesh.triangles);
  out.topology = made.solid;
  if (!made.manifold() || !(made.solid == latticeTopology(signs)))
    throw DataError(name +
                    ": its outer surface is no manifold at this resolution; give another "
                    "one (surface resolution)");
  compare(solid, out);
  return out;
}

}  // namespace innermap
