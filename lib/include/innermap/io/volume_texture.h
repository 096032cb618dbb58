// Grids in the files of programs that read no OpenVDB: volume textures, dense boxes of voxels in
// EXR files, for engines and renderers; and the formats of volumeFormats(). Volume textures come
// back into grids, atlases, slices and parts of other programs too.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// atlas: all slices as tiles of one picture, row-major from the top left, first slice first.
// slices: a file a slice. parts: one file, a part a slice.
enum class VolumeLayout { atlas, slices, parts };

// "atlas", "slices", "parts"; throws SettingError for other texts.
VolumeLayout parseVolumeLayout(const std::string& setting, const std::string& text);
std::string volumeLayoutName(VolumeLayout layout);

// automatic: as rgba where the channels are four at most, else as layers.
// rgba: one scalar is Y (grey); two are R, G; three or a vector R, G, B; a vector and a scalar, in
//        any order, R, G, B and A; else scalars are R, G, B, A in order.
// layers: those of slice.h: density.V, map.X, Cd.R.
enum class VolumeChannels { automatic, rgba, layers };

struct VolumeTextureSettings {
  VolumeLayout layout = VolumeLayout::atlas;
  int axis = 2;         // across the slices: 0, 1, 2 for x, y, z; columns and rows as in slice.h
  bool rowsUp = false;  // whether the first row of a slice has the largest index, not the least
  VolumeChannels channels = VolumeChannels::automatic;
  bool half = false;    // half floats: 3 digits, values clamped to 65,504
  bool active = false;  // also NAME.active for each grid: 1 where a voxel is active
  int pad = 0;          // voxels of the grids about their active box, in [0, 4096]
  bool cube = false;    // the box grows to a cube about its middle
  int resolution = 0;   // voxels along the longest side, resampled, in [1, 8192]; 0: the grids'
  bool powerOfTwo =
      false;  // the box grows: slices, their sides and the picture's are powers of two
  std::optional<std::pair<int, int>> tiles;  // columns and rows of the atlas; unset: near a square
  bool zip = false;                          // of NanoVDB files: zlib, which not all readers have
};

// Without the order of rows and the tiles.
std::vector<Setting> describe(VolumeTextureSettings& settings);

// A kind of file that grids are written to; which one, the ending of its name says.
struct VolumeFormat {
  std::string ending;  // ".exr"
  std::string name;    // of the format: "EXR"
  std::string holds;   // what becomes of grids in it, a line
  // Those of VolumeTextureSettings that it heeds, by the names in describe(); "rows" and "tiles".
  std::vector<std::string> settings;
  bool refers = false;  // to .vdb files, by writeUsdVolume (vdb_file.h), instead of holding voxels
};

// All of them; the first is that of paths with any other ending.
const std::vector<VolumeFormat>& volumeFormats();
const VolumeFormat& volumeFormatOf(const std::string& path);

struct VolumeTextureResult {
  std::string format;              // VolumeFormat::name
  std::vector<std::string> files;  // one, or one a slice
  std::vector<std::string>
      channels;  // in the order of the grids; else the names of what is written
  // Of EXR alone, 0 of other formats:
  int width = 0, height = 0;  // of a picture, pixels
  int tileColumns = 1, tileRows = 1;
  int slices = 0, tileWidth = 0, tileHeight = 0;
  openvdb::Coord resolution;  // voxels of the dense box along x, y, z; 0 where there is none
  openvdb::BBoxd worldBox;
  std::size_t clamped = 0;  // values beyond the pixel type's largest number
  std::size_t inexact = 0;  // whole numbers that the pixel type does not have
};

