#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/pi.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/remesh_cells.h"
#include "tetra/detail/cell_system.h"
#include "tetra/detail/shape_pass.h"

namespace innermap {
namespace {

constexpr int kImprovedRings = 2;
constexpr double kOff = 1e-8;  // of the surface's diagonal
constexpr std::size_t kImproveBlock = 4096;

std::vector<int> poorByAngle(const std::vector<Tetrahedron>& tets, const Points& at, double least) {
  std::vector<std::vector<int>> parts((tets.size() + kImproveBlock - 1) / kImproveBlock);
  parallelBlocks(tets.size(), kImproveBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      if (!(leastSine(at, tets[t]) >= least))
        parts[begin / kImproveBlock].push_back(static_cast<int>(t));
  });
  std::vector<int> poor;
  for (const auto& part : parts) poor.insert(poor.end(), part.begin(), part.end());
  return poor;
}

std::vector<char> offSurface(const CellSystem& system, const GuideSurface& surface, double diagonal,
                             const CarriedCells& cells) {
  std::vector<char> off(system.vertices(), 0);
  for (std::size_t v = 0; v < off.size(); ++v)
    off[v] = system.onBoundary[v] && cells.onSurface[v].triangle >= 0 &&
             norm(cells.positions[v] - surface.position(cells.onSurface[v])) > kOff * diagonal;
  return off;
}

void addAround(const CellSystem& system, const std::vector<char>& marked, std::vector<int>& tets) {
  for (std::size_t v = 0; v < marked.size(); ++v)
    if (marked[v])
      for (std::size_t i = system.first[v]; i < system.first[v + 1]; ++i)
        tets.push_back(system.around[i]);
}

LocalCells localOf(const CellSystem& system, const CellPatch& patch, const std::vector<char>& off,
                   const CarriedCells& cells) {
  LocalCells local;
  std::vector<std::pair<int, int>> numbers;
  for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
    const int v = patch.vertices[i];
    numbers.emplace_back(v, static_cast<int>(i));
    local.at.push_back(cells.positions[v]);
    local.source.push_back(system.places[v]);
    local.place.push_back(cells.onSurface[v]);
    local.moving.push_back(i < patch.moving);
    local.off.push_back(off[v]);
  }
  std::sort(numbers.begin(), numbers.end());
  local.star.resize(patch.vertices.size());
  for (const int t : patch.tets) {
    Tetrahedron tet{};
    for (int k = 0; k < 4; ++k)
      tet[k] =
          std::lower_bound(numbers.begin(), numbers.end(), std::make_pair(system.tets[t][k], 0))
              ->second;
    local.add(tet, t);
  }
  return local;
}

// The mesh with what became of each patch: tetrahedra that stayed keep their order, new ones
// follow.
std::vector<int> assemble(const std::vector<CellPatch>& patches,
                          const std::vector<LocalCells>& locals, std::vector<Tetrahedron>& tets) {
  std::vector<char> gone(tets.size(), 0);
  std::vector<Tetrahedron> added;
  std::vector<int> origin, addedOrigin;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const LocalCells& local = locals[p];
    const std::size_t given = patches[p].tets.size();
    for (std::size_t t = 0; t < local.tets.size(); ++t) {
      if (t < given) {
        gone[patches[p].tets[t]] = !local.alive[t];
      } else if (local.alive[t]) {
        Tetrahedron tet{};
        for (int k = 0; k < 4; ++k) tet[k] = patches[p].vertices[local.tets[t][k]];
        added.push_back(tet);
        addedOrigin.push_back(local.origin[t]);
      }
    }
  }
  std::vector<Tetrahedron> out;
  out.reserve(tets.size() + added.size());
  for (std::size_t t = 0; t < tets.size(); ++t)
    if (!gone[t]) {
      out.push_back(tets[t]);
      origin.push_back(static_cast<int>(t));
    }
  out.insert(out.end(), added.begin(), added.end());
  origin.insert(origin.end(), addedOrigin.begin(), addedOrigin.end());
  tets = std::move(out);
  return origin;
}

void require(const CellMesh& mesh, const CarriedCells& carried,
             const ImproveCellsSettings& settings) {
  requireNumber("angle", settings.angle, {1, 30}, "degrees");
  requireNumber("passes", settings.passes, {1, 100});
  const std::size_t count = mesh.vertices.size();
  if (carried.positions.size() != count || carried.onSurface.size() != count)
    throw DataError(fmt::format("{}: {} vertices, of which {} were carried, {} with places",
                                mesh.name, count, carried.positions.size(),
                                carried.onSurface.size()));
}

}  // namespace

CellImprovement improveCells(CellMesh& mesh, const Mesh& surface, CarriedCells& carried,
                             const ImproveCellsSettings& settings) {
  require(mesh, carried, settings);
  CellImprovement out;
  ShapePassSettings passes;
  passes.least = std::sin(settings.angle * kPi / 180);
  passes.connect = settings.connect;
  passes.passes = settings.passes;
  const CellSystem system(mesh, RestShape::own);
  const GuideSurface guide(surface.vertices, surface.triangles);
  const std::vector<char> off = offSurface(system, guide, boundingBox(surface).diagonal(), carried);
  std::vector<int> seeds;
  if (mesh.hexahedra.empty()) {
    seeds = poorByAngle(mesh.tetrahedra, carried.positions, passes.least);
    out.poorBefore = out.poorAfter = seeds.size();
    if (settings.connect) addAround(system, off, seeds);
  }
  if (seeds.empty()) {
    out.origin.resize(mesh.tetrahedra.size());
    for (std::size_t t = 0; t < out.origin.size(); ++t) out.origin[t] = static_cast<int>(t);
    return out;
  }
  const std::vector<CellPatch> patches = growPatches(system, seeds, kImprovedRings, true);
  std::vector<LocalCells> locals(patches.size());
  std::vector<ShapePassResult> results(patches.size());
  parallelBlocks(
      patches.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
          locals[p] = localOf(system, patches[p], off, carried);
          results[p] = improveShapes(guide, passes, locals[p]);
        }
      },
      "improving shapes");
  for (std::size_t p = 0; p < patches.size(); ++p) {
    out.swaps += results[p].swaps;
    out.collapses += results[p].collapses;
    for (std::size_t i = 0; i < patches[p].moving; ++i) {
      carried.positions[patches[p].vertices[i]] = locals[p].at[i];
      carried.onSurface[patches[p].vertices[i]] = locals[p].place[i];
    }
  }
  out.origin = assemble(patches, locals, mesh.tetrahedra);
  out.poorAfter = poorByAngle(mesh.tetrahedra, carried.positions, passes.least).size();
  return out;
}

}  // namespace innermap
