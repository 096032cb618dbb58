// A solid in OpenVDB grids.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Fog volumes: how much of each voxel lies inside a level set.

// Fog volume: 1 inside, 0 outside, and the voxel cell's share inside the solid along the surface.
// Named "density", class fog volume. The sum of the values times the voxel's volume is the solid's
// volume.
openvdb::FloatGrid::Ptr makeFog(const openvdb::FloatGrid& levelSet);

// That sum, world units cubed, without the memory for a grid.
double insideVolume(const openvdb::FloatGrid& levelSet);

// Share of the unit cell about a voxel centre on the negative side of the plane with signed
// distance `distance` (voxels) and gradient `normal` (unit vector): Scardovelli and Zaleski,
// "Analytical Relations Connecting Linear Interfaces and Volume Fractions in Rectangular Grids"
// (J. Comp. Phys. 2000).
double cellFraction(double distance, const Vec3& normal);

struct LevelSetSettings {
  double voxelSize = 0;  // world units; 0 means: resolution decides
  // Voxels along the longest side of the solid's box, in [4, 4096]; 0: kUsualResolution, and more
  // where the solid is thinner than these on average, as far as half of the limit on memory holds
  // them.
  int resolution = 0;
  // Of the narrow band, voxels, in [2, 100]. Three hold the skin of two voxels that grids of values
  // have outside, and one more for interpolation.
  double halfWidth = 3;
  // Centre of voxel (0, 0, 0), world units, so that several grids have one lattice (the frames of a
  // sequence), at most 1e9 voxels away from the solid; near its lower corner without.
  std::optional<Vec3> origin;
};

// Without the size of voxels and the origin.
std::vector<Setting> describe(LevelSetSettings& settings);

constexpr int kUsualResolution = 128;
constexpr int kLeastVoxels = 4, kMostVoxels = 4096;  // that may be asked for

// OpenVDB takes no transform whose determinant is below 3e-15.
constexpr double kSmallestVoxel = 1.45e-5;  // world units

// The voxel size in world units that the settings mean for this solid. A resolution that would need
// voxels below kSmallestVoxel is lowered; a solid too small even for 4 of those is a DataError.
// Throws SettingError for values out of range, or for a voxel size that would give more than 4096
// voxels across.
double voxelSizeFor(const Solid& solid, const LevelSetSettings& settings);

// What the user should know of a size that voxelSizeFor chose; empty where it is as expected.
std::string voxelSizeNote(const Solid& solid, const LevelSetSettings& settings);

// Transform of uniform scale whose index space has the solid's lower box corner near the origin
// (coordinates stay small however far away the solid is). Voxel centres are at whole indices.
openvdb::math::Transform::Ptr transformFor(const Solid& solid, double voxelSize);

// Settings with which other solids get the voxels and the lattice that these give this one: those
// of a sequence's frames from its rest pose, say. Throws as voxelSizeFor.
LevelSetSettings onLatticeOf(const Solid& solid, LevelSetSettings settings);

// Signed distance (negative inside), class level set, named "surface". Within the band the distance
// is exact (double precision, rounded to float); beyond it the constants +-halfWidth * voxelSize.
// Sign by winding number, so right for open, dirty and multi-component meshes.
// Throws MemoryError (before allocating), SettingError, Cancelled.
openvdb::FloatGrid::Ptr makeLevelSet(const Solid& solid, const LevelSetSettings& settings = {});

// Estimate of makeLevelSet's peak need in bytes: an upper bound within a factor of about two.
std::uint64_t levelSetMemory(const Solid& solid, const LevelSetSettings& settings);

// How well a level set holds its solid.
struct LevelSetCheck {
  double meshVolume = 0, gridVolume = 0;  // world units cubed
  double volumeError = 0;                 // |grid - mesh| / mesh
  double lostSurface = 0;  // share of surface points with no sign change within two voxels
  std::vector<std::string> warnings;  // over 1% volume error, over 0.1% lost surface
};
LevelSetCheck checkLevelSet(const openvdb::FloatGrid& levelSet, const Solid& solid);

// Voxels whose centre is inside.
std::uint64_t interiorVoxels(const openvdb::FloatGrid& levelSet);

// Throws DataError, saying what `name` is and which resolution would do, when there is none.
void requireInterior(std::uint64_t interiorVoxels, const Solid& solid, const std::string& name);

// The same for the level set that the settings give, before anything long is done: made only for a
// solid that is thinner than a voxel on average.
void requireInterior(const Solid& solid, const LevelSetSettings& settings);

// Attributes of the closest triangle carried onto the active voxels of `levelSet`: "uv" (Vec3f,
// third component 0) when the mesh has texture coordinates, "Cd" (Vec3f) when it has vertex
// colours. `mesh` is the mesh that `solid` was made of. Voxels whose closest point lies on a cap
// take the nearest triangle that has the attribute. Throws DataError for another mesh, Cancelled.
std::vector<openvdb::GridBase::Ptr> makeAttributeGrids(const openvdb::FloatGrid& levelSet,
                                                       const Solid& solid, const Mesh& mesh);

// Need in bytes of a level set of those settings with a fog and attributes of the mesh.
std::uint64_t voxelizeMemory(const Solid& solid, const LevelSetSettings& settings, const Mesh& mesh,
                             bool fog, bool attributes);

// How fine grids are to be, as a person says it.

struct LatticeChoice {
  std::optional<int> resolution;    // without: that of the settings it goes into
  std::optional<double> voxelSize;  // world units; in place of the resolution

  // Any settings that have both.
  template <class Settings>
  Settings in(Settings settings = {}) const {
    settings.resolution = resolution.value_or(settings.resolution);
    settings.voxelSize = voxelSize.value_or(0);
    return settings;
  }
};

// of: what the resolution is along the longest side of. usual: what is taken without it; empty:
// what LevelSetSettings say.
std::vector<Setting> describe(LatticeChoice& choice, const std::string& of = "the solid",
                              const std::string& usual = "");

}  // namespace innermap