// The dense box is the common active box of all grids (with pad, cube, resolution, powerOfTwo
// applied in this order); voxels that are not active have the grid's background, inside a level set
// minus that. Empty tiles at the end of an atlas have the background too. With `resolution`, float
// and vector values are interpolated linearly, as the mean over the new voxel when that is larger,
// whole numbers and truth values are the nearest voxel's.
// Scanline files, ZIP compression (lossless), one data window. The attributes of each part (see
// volume_attributes.h) tell layout, tiles, order, box, matrices and what the grids are.
//
// slices: `path` has the number's place as #### or %04d in its last component, else .0000 is put
// before the extension; numbers start at 0. All files appear whole or none does.
//
// Paths with the ending of another format than EXR get that:
//
// .nvdb: NanoVDB 32 as its headers write it, a segment a grid, sparse as the grids are: voxels,
//        tiles, active states, names, classes and transforms. float and double become float (with
//        `half` Fp16: 16 bits that span the values of each leaf, within 1/65,535 of that span;
//        class and background stay), vectors Vec3f, int32, int64, bool and masks themselves.
//        Reference: nanovdb/NanoVDB.h, nanovdb/util/IO.h of OpenVDB 10.
// .vti:  VTK's XML ImageData, appended raw: the dense box, voxel centres as points, an array a grid
//        in the grid's own numbers (truth values as UInt8); Origin, Spacing and Direction are the
//        grids' transform, sheared ones too. Reference: "VTK File Formats", XML.
// .dds:  a volume texture with the DX10 header, no smaller levels: R, RG or RGBA of 32-bit or half
//        floats, channels as VolumeChannels::rgba names them; three channels get alpha 1, and
//        slices, rows and columns are those of EXR. Reference: Microsoft, "DDS_HEADER_DXT10".
// .nii, .nii.gz: NIfTI-1 of one grid, the dense box in the grid's own numbers (truth values as
//        UInt8), sform and, where the axes are at right angles, qform: world units are millimetres
//        of NIfTI's world, x to the right, y to the front, z up (RAS). Vectors have five dimensions
//        and NIFTI_INTENT_VECTOR, components as they are. Reference: nifti1.h.
//
// Throws DataError (no grids, no active voxel, different transforms, a type without numbers, too
// many voxels), SettingError (also for one that the format does not heed and that is not its
// default), MemoryError (before allocating), FileError, Cancelled.
VolumeTextureResult writeVolumeTexture(const std::string& path, const openvdb::GridPtrVec& grids,
                                       const VolumeTextureSettings& settings = {});

// A displacement field that ANTs, ITK and Slicer read as a transform: a NIfTI file, packed where it
// ends in .gz, whose voxels lie as writeVolumeTexture() lays them (RAS) and whose vectors are
// ITK's: x to the left, y to the back, z up (LPS). To resample images of a map's source into the
// target's space they take the displacement from there back (see backwardDisplacement()). 0 where
// the grid is not active. Throws as writeVolumeTexture().
VolumeTextureResult writeDisplacementField(const std::string& path,
                                           const openvdb::Vec3SGrid& displacement);

// What a file says of itself as a volume texture.
struct VolumeTextureInfo {
  std::string layout;   // "atlas", "slices", "parts"
  int axis = 2;         // across the slices: 0, 1, 2 for x, y, z
  bool rowsUp = false;  // see VolumeTextureSettings
  int tileColumns = 1, tileRows = 1, tileWidth = 0, tileHeight = 0, slices = 0;
  openvdb::Coord resolution;          // voxels of the dense box along x, y, z
  openvdb::Vec3d voxelSize{0, 0, 0};  // world units
  openvdb::BBoxd worldBox;            // by outer faces
  struct Grid {
    std::string name, type, gridClass;
    std::vector<std::string> channels;
  };
  std::vector<Grid> grids;
};

// From the attributes alone, without pixels. Nothing when the file has none of a volume texture, or
// not all that are needed. Throws FileError.
std::optional<VolumeTextureInfo> readVolumeTextureInfo(const std::string& path);

// What a file of the other formats says of itself, without its values: of .nvdb and .usda all
// grids, of .vti, .nii and .nii.gz what stands in the header, of .dds all that there is, a size and
// a type.
struct VolumeFileInfo {
  struct Grid {
    std::string name, type;                     // as the file names it; "" where it does not
    std::string gridClass;                      // "level set" and so on; "" where it is not said
    openvdb::Coord resolution;                  // voxels of the (active) box; 0: not said
    std::optional<std::uint64_t> activeVoxels;  // where they are counted
    std::optional<openvdb::Vec3d> voxelSize;    // world units
    std::optional<openvdb::BBoxd> worldBox;     // by outer faces
    std::vector<std::string> files;             // that a .usda file refers to, as it does
  };
  std::string format;  // VolumeFormat::name
  std::vector<Grid> grids;
  std::vector<std::pair<std::string, std::string>> facts;  // of the whole file
};

// By the ending, of all but .exr. Throws FileError for what is no such file, or cut short.
VolumeFileInfo readVolumeFileInfo(const std::string& path);
std::string describe(const VolumeFileInfo& info, const std::string& path);

// For a terminal: a few indented lines.
std::string describe(const VolumeTextureInfo& info);

// For a terminal: two lines that say what was written.
std::string describe(const VolumeTextureResult& result, const std::string& path,
                     const VolumeTextureSettings& settings);

