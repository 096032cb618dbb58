// The images of a texture, one or a set of UDIM tiles, looked up by texture coordinates.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"

namespace innermap {

// Image files, as linear colours.

// How a file's numbers are to be read. automatic: as its metadata says (sRGB, linear, Rec. 709, a
// gamma), else integers of 8 bits as sRGB and all others as linear.
enum class ColourSpace { automatic, linear, srgb };

// What stands beyond the image: the image again, its border, its mirror image, or nothing (black).
enum class Wrap { repeat, clamp, mirror, black };

// The inverse of sRGB's transfer function (IEC 61966-2-1), continued linearly beyond 1 and oddly
// below 0.
double linearFromSrgb(double encoded);

struct ImageSettings {
  ColourSpace colourSpace = ColourSpace::automatic;
};

// Linear colours, rows from the top. #height * #width * 3 floats.
struct Pixels {
  int width = 0, height = 0;
  std::vector<float> rgb;
};

struct ImageFile {
  Pixels pixels;
  std::string colourSpace;         // what the numbers were read as: "sRGB", "linear", ...
  std::string channels;            // that were taken: "R,G,B", "Y"
  std::vector<std::string> notes;  // what was left out or repaired, a line each
};

// Reads any format that OpenImageIO reads: PNG, JPEG, TIFF, EXR and HDR by what the file begins
// with, others by the ending; the first image of a file that has several. Grey images give three
// equal channels. Alpha is left out: colours are those of an opaque surface (where they are
// multiplied by alpha in the file, they are divided by it). Pixels outside an EXR file's data
// window are black. Numbers that are not finite become 0 and are noted. Throws FileError for what
// is missing, damaged or cut short, is no image, is deep or a volume, or has no colour channels (Z
// or alpha alone); MemoryError before allocating; Cancelled.
ImageFile readImage(const std::string& path, const ImageSettings& settings = {});

// Bytes that an image of this size takes with its pyramid while it is read.
std::uint64_t imageMemory(const std::string& path);

// Column and row of a UDIM tile: whole parts of u and v.
using UdimTile = std::pair<int, int>;

struct TextureImageSettings {
  ColourSpace colourSpace = ColourSpace::automatic;
  Wrap wrap = Wrap::repeat;  // of a single image
};

std::vector<Setting> describe(TextureImageSettings& settings);

// Whether the path has "<UDIM>" in it, which stands for the number of each tile.
bool isTiled(const std::string& path);

// Immutable; copies share their data; safe from any number of threads.
class TextureImages {
 public:
  // tiles: that are read when the path has "<UDIM>" in it; not used otherwise. Throws as readImage
  // does.
  TextureImages(const std::string& path, const std::vector<UdimTile>& tiles,
                const TextureImageSettings& settings = {});

  // The linear colour at uv, averaged over about the parallelogram that a and b span about it (in
  // texture coordinates): trilinear in pyramids of the images, anisotropic. Black where no tile is.
  Vec3 at(const Vec2& uv, const Vec2& a, const Vec2& b) const;

