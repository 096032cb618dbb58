#include "levelset/offset_surface.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <memory>

#include "core/disjoint_sets.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "levelset/detail/band.h"
#include "levelset/detail/displaced_surface.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;

constexpr double kFinest = 1.0 / 400, kCoarsest = 1.0 / 16;  // voxels, fractions of the diagonal
constexpr double kPiece = 1.0 / 150;  // triangles that are moved without a grid
constexpr double kTolerance = 0.05;   // of the distance, for vertices that stay

// Half the width of the band, in voxels: both ends of every lattice edge that the isosurface cuts
// are within one voxel of it.
constexpr double kBand = 1.25;

// Distance minus `level`, in voxels, exact in the band; index space is band's lattice.
FloatGrid::Ptr distanceGrid(const Band& band, double level, double voxelSize) {
  constexpr float kBackground = static_cast<float>(kBand);
  const std::vector<Coord> origins = band.leaves();
  std::vector<std::unique_ptr<Leaf>> leaves(origins.size());
  parallelBlocks(
      origins.size(), 16,
      [&](std::size_t begin, std::size_t end) {
        std::array<double, Band::kLeafVoxels> distances;
        for (std::size_t l = begin; l < end; ++l) {
          band.distances(origins[l], distances.data());
          auto leaf = std::make_unique<Leaf>(origins[l], kBackground, false);
          bool any = false;
          for (openvdb::Index i = 0; i < leaf->SIZE; ++i) {
            const double value = (distances[i] - level) / voxelSize;
            const float clamped = static_cast<float>(std::clamp(value, -kBand, kBand));
            const bool active = std::abs(clamped) < kBackground;
            leaf->setValueOnly(i, clamped);
            leaf->setActiveState(i, active);
            any |= active;
          }
          if (any) leaves[l] = std::move(leaf);
        }
      },
      "offset surface");
  auto grid = FloatGrid::create(kBackground);
  for (auto& leaf : leaves) {
    if (leaf) grid->tree().addLeaf(leaf.release());
  }
  openvdb::tools::signedFloodFill(grid->tree(), true, 1, 1);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

// In world units. The grid's own coordinates are small: the extractor works in single precision.
Mesh isosurface(const FloatGrid& grid, const Vec3& origin, double voxelSize) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, 0.0, 0.0);
  Mesh mesh;
  mesh.vertices.reserve(points.size());
  for (const openvdb::Vec3s& p : points) {
    mesh.vertices.push_back(origin + voxelSize * Vec3{p[0], p[1], p[2]});
  }
  // The extractor winds polygons clockwise seen from outside.
  const auto add = [&](openvdb::Index a, openvdb::Index b, openvdb::Index c) {
    mesh.triangles.push_back({static_cast<int>(a), static_cast<int>(c), static_cast<int>(b)});
  };
  mesh.triangles.reserve(triangles.size() + 2 * quads.size());
  for (const openvdb::Vec3I& t : triangles) add(t[0], t[1], t[2]);
  for (const openvdb::Vec4I& q : quads) {
    add(q[0], q[1], q[2]);
    add(q[0], q[2], q[3]);
  }
  return mesh;
}

Mesh fromGrid(const Solid& solid, double distance) {
  const double diagonal = solid.diagonal();
  const double voxelSize =
      std::min(distance, std::clamp(0.5 * distance, kFinest * diagonal, kCoarsest * diagonal));
  // Odd shifts: with round ones, lattice points would lie on the isosurface of boxes and other
  // symmetric shapes, and rounding would decide its topology.
  const double reach = distance + 4 * voxelSize;
  const Vec3 origin =
      solid.box().lower - Vec3{reach, reach, reach} - voxelSize * Vec3{0.3717, 0.4142, 0.2929};
  const double width = kBand * voxelSize;
  const Band band(solid.body(), origin, voxelSize, std::max(0.0, distance - width),
                  distance + width);
  const FloatGrid::Ptr grid = distanceGrid(band, distance, voxelSize);
  throwIfCancelled();
  return isosurface(*grid, origin, voxelSize);
}

