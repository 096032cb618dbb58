// OpenVDB files out and in.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/setting.h"

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

}  // namespace innermap