  // Of the image, or of the last tile.
  int width() const;  // pixels; 0 when there is none
  int height() const;
  const std::string& colourSpace() const;  // as in ImageFile
  const std::string& channels() const;
  std::size_t count() const;
  const std::vector<std::string>& notes() const;  // of all, with their paths before them

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// Bytes that reading takes; of UDIM tiles, the first times their number.
std::uint64_t textureImageMemory(const std::string& path, const std::vector<UdimTile>& tiles);

// The colours that stand for numbers in pictures.

// All are told apart by people who are colour-blind. redBlue: blue over pale yellow to red
// (ColorBrewer's RdYlBu turned round; Cynthia Brewer, Apache-2.0). viridis, inferno: dark to light
// (Stéfan van der Walt, Nathaniel Smith, CC0). cividis: dark blue to yellow (Nuñez, Anderton and
// Renslow, "Optimizing colormaps with consideration for color vision deficiency", 2018).
enum class Colormap { redBlue, viridis, cividis, inferno, grey };

// Names as options have them, in the enumeration's order.
const std::vector<std::pair<std::string, Colormap>>& colormapNames();

Setting colormapSetting(Colormap* colormap);

// sRGB, 0 to 1, at t in [0, 1]; beyond, that of the nearer end.
Vec3 colormapColour(Colormap map, double t);

// One picture of a cross-section: a grid's values as colours, from blue (least) to red (most)
// unless another colormap is chosen, with the colour bar, the range, the grid's name and the place
// written on it.

enum class Component { x = 0, y = 1, z = 2, length = 3 };  // of vector grids

// How values go along the colours.
// linear: in even steps. logarithmic: so are their ratios; what is not above 0 has the first
// colour. about1: ratios to 1, which has the middle colour; what is not above 0 is folded, in a
// colour that
//         is in no colormap.
// automatic: about1 for `jacobian`, if there are values from 1/4 to 4; else logarithmic where all
// values are above 0 and the largest
//         is over 100 times the least, outliers aside. linear when a range is given; folds keep
//         their colour.
enum class SectionScale { automatic, linear, logarithmic, about1 };

struct SectionSettings {
  std::string grid;  // name of the grid to show; empty: the first of jacobian, deformation_energy,
                     // harmonic_energy, map, density, surface that is there, else the first grid
  Component component = Component::length;  // ignored for scalar grids
  // A vector grid's values as linear red, green and blue, without a colour bar; by default of `Cd`
  // or `color`. The range is what is black and white, [0, 1] when unset.
  bool colour = false;
  int axis = 2;                    // 0, 1, 2: x, y, z
  double at = 0.5;                 // fraction of the active box along the axis, in [0, 1]
  std::optional<double> position;  // world coordinate along the axis; wins over `at`
  std::optional<std::pair<double, double>> range;  // of the colours; unset: from the values inside
  double outliers = 0.005;  // share of values cut off at each end when the range is unset, [0, 0.5)
  SectionScale scale = SectionScale::automatic;
  Colormap colormap = Colormap::redBlue;
  int pixels = 900;  // longer side of the section itself, in [64, 8192]
};

// Without the grid and the range.
std::vector<Setting> describe(SectionSettings& settings);
Setting scaleSetting(SectionScale* scale);

struct SectionResult {
  std::string grid;
  double position = 0;                        // world coordinate of the cut
  double least = 0, most = 0;                 // values inside the cut, all of them
  double lower = 0, upper = 0;                // the colours' range
  SectionScale scale = SectionScale::linear;  // not automatic
  int width = 0, height = 0;                  // of the picture
};

// Writes a PNG (8 bits, sRGB). The cut is interpolated between voxels, over active ones only. The
// solid is where `surface` is negative, else where `density` is over one half, else where the grid
// is active; outside it the picture is light grey. Inside, voxels that are not active are grey and
// values that are not finite black.
// The file appears whole or not at all. Throws FileError, DataError (no such grid, nothing of the
// solid in the cut), SettingError, MemoryError, Cancelled.
SectionResult writeSectionImage(const std::string& path, const openvdb::GridPtrVec& grids,
                                const SectionSettings& settings = {});

// Need of that in bytes, beside the grids. Throws as writeSectionImage does of its settings.
std::uint64_t sectionImageMemory(const openvdb::GridPtrVec& grids, const SectionSettings& settings);

// Plane cuts of grids along an axis, voxel by voxel.
//
// A slice is a layer of voxels, not interpolated: its plane goes through voxel centres. Its image
// is upright: the second of its two axes points up, so row 0 holds the largest index of it.
//   axis x: columns z, rows y      axis y: columns x, rows z      axis z: columns x, rows y

// 0, 1, 2 for "x", "y", "z" (either case); throws SettingError for other texts.
int parseAxis(const std::string& setting, const std::string& text);
char axisName(int axis);

struct SliceFrame {
  int axis = 2, columnAxis = 0, rowAxis = 1;
  openvdb::CoordBBox box;  // voxels, inclusive
  openvdb::math::Transform::ConstPtr transform;

  std::size_t columns() const { return static_cast<std::size_t>(box.dim()[columnAxis]); }
  std::size_t rows() const { return static_cast<std::size_t>(box.dim()[rowAxis]); }
  int layers() const { return box.dim()[axis]; }
  openvdb::Coord coord(std::size_t column, std::size_t row, int layer) const;
  // World position of a voxel's centre.
  Vec3 world(std::size_t column, std::size_t row, int layer) const;
  // World coordinate along the axis at the layer's middle; `layer` may lie between two.
  double position(double layer) const;
  double layerAt(double position) const;  // the other way round, for axis-aligned transforms
};

// The frame of all active voxels of the grids. Throws DataError when there is none, when the grids
// have different transforms or one that is not linear, or when the box has more than 65,536 voxels
// along a side.
SliceFrame sliceFrame(const openvdb::GridPtrVec& grids, int axis);

// `count` distinct layers, evenly spaced through the frame's box (the middles of `count` equal
// parts); all of them when there are not so many.
std::vector<int> sliceLayers(const SliceFrame& frame, int count);

// The axis along which a box of this extent is thinnest: a cut across it shows most.
int thinnestAxis(const Vec3& extent);

// The fraction along the axis of the layer nearest the middle that cuts nearly as much of the solid
// as any does. density: a fog volume with active voxels.
double fullLayer(const openvdb::FloatGrid& density, int axis);

struct SliceChannel {
  std::string name;           // "jacobian.V", "map.X", "Cd.R"
  std::vector<float> values;  // #rows * #columns, row by row
};

// Channels of a grid: one for scalars (V), three for vectors (X, Y, Z; R, G, B for `Cd` and
// `color`). Throws DataError for types that have no numbers.
std::vector<std::string> channelNames(const openvdb::GridBase& grid);

// Values of a layer. Inactive voxels are 0, but for level sets, whose inactive values tell inside
// from outside.
std::vector<SliceChannel> sliceGrid(const openvdb::GridBase& grid, const SliceFrame& frame,
                                    int layer);

// 1 where a voxel of any of the grids is active, else 0.
std::vector<float> sliceMask(const openvdb::GridPtrVec& grids, const SliceFrame& frame, int layer);

// The font of the labels in pictures.

// The font file that charts, sections and pictures of surfaces are labelled with, DejaVu Sans or
// Liberation Sans; empty where neither is installed: pictures have no labels then.
const std::string& labelFont();

}  // namespace innermap
