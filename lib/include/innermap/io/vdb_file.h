// OpenVDB files out and in.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {

// What the grids are called in the file. innermap's own names (surface, density, map, jacobian,
// harmonic_energy, deformation_energy, Cd, uv, velocity) are those of Houdini or Blender wherever
// those have one: the colour is `color` in Blender and Cycles and `Cd` otherwise, the velocity `v`
// in Houdini and `velocity` otherwise.
enum class NamingScheme { innermap, blender, houdini };
Setting namesSetting(NamingScheme* names);

// The name that the scheme has for one of innermap's own; other names stay.
std::string gridName(const std::string& own, NamingScheme scheme);

enum class VdbCompression { none, zip, blosc };  // OpenVDB drops zip for level sets and fog

struct VdbWriteSettings {
  NamingScheme names = NamingScheme::innermap;
  VdbCompression compression = VdbCompression::blosc;  // beside the active mask's compression
};

// Writes the grids, which are not changed, with statistics metadata (active voxels, box, memory),
// the creator, and offsets, so that single grids can be read. The file appears whole or not at all.
// Throws FileError; DataError when two grids have the same name or one has none (programs then pick
// any of them, or show nothing) or one longer than the 63 characters that Blender takes; Cancelled.
void writeVdb(const std::string& path, const openvdb::GridPtrVec& grids,
              const openvdb::MetaMap& fileMetadata = {}, const VdbWriteSettings& settings = {});

struct VdbReadSettings {
  std::vector<std::string> names;  // of the grids to read; empty means all
};

struct VdbContents {
  openvdb::GridPtrVec grids;  // in the file's order
  openvdb::MetaMap metadata;  // the file's own
};

// Reads grids of any value type that OpenVDB has in its standard tree (float, double, int32, int64,
// bool, vec3s, vec3d, vec3i, mask), by innermap's or any other program. Files are not trusted: the
// structure is walked through and checked against the file's size before OpenVDB reads it, so a
// truncated or damaged file costs neither memory nor a crash. Delayed loading is off.
// Throws FileError (a missing grid: listing those that are there), MemoryError, Cancelled.
VdbContents readVdb(const std::string& path, const VdbReadSettings& settings = {});

// What a file says about one of its grids, without reading its voxels.
struct VdbGridInfo {
  std::string name;
  std::string type;             // "float", "vec3s", ...; with " (half)" when saved as half floats
  std::string gridClass;        // "level set", "fog volume", "staggered", "unknown"
  std::uint64_t bytes = 0;      // in the file
  std::uint64_t memory = 0;     // that reading it takes, bytes
  openvdb::GridBase::Ptr grid;  // empty but for its metadata and transform
};

struct VdbInfo {
  std::vector<VdbGridInfo> grids;
  openvdb::MetaMap metadata;
  std::string version;  // "10.0/224"
};

// Without reading voxels; throws as readVdb does.
VdbInfo readVdbInfo(const std::string& path);

// What the file at `path` holds, for a terminal: a few lines a grid, with or without its metadata;
// what all grids say alike stands once, after them.
std::string describe(const VdbInfo& info, const std::string& path, bool metadata = false);

// Bytes that reading the grids of these names takes; empty means all.
std::uint64_t readMemory(const VdbInfo& info, const std::vector<std::string>& names = {});

// Grids in other axes and units (mesh/mesh_file.h): each becomes one of the same voxels and values
// on a turned lattice, whose axes stay along the world's where they were. Distances of level sets
// are scaled, positions moved, other vectors turned by their vector type. Throws DataError for
// frustums, and for staggered grids that would be turned; Cancelled.
void moveGrids(openvdb::GridPtrVec& grids, const Similarity& by);
// Into their metadata, of output: innermap_up ("y", "z"), innermap_metres_per_unit (double).
void sayInGrids(const openvdb::GridPtrVec& grids, const SpaceSettings& space);

// A .usda file that refers to .vdb files, which stay where they are.

struct UsdFrame {
  std::optional<std::int64_t> number;  // the time; none of a file that stands at all times
  std::string path;                    // of the .vdb file
};

struct UsdVolumeSettings {
  std::vector<std::string> names;  // of the grids; empty means all
  // What the file says is up, and a unit: output's. Where that is not input's, the grids' own, the
  // prim has a transform.
  SpaceSettings space;
  double framesPerSecond = 24;  // above 0
};

// The last alone.
std::vector<Setting> describe(UsdVolumeSettings& settings);

// Writes a Volume prim named as the file, with an OpenVDBAsset for each grid (fieldName,
// fieldDataType, filePath relative to the file) and the extent by the active boxes that the grids'
// statistics say; of numbered frames, which ascend, as time samples, with the times that they begin
// and end at. Several files without numbers stand side by side: each is a Volume, named as the
// file, in an Xform. Reads headers alone. Reference: Pixar, UsdVol. The file appears whole or not
// at all. Throws FileError (a grid that is not there, a path that USD cannot refer to), DataError
// (no files), SettingError, Cancelled.
void writeUsdVolume(const std::string& path, const std::vector<UsdFrame>& frames,
                    const UsdVolumeSettings& settings = {});

}  // namespace innermap
