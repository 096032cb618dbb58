// A surface's texture continued into its solid: from texture coordinates with an image, or from
// vertex colours, to grids of colours that meet them at the surface.
//
// Charges outside the solid fit the values (fitField, iterative), so they are harmonic inside. What
// the charges miss at the surface is added there, and fades inwards within a spacing of the
// charges. See also Takayama, Sorkine, Nealen and Igarashi, "Volumetric Modeling with Diffusion
// Surfaces" (SIGGRAPH Asia 2010), which continue colours by the same equation on a mesh.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/run.h"
#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/field/fit.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// Textures as functions of texture coordinates. Images of files: io/pictures.h.

// The texture's linear colour at uv, averaged over about the parallelogram that a and b span about
// it. Called from many threads.
using TextureLookup = std::function<Vec3(const Vec2& uv, const Vec2& a, const Vec2& b)>;

// The UDIM tiles (column, row), ascending, in which triangles that have texture coordinates lie, by
// their middles: corners may lie on a tile's border. Throws DataError for a triangle outside the
// columns 0 to 9 and rows 0 to 899 that tiles can have.
std::vector<std::pair<int, int>> udimTiles(const Mesh& mesh);

// coordinates: (u, v) is continued and the image is looked up at each voxel's. imageColours: the
// image's colours are. vertexColours: the mesh's are.
enum class TextureMode { coordinates, imageColours, vertexColours };

// Coordinates jump at the seams between charts. keep: they are continued as they are, and sweep
// through the image below a seam. blend: those of each chart by themselves, and their colours are
// mixed.
enum class TextureSeams { keep, blend };

struct SolidTextureSettings {
  TextureMode mode = TextureMode::coordinates;
  TextureSeams seams = TextureSeams::keep;  // blend: with `coordinates` only
  int resolution = 0;                       // as in LevelSetSettings
  double voxelSize = 0;                     // world units, in place of the resolution when above 0
  // Number of charges, in [1, 1000000]; 0: one every two voxels of the surface, 1000 to 50000.
  std::size_t sources = 0;
  // Of vertex colours, from what the mesh has to linear ones; none: they are linear.
  std::function<double(double)> decode;
  std::uint64_t seed = 1;  // of all random points, in [0, 1e15]
};

// Without the size of voxels and the decoding.
std::vector<Setting> describe(SolidTextureSettings& settings);

// What a mesh's texture will take, known before any image is read.
struct SolidTexturePlan {
  double voxelSize = 0;  // world units
  std::size_t sources = 0;
  int pieces = 0, groups = 0;  // that the charts come in; 0 unless seams are blended
  std::uint64_t memory = 0;    // peak need in bytes, images not counted
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;

  const Mesh& mesh() const;

  struct Parts;  // the mesh, its solid and charts, and the settings
  std::shared_ptr<const Parts> parts;
};

struct TextureFit {
  std::size_t sources = 0, collocation = 0, channels = 0;
  double distance = 0;            // of the charges from the surface, fraction of the diagonal
  std::vector<double> residuals;  // rms at the collocation points before and after each iteration
  BoundaryError error;            // of the field at fresh points, in the values' units
};

// Voxels and points along seams: those within two voxels of one.
struct SeamFigures {
  int charts = 0;
  std::size_t edges = 0;
  double length = 0, lengthShare = 0;    // world units; of all edges' length
  double voxelShare = 0, areaShare = 0;  // of the inside's voxels and of the surface along seams
  BoundaryError colourDifference;        // of the texture itself between the two sides
};

struct SolidTexture {
  // "surface", "density", "Cd" (linear) and, unless from vertex colours, "uv" (u, v, 0), with the
  // settings in their metadata. Values are active inside and in a skin of two voxels, which has
  // those of the closest point of the surface.
  openvdb::FloatGrid::Ptr surface, density;
  openvdb::Vec3fGrid::Ptr colour, uv;
  double voxelSize = 0;  // world units
  std::uint64_t interiorVoxels = 0;

  TextureFit fit;
  std::optional<SeamFigures> seams;  // of a mesh with texture coordinates that are used
  // Of the grid's colours, interpolated at fresh points of the surface, to the texture's there: at
  // all, and at those along seams. Without samples where there are none.
  BoundaryError colourError, colourErrorAtSeams;
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // sample, fit, certificate, voxelize, continue, texture, figures

  openvdb::GridPtrVec grids() const;  // those that there are
};

// Makes the solid and finds its charts. Throws DataError (a mesh without what the mode needs, or
// without an inside), SettingError, Cancelled.
SolidTexturePlan planSolidTexture(Mesh mesh, const SolidTextureSettings& settings = {});

// image: linear colours by texture coordinates; not used for vertex colours. Notes, warnings and
// seconds are those beyond the plan's. The same for any number of threads. Throws DataError (no
// texture coordinates on the outer surface, coordinates beyond 100000, a solid thinner than the
// voxels everywhere), SettingError, MemoryError (before allocating), Cancelled.
SolidTexture makeSolidTexture(const SolidTexturePlan& plan, const TextureLookup& image = {});

// Both; notes, warnings and seconds of both.
SolidTexture makeSolidTexture(const Mesh& mesh, const TextureLookup& image,
                              const SolidTextureSettings& settings = {});

}  // namespace innermap