// What makes the texture doubtful: values that do not fit the pixels, pictures beyond 16,384 pixels
// a side, which engines do not take.
std::vector<std::string> warningsOf(const VolumeTextureResult& result, const std::string& path,
                                    const VolumeTextureSettings& settings);

// What writeVolumeTexture would write: its result but for the counts. Throws as that does.
VolumeTextureResult planVolumeTexture(const std::string& path, const openvdb::GridPtrVec& grids,
                                      const VolumeTextureSettings& settings = {});

// Peak need of writeVolumeTexture beside the grids, bytes.
std::uint64_t volumeTextureMemory(const std::string& path, const openvdb::GridPtrVec& grids,
                                  const VolumeTextureSettings& settings = {});

// What the file's attributes do not say, or what counts in their place. The messages of errors call
// the settings by the options of `innermap import`: --tiles, --voxel-size and so on.
struct VolumeTextureReadSettings {
  // Of a file that says what its grids are: those to read, empty for all. Else the names of its
  // grids: one for each (R, G, B together and X, Y, Z of one layer are a vector, others scalars),
  // vectors before scalars, or one for each channel in the file's order.
  std::vector<std::string> names;
  std::optional<VolumeLayout> layout;
  std::optional<std::pair<int, int>> tiles;  // columns and rows of an atlas
  std::optional<int> slices;                 // without, all tiles
  std::optional<int> axis;                   // across the slices, 0, 1, 2; without, z
  std::optional<bool> rowsUp;                // see VolumeTextureSettings; without, false
  std::optional<double> voxelSize;           // world units
  Vec3 lowerCorner;                      // world position of the box's least corner, with voxelSize
  std::optional<double> background;      // of all grids
  std::optional<std::string> gridClass;  // "level set", "fog volume", "unknown", ...
  bool asVoxels = false;  // of NIfTI files: along x, y, z from the origin, whatever they say
};

// Without names, tiles, the order of rows, the lower corner and the class.
std::vector<Setting> describe(VolumeTextureReadSettings& settings);

struct VolumeTextureContents {
  std::string format;  // VolumeFormat::name
  openvdb::GridPtrVec grids;
  VolumeLayout layout = VolumeLayout::atlas;
  openvdb::Coord resolution;  // of the dense box
  std::size_t notFinite = 0;  // values that are infinite or no numbers
};

// `path`: an atlas or a file of parts; for slices a pattern (#### or %04d) or any of the files.
// Grids have the type, name, class, background, vector type and transform that the attributes say.
// A voxel is active where NAME.active says so or, without that channel, where its value is not the
// background as the pixel type holds that; in level sets, not plus or minus that. What is not
// active has the background exactly; uniform blocks of 8^3 voxels become tiles.
//
// NIfTI files (.nii, .nii.gz; NIfTI-1 and NIfTI-2 in one file, either byte order) give one grid,
// named by `names`, else by the file's intent name or its own; its world is the file's, by sform,
// else qform, in millimetres where the file says metres or microns. Whole numbers become int32, or
// int64 where they need it, with scl_slope or scl_inter and floats become float, doubles double,
// three values a voxel vec3s, as they are in the file. Voxels of the background, 0 unless given,
// are not active. Of the settings the names, the background, the class and asVoxels count.
//
// Files are not trusted. Throws FileError for what cannot be read, for a missing attribute (naming
// the option that gives it) and for attributes that contradict one another or the pixels;
// MemoryError before allocating; SettingError; Cancelled.
VolumeTextureContents readVolumeTexture(const std::string& path,
                                        const VolumeTextureReadSettings& settings = {});

// A label of a scan and its voxels' surface.
struct LabelMesh {
  std::int64_t label = 0;  // of the first, where several are one
  std::uint64_t voxels = 0;
  Mesh mesh;
};

// The surfaces between voxels that have one of these labels and those that do not, halfway between
// their middles, in the grid's world, facing outwards: one of each label, or one of all together.
// labels: without, all but 0. grid: int32, int64, or float with whole numbers. Throws DataError for
// other grids, for a label that no voxel has (saying which there are); Cancelled.
std::vector<LabelMesh> labelMeshes(const openvdb::GridBase& grid,
                                   const std::vector<std::int64_t>& labels, bool together);

// What readVolumeTexture would read, without reading pixels. Throws as that does.
struct VolumeTextureNeed {
  openvdb::Coord resolution;
  std::uint64_t memory = 0;  // bytes, when all voxels are active; less when few are
};
VolumeTextureNeed volumeTextureReadNeed(const std::string& path,
                                        const VolumeTextureReadSettings& settings = {});

}  // namespace innermap