// Vertices outside the solid. Two neighbours are on the same side when the balls about them that
// are free of surface meet; one winding number settles each set of vertices so connected.
std::vector<char> outsideVertices(const Solid& solid, const Mesh& mesh,
                                  const std::vector<char>& atDistance, double distance) {
  DisjointSets sets(mesh.vertices.size());
  const double reach = 2 * ((1 - kTolerance) * distance - solid.gap());
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (!atDistance[a] || !atDistance[b]) continue;
      if (norm(mesh.vertices[a] - mesh.vertices[b]) < reach) sets.unite(a, b);
    }
  }
  const std::vector<int> root = sets.representatives();
  std::vector<int> roots;
  for (std::size_t v = 0; v < root.size(); ++v) {
    if (atDistance[v] && root[v] == static_cast<int>(v)) roots.push_back(root[v]);
  }
  std::vector<char> outside(root.size(), 0);
  parallelBlocks(roots.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      outside[roots[i]] = !solid.inside(mesh.vertices[roots[i]]);
    }
  });
  for (std::size_t v = 0; v < root.size(); ++v) {
    if (atDistance[v]) outside[v] = outside[root[v]];
  }
  return outside;
}

}  // namespace

Mesh offsetSurface(const Solid& solid, const OffsetSettings& settings) {
  if (!(settings.distance >= 1e-4 && settings.distance <= 2)) {
    throw SettingError("distance",
                       fmt::format("must lie between 0.0001 and 2 (fraction of the diagonal), not "
                                   "{:.3g}; where it follows from the spacing of the charges, the "
                                   "solid is too thin or its parts too far apart for so many: give "
                                   "a distance, or fewer charges, or each part by itself",
                                   settings.distance));
  }
  const double distance = settings.distance * solid.diagonal();
  Mesh mesh = settings.distance >= kFinest
                  ? fromGrid(solid, distance)
                  : displacedSurface(solid, distance, kPiece * solid.diagonal());
  std::vector<char> atDistance(mesh.vertices.size(), 0);
  parallelBlocks(
      atDistance.size(), 128,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          atDistance[v] =
              moveToDistance(solid, distance, mesh.vertices[v]) <= kTolerance * distance;
        }
      },
      "offset surface");
  const std::vector<char> good = outsideVertices(solid, mesh, atDistance, distance);
  Mesh result;
  result.name = solid.surface().name + " at a distance";
  std::vector<int> moved(good.size(), -1);
  for (const Triangle& t : mesh.triangles) {
    if (!good[t[0]] || !good[t[1]] || !good[t[2]]) continue;
    Triangle kept{};
    for (int k = 0; k < 3; ++k) {
      int& v = moved[t[k]];
      if (v < 0) {
        v = static_cast<int>(result.vertices.size());
        result.vertices.push_back(mesh.vertices[t[k]]);
      }
      kept[k] = v;
    }
    result.triangles.push_back(kept);
  }
  return result;
}

bool isNearer(const Solid& solid, const Vec3& p, double than) {
  return solid.body().tree().hasCloser(p, than);
}

double moveToDistance(const Solid& solid, double distance, Vec3& p, double enough,
                      const Worthwhile& worthwhile) {
  Vec3 best = p;
  double bestError = std::numeric_limits<double>::infinity();
  // Most points are near the distance already: a bound makes the search cheaper.
  Solid::Closest c = solid.closest(p, 1.2 * distance);
  if (c.onSurface.triangle < 0) c = solid.closest(p, std::numeric_limits<double>::infinity());
  for (int step = 0; step < 8; ++step) {
    const double error = std::abs(c.distance - distance);
    if (error < bestError) {
      best = p;
      bestError = error;
    }
    if (error <= 1e-9 * distance || !(c.distance > 0)) break;
    p = c.position + (distance / c.distance) * (p - c.position);
    if (worthwhile && !worthwhile(p, c)) return std::numeric_limits<double>::infinity();
    // The ball about p lies in the one that was free: nothing is nearer than c.position.
    if (c.distance > distance) return 0;
    // c.position is at the distance, so only what is nearer is left to look for.
    c = solid.closest(p, (1 - enough) * distance);
    if (c.onSurface.triangle < 0) return enough * distance;
  }
  p = best;
  return bestError;
}

}  // namespace innermap
