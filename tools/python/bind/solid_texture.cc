// A surface's texture continued into its solid.
#include "innermap/texture/solid_texture.h"

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/grids.h"
#include "bind/keywords.h"
#include "bind/meshes.h"
#include "bind/volumes.h"
#include "innermap/io/pictures.h"
#include "jobs/texture_need.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

struct TextureOptions {
  SolidTextureSettings texture;
  TextureImageSettings images;
  py::object colours;
  LatticeChoice grid;
  CallOptions call;

  void describe(Keywords& k) {
    k.object("colours", &colours, "array (n, 3)",
             "of the vertices, in place of those of the mesh's file; without an image");
    k.settings(innermap::describe(texture));
    k.settings(innermap::describe(images));
    k.settings(innermap::describe(grid));
    call.describe(k);
  }
};

void setColours(const py::object& given, Mesh& mesh) {
  const Matrix colours = matrixFrom(given, "colours", mesh.vertices.size());
  if (colours.columns() != 3) wrongValue("colours", "expects shape (n, 3)");
  mesh.colours.resize(colours.rows());
  for (std::size_t i = 0; i < colours.rows(); ++i)
    for (std::size_t k = 0; k < 3; ++k) mesh.colours[i][k] = static_cast<float>(colours(i, k));
}

py::object texture(const Arguments& a, TextureOptions& o) {
  Mesh mesh = meshFrom(a[0], "mesh");
  const std::string image = a[1].is_none() ? "" : pathFrom(a[1], "image");
  if (!o.colours.is_none()) {
    if (!image.empty()) wrongValue("colours", "is for textures without an image");
    setColours(o.colours, mesh);
  }
  if (o.texture.seams == TextureSeams::blend &&
      (image.empty() || o.texture.mode != TextureMode::coordinates))
    wrongValue("seams", "'blend' needs an image and mode 'uv'");
  SolidTexture made = call(o.call, [&]() {
    SolidTextureSettings settings = o.texture;
    settings.resolution = o.grid.resolution.value_or(0);
    settings.voxelSize = o.grid.voxelSize.value_or(0);
    if (image.empty()) settings.mode = TextureMode::vertexColours;
    if (o.images.colourSpace == ColourSpace::srgb) settings.decode = linearFromSrgb;
    const SolidTexturePlan plan = planSolidTexture(std::move(mesh), settings);
    std::vector<UdimTile> tiles;
    if (isTiled(image)) tiles = udimTiles(plan.mesh());
    requireMemory(textureNeed(plan, image, tiles));
    TextureLookup lookup;
    if (!image.empty())
      lookup = [images = TextureImages(image, tiles, o.images)](
                   const Vec2& uv, const Vec2& u, const Vec2& v) { return images.at(uv, u, v); };
    return makeSolidTexture(plan, lookup);
  });
  py::dict totals("fit_error"_a = made.fit.error, "colour_error"_a = made.colourError,
                  "sources"_a = made.fit.sources, "notes"_a = made.notes,
                  "warnings"_a = made.warnings);
  return gridsObject(made.grids(), totals, o.call);
}

}  // namespace

void bindSolidTexture(py::module_& m) {
  define<TextureOptions>(
      m,
      {"solid_texture", "mesh, image=None",
       "Continues a surface's texture into its solid: an innermap.Grids with surface, density, Cd "
       "(linear colours) and, unless from vertex colours, uv.\n\nmesh: with texture coordinates, a "
       "path or an innermap.Mesh; or any mesh with `colours`. image: a path, with <UDIM> for "
       "tiles; "
       "None: the vertices' colours. totals has fit_error and colour_error, each a BoundaryError "
       "in the values' units. Raises DataError, FileError, MemoryError."},
      texture);
}

}  // namespace innermap::python
