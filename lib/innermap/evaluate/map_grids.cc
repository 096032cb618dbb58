#include "innermap/evaluate/map_grids.h"

#include <fmt/format.h>

#include <cmath>

#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

LevelSetSettings levelSetSettings(const MapGridSettings& settings) {
  LevelSetSettings out;
  out.resolution = settings.resolution;
  out.voxelSize = settings.voxelSize;
  out.maxMemory = settings.maxMemory;
  out.progress = settings.progress;
  return out;
}

EvaluateSettings evaluateSettings(const MappedSolid& mapped, const MapGridSettings& settings) {
  EvaluateSettings out;
  out.lame = settings.lame;
  out.targetVolume = mapped.boundary.target.volume;
  out.accuracy = sumAccuracy(mapped);
  out.maxMemory = settings.maxMemory;
  out.progress = settings.progress;
  return out;
}

void describe(const SolidGrids& grids, const MappedSolid& mapped, const LameConstants& lame) {
  const openvdb::GridPtrVec all = grids.all();
  describeMap(all, mapped);
  for (const openvdb::GridBase::Ptr& grid : all) {
    const auto number = [&grid](const char* key, double value) {
      grid->insertMeta(std::string("innermap_") + key, openvdb::DoubleMetadata(value));
    };
    number("harmonic_energy_total", grids.values.harmonicTotal);
    number("deformation_energy_total", grids.values.deformationTotal);
    number("jacobian_min", grids.values.jacobianMin);
    number("jacobian_max", grids.values.jacobianMax);
    number("folded_fraction", grids.values.foldedFraction);
    number("lame_lambda", lame.lambda);
    number("lame_mu", lame.mu);
  }
}

}  // namespace

openvdb::GridPtrVec SolidGrids::all() const {
  openvdb::GridPtrVec out{surface, density};
  for (const openvdb::GridBase::Ptr& grid : values.all()) out.push_back(grid);
  return out;
}

SolidGrids evaluateOnGrid(const MappedSolid& mapped, const MapGridSettings& settings) {
  const Solid& solid = mapped.solid();
  const LevelSetSettings levelSet = levelSetSettings(settings);
  SolidGrids out;
  if (!(settings.voxelSize > 0) && voxelSizeFor(solid, levelSet) == kSmallestVoxel)
    out.notes.push_back(
        fmt::format("the voxels are {} world units, the smallest that OpenVDB can hold, "
                    "not as small as --resolution asks for; scale the meshes up for more",
                    kSmallestVoxel));
  timed(out.seconds, "voxelize", [&] {
    out.surface = makeLevelSet(solid, levelSet);
    out.density = makeFog(*out.surface);
    out.warnings = checkLevelSet(*out.surface, solid).warnings;
  });
  timed(out.seconds, "evaluate", [&] {
    out.values = evaluateMap(mapped.map, solid, *out.surface, evaluateSettings(mapped, settings));
  });
  if (out.values.interiorVoxels == 0)
    throw DataError(mapped.boundary.source.mesh.name +
                    ": is thinner than the voxels everywhere, none has its centre inside; use a "
                    "higher --resolution");
  out.voxelSize = out.surface->voxelSize()[0];
  describe(out, mapped, settings.lame);
  return out;
}

std::uint64_t mapGridMemory(const Solid& solid, const MapGridSettings& settings) {
  const LevelSetSettings levelSet = levelSetSettings(settings);
  const double voxel = voxelSizeFor(solid, levelSet);
  // Leaves of 8^3 voxels are allocated whole: along the surface they reach about 6 voxels to either
  // side. 25 bytes a voxel of values, 8 of fog and masks.
  const double voxels = solid.volume() / std::pow(voxel, 3) + 12 * solid.area() / (voxel * voxel);
  return levelSetMemory(solid, levelSet) + static_cast<std::uint64_t>(33 * voxels);
}

void describeMap(const openvdb::GridPtrVec& grids, const MappedSolid& mapped) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& [key, value] : mapped.facts)
      grid->insertMeta("innermap_" + key, openvdb::StringMetadata(value));
}

}  // namespace innermap
