#include "innermap/tetra/tetrahedralize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/levelset/level_set.h"
#include "lattice/fit_boundary.h"
#include "lattice/keep_topology.h"
#include "lattice/lattice_signs.h"
#include "lattice/sharp_edges.h"
#include "lattice/stuffing.h"
#include "levelset/level_set_settings.h"

namespace innermap {
namespace {

constexpr int kLeastAcross = 4, kFinestAcross = 1024;

constexpr double kMostLost = 1e-3;  // of the surface, without a warning

double spacingFor(const Solid& solid, const TetrahedralizeSettings& settings) {
  const double longest = longestSide(solid);
  if (settings.edge == 0) {
    requireDescribed(settings);
    return longest / settings.resolution;
  }
  const double across = longest / settings.edge;
  if (!(settings.edge > 0 && across >= kLeastAcross * (1 - 1e-9) &&
        across <= kFinestAcross * (1 + 1e-9)))
    throw SettingError("edge", fmt::format("must lie between {:.4g} and {:.4g} world units, {} to "
                                           "{} cells along the longest side",
                                           longest / kFinestAcross, longest / kLeastAcross,
                                           kLeastAcross, kFinestAcross));
  return settings.edge;
}

// OpenVDB's voxels cannot be as small as these: the same solid a thousand units across.
Tetrahedralization tetrahedralizeScaled(const Solid& solid, double spacing,
                                        TetrahedralizeSettings settings) {
  const double scale = 1000 / longestSide(solid);
  const Vec3 centre = solid.box().center();
  Mesh mesh;
  mesh.name = solid.repaired().mesh.name;
  mesh.triangles = solid.repaired().mesh.triangles;
  for (const Vec3& v : solid.repaired().mesh.vertices)
    mesh.vertices.push_back(scale * (v - centre));
  settings.edge = scale * spacing;
  Tetrahedralization result = tetrahedralization(Solid(mesh), settings);
  result.edge /= scale;
  result.sharpRms /= scale;
  result.sharpMax /= scale;
  for (Vec3& v : result.mesh.vertices) v = centre + v / scale;
  return result;
}

std::uint64_t memoryFor(const Solid& solid, double spacing) {
  return stuffingNeed(solid, spacing).memory;
}

void requireMemoryFor(const Solid& solid, double spacing) {
  if (!limitsMemory()) return;
  const std::uint64_t limit = memoryLimit();
  const std::uint64_t need = memoryFor(solid, spacing);
  if (need <= limit) return;
  double fits = spacing;
  while (memoryFor(solid, fits) > limit && longestSide(solid) / fits > kLeastAcross) fits *= 1.02;
  requireMemory("tetrahedra of " + solid.repaired().mesh.name, need,
                fmt::format("a resolution of {:.0f} (an edge of {:.4g}) would fit",
                            std::floor(longestSide(solid) / fits), fits));
}

[[noreturn]] void refuse(const Solid& solid, const SolidTopology& wanted,
                         const SolidTopology& found, double spacing) {
  const double across = longestSide(solid) / spacing;
  std::string advice =
      "no resolution up to " + std::to_string(kFinestAcross) + " that fits would do";
  for (const double factor : {1.25, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0}) {
    const double finer = std::ceil(across * factor);
    const double step = longestSide(solid) / finer;
    if (finer > kFinestAcross || memoryFor(solid, step) > memoryLimit()) break;
    LatticeSigns signs = latticeSigns(solid, step);
    if (!keepTopology(solid, &wanted, signs).kept) continue;
    advice = fmt::format("a resolution of {:.0f} would do", finer);
    break;
  }
  throw DataError(fmt::format(
      "{}: tetrahedra at a resolution of {:.0f} would have {} where the solid has {}; {}",
      solid.repaired().mesh.name, across, describe(found), describe(wanted), advice));
}

// Sides of the nodes, with the solid's topology, or what is to be said.
LatticeSigns signsOf(const Solid& solid, double spacing, const TetrahedralizeSettings& settings,
                     Tetrahedralization& result) {
  const SurfaceTopology surface = surfaceTopology(solid);
  if (surface.clean) result.solidTopology = surface.solid;
  LatticeSigns signs = latticeSigns(solid, spacing);
  const KeptTopology kept = keepTopology(solid, surface.clean ? &surface.solid : nullptr, signs);
  result.topology = kept.found;
  result.changedNodes = kept.changed;
  if (kept.lost > kMostLost * static_cast<double>(kept.points))
    result.warnings.push_back(fmt::format(
        "{:.2g}% of the surface is farther than a cell from all tetrahedra, on parts too thin for "
        "this lattice: use a higher resolution",
        100.0 * static_cast<double>(kept.lost) / static_cast<double>(kept.points)));
  if (surface.clean && !kept.kept) {
    if (settings.keepTopology) refuse(solid, surface.solid, kept.found, spacing);
    result.warnings.push_back(fmt::format("the tetrahedra have {} where the solid has {}",
                                          describe(kept.found), describe(surface.solid)));
  }
  if (!surface.clean) {
    LatticeSigns finer = latticeSigns(solid, std::max(spacing / 2, kSmallestVoxel));
    const KeptTopology fine = keepTopology(solid, nullptr, finer);
    if (!(fine.found == kept.found))
      result.warnings.push_back(fmt::format(
          "the tetrahedra have {}; a lattice twice as fine has {} (the mesh's own surface is open, "
          "not manifold or overlaps, and does not tell)",
          describe(kept.found), describe(fine.found)));
  }
  return signs;
}

// What the lattice's nodes promise holds for the cells too: the boundary itself is looked at.
void checkBoundary(const Solid& solid, const StuffedMesh& mesh,
                   const TetrahedralizeSettings& settings, Tetrahedralization& result) {
  const BoundaryTopology made = boundaryTopology(mesh.vertices, boundaryOf(mesh));
  if (made.manifold() && made.solid == result.topology) return;
  const std::string what = fmt::format(
      "the tetrahedra's boundary is not that of the lattice ({}, {} non-manifold edges and {} "
      "vertices instead of {})",
      describe(made.solid), made.openEdges + made.nonManifoldEdges, made.nonManifoldVertices,
      describe(result.topology));
  if (settings.keepTopology)
    throw DataError(solid.repaired().mesh.name + ": " + what + "; use another resolution");
  result.topology = made.solid;
  result.warnings.push_back(what);
}

void keepSharpEdges(const Solid& solid, const TetrahedralizeSettings& settings, StuffedMesh& mesh,
                    Tetrahedralization& result) {
  const SharpEdges sharp = sharpEdges(solid.surface(), *settings.features);
  const SharpFit fit = fitSharpEdges(solid, sharp, result.edge, mesh);
  result.sharpCurves = fit.curves;
  result.keptCurves = fit.kept;
  result.sharpRms = fit.rms;
  result.sharpMax = fit.max;
  if (fit.curves == 0)
    result.notes.push_back(fmt::format("no edge is sharper than {:g} degrees", *settings.features));
  if (fit.kept < fit.curves)
    result.warnings.push_back(fmt::format(
        "{} of {} sharp curves have no path of the mesh's edges; a finer lattice may help",
        fit.curves - fit.kept, fit.curves));
}

}  // namespace

Tetrahedralization tetrahedralization(const Solid& solid, const TetrahedralizeSettings& settings) {
  requireDescribed(settings);
  const double spacing = spacingFor(solid, settings);
  requireMemoryFor(solid, spacing);
  if (spacing < kSmallestVoxel) return tetrahedralizeScaled(solid, spacing, settings);
  Tetrahedralization result;
  result.edge = spacing;
  LatticeSigns signs = signsOf(solid, spacing, settings, result);
  if (result.topology.components == 0)
    throw DataError(fmt::format(
        "{}: no node of the lattice is inside; use a higher resolution or a shorter edge",
        solid.repaired().mesh.name));
  if (result.changedNodes > 0)
    result.notes.push_back(
        fmt::format("{} nodes of the lattice changed sides, in walls and gaps too thin for it",
                    result.changedNodes));
  warpNodes(signs);
  StuffedMesh stuffing = stuffed(signs);
  signs = {};
  checkBoundary(solid, stuffing, settings, result);
  holdWarped(stuffing);
  fitBoundary(solid, spacing, stuffing);
  if (settings.features) keepSharpEdges(solid, settings, stuffing, result);
  result.mesh.name = solid.repaired().mesh.name;
  result.mesh.vertices = std::move(stuffing.vertices);
  result.mesh.tetrahedra = std::move(stuffing.tetrahedra);
  return result;
}

CellMesh tetrahedralize(const Solid& solid, const TetrahedralizeSettings& settings) {
  return std::move(tetrahedralization(solid, settings).mesh);
}

StuffingNeed tetrahedralizeNeed(const Solid& solid, const TetrahedralizeSettings& settings) {
  return stuffingNeed(solid, spacingFor(solid, settings));
}

std::vector<Setting> describe(TetrahedralizeSettings& s) {
  return {
      Setting("resolution", "N", &s.resolution,
              "cells of the lattice along the longest side of the mesh's box; each makes twelve "
              "tetrahedra")
          .from(kLeastAcross, kFinestAcross),
      Setting("edge", "LENGTH", &s.edge, "side of a cell of the lattice, in place of {resolution}")
          .in("world units")
          .above(0, 1e12)
          .otherwise(0, "by {resolution}")
          .rare(),
      Setting("features", "ANGLE", &s.features,
              "keep edges of the surface as edges of tetrahedra if the normals beside them differ "
              "by more than this; dihedral angles then lie between 5 and 170 degrees")
          .in("degrees")
          .from(1, 179),
      Setting("keep_topology", &s.keepTopology,
              "only warn if the solid's components, cavities and handles cannot be kept")
          .rare()};
}

}  // namespace innermap
