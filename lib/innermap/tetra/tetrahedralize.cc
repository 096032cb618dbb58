#include "innermap/tetra/tetrahedralize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/levelset/level_set.h"
#include "innermap/tetra/detail/fit_boundary.h"
#include "innermap/tetra/detail/lattice_signs.h"
#include "innermap/tetra/detail/stuffing.h"

namespace innermap {
namespace {

constexpr int kLeastAcross = 4, kMostAcross = 1024;

double longestSide(const Solid& solid) {
  const Vec3 e = solid.box().extent();
  return std::max({e.x, e.y, e.z});
}

double spacingFor(const Solid& solid, const TetrahedralizeSettings& settings) {
  const double longest = longestSide(solid);
  if (settings.edge == 0) {
    if (settings.resolution < kLeastAcross || settings.resolution > kMostAcross)
      throw SettingError(
          "resolution", fmt::format("must lie between {} and {} cells", kLeastAcross, kMostAcross));
    return longest / settings.resolution;
  }
  const double across = longest / settings.edge;
  if (!(settings.edge > 0 && across >= kLeastAcross * (1 - 1e-9) &&
        across <= kMostAcross * (1 + 1e-9)))
    throw SettingError("edge", fmt::format("must lie between {:.4g} and {:.4g} world units, {} to "
                                           "{} cells along the longest side",
                                           longest / kMostAcross, longest / kLeastAcross,
                                           kLeastAcross, kMostAcross));
  return settings.edge;
}

// The same solid a thousand units across: OpenVDB's voxels cannot be as small as this one needs.
CellMesh tetrahedralizeScaled(const Solid& solid, double spacing, TetrahedralizeSettings settings) {
  const double scale = 1000 / longestSide(solid);
  const Vec3 centre = solid.box().center();
  Mesh mesh;
  mesh.name = solid.repaired().mesh.name;
  mesh.triangles = solid.repaired().mesh.triangles;
  for (const Vec3& v : solid.repaired().mesh.vertices)
    mesh.vertices.push_back(scale * (v - centre));
  SolidSettings solidSettings;
  solidSettings.progress = settings.progress;
  settings.edge = scale * spacing;
  CellMesh cells = tetrahedralize(Solid(mesh, solidSettings), settings);
  for (Vec3& v : cells.vertices) v = centre + v / scale;
  return cells;
}

}  // namespace

CellMesh tetrahedralize(const Solid& solid, const TetrahedralizeSettings& settings) {
  const double spacing = spacingFor(solid, settings);
  if (spacing < kSmallestVoxel) return tetrahedralizeScaled(solid, spacing, settings);
  LatticeSigns signs = latticeSigns(solid, spacing, settings.progress);
  warpNodes(signs, settings.progress);
  StuffedMesh stuffing = stuffed(signs, settings.progress);
  signs = {};
  if (stuffing.tetrahedra.empty())
    throw DataError(fmt::format(
        "{}: no node of the lattice is inside; use a higher resolution or a shorter edge",
        solid.repaired().mesh.name));
  fitBoundary(solid, spacing, stuffing, settings.progress);
  CellMesh mesh;
  mesh.name = solid.repaired().mesh.name;
  mesh.vertices = std::move(stuffing.vertices);
  mesh.tetrahedra = std::move(stuffing.tetrahedra);
  return mesh;
}

}  // namespace innermap
