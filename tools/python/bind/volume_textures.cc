// Volume textures in EXR files, out and in.

#include "bind/errors.h"
#include "bind/grids.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "bind/volumes.h"
#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

std::pair<int, int> tilesFrom(const py::object& object) {
  const auto [columns, rows] = pairFrom(object, "tiles");
  if (!(columns >= 1 && columns <= 65536 && rows >= 1 && rows <= 65536))
    wrongValue("tiles", "expects (columns, rows)");
  return {static_cast<int>(columns), static_cast<int>(rows)};
}

struct TextureWriteOptions {
  VolumeTextureSettings texture;
  py::object names, tiles;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(texture));
    k.object("names", &names, "str or Sequence[str]", "of the grids; all if not given");
    k.flag("rows_up", &texture.rowsUp, "the first row of a slice has the largest index");
    k.object("tiles", &tiles, "tuple[int, int]",
             "columns and rows of the atlas; near a square if not given");
    call.describe(k);
  }
};

py::object writeVolumeTexture(const Arguments& a, TextureWriteOptions& o) {
  const std::string path = pathFrom(a[0], "path");
  const openvdb::GridPtrVec grids = takeGrids(a[1], "grids", textsFrom(o.names, "names"), o.call);
  if (!o.tiles.is_none()) o.texture.tiles = tilesFrom(o.tiles);
  const VolumeTextureResult made =
      call(o.call, [&]() { return writeVolumeTexture(path, grids, o.texture); });
  return py::dict("format"_a = made.format, "files"_a = made.files, "channels"_a = made.channels,
                  "width"_a = made.width, "height"_a = made.height,
                  "tiles"_a = py::make_tuple(made.tileColumns, made.tileRows),
                  "slices"_a = made.slices,
                  "resolution"_a =
                      py::make_tuple(made.resolution.x(), made.resolution.y(), made.resolution.z()),
                  "clamped"_a = made.clamped, "rounded"_a = made.inexact);
}

struct TextureReadOptions {
  VolumeTextureReadSettings texture;
  py::object names, tiles, lowerCorner;
  CallOptions call;

  void describe(Keywords& k) {
    k.object(
        "names", &names, "str or Sequence[str]",
        "of the grids to read; of a file that does not say what its channels are, their names");
    k.settings(innermap::describe(texture));
    k.object("tiles", &tiles, "tuple[int, int]",
             "columns and rows of an atlas; from the file if not given");
    k.flag("rows_up", &texture.rowsUp, "see write_volume_texture(); from the file if not given");
    k.object("lower_corner", &lowerCorner, "array (3,)",
             "of the box, world units, with voxel_size; 0, 0, 0 if not given");
    call.describe(k);
  }
};

py::object read(const Arguments& a, TextureReadOptions& o) {
  const std::string path = pathFrom(a[0], "path");
  VolumeTextureReadSettings& s = o.texture;
  s.names = textsFrom(o.names, "names");
  if (!o.tiles.is_none()) s.tiles = tilesFrom(o.tiles);
  if (!o.lowerCorner.is_none()) {
    if (!s.voxelSize) wrongValue("lower_corner", "has a meaning with voxel_size only");
    const std::vector<double> corner = numbersFrom(o.lowerCorner, "lower_corner");
    if (corner.size() != 3) wrongValue("lower_corner", "expects three numbers");
    s.lowerCorner = {corner[0], corner[1], corner[2]};
  }
  VolumeTextureContents contents = call(o.call, [&]() { return readVolumeTexture(path, s); });
  py::dict totals;
  totals["format"] = contents.format;
  if (contents.format == volumeFormats().front().name)
    totals["layout"] = volumeLayoutName(contents.layout);
  totals["not_finite"] = contents.notFinite;
  return gridsObject(std::move(contents.grids), totals, o.call);
}

}  // namespace

void bindVolumeTextures(py::module_& m) {
  define<TextureWriteOptions>(
      m,
      {"write_volume_texture", "path, grids",
       "Writes grids for other programs, in the format of the path's ending: a volume texture for "
       "engines, dense voxels in EXR pictures whose attributes say what they are, which "
       "read_volume_texture() and `innermap import` read; or .nvdb, .vti, .dds, .nii. grids: an "
       "innermap.Grids or the path of a .vdb file. Returns files, channels, tiles and sizes. "
       "Raises FileError, DataError, MemoryError."},
      writeVolumeTexture);
  define<TextureReadOptions>(
      m,
      {"read_volume_texture", "path",
       "Reads a volume texture, or a scan in .nii or .nii.gz: an innermap.Grids. Of slices, path "
       "is any of the files or a "
       "pattern "
       "with #### or %04d. For textures of other programs, keywords say what the file does not. "
       "Raises FileError, MemoryError."},
      read);
}

}  // namespace innermap::python
