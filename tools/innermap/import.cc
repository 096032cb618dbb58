// `innermap import`: volume textures and scans into grids.
#include <fmt/format.h>

#include "commands.h"
#include "grid_options.h"
#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"
#include "lists.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

struct ImportOptions {
  std::string file, output, grids, tiles, lowerCorner;
  VolumeTextureReadSettings texture;
};

VolumeTextureReadSettings settingsOf(const ImportOptions& options) {
  auto s = options.texture;
  s.names = commaList(options.grids);
  if (!options.tiles.empty()) s.tiles = parseTiles("--tiles", options.tiles);
  if (!options.lowerCorner.empty()) {
    if (!s.voxelSize) throw UsageError("--lower-corner: has a meaning with --voxel-size only");
    const std::vector<double> corner =
        parseNumbers("--lower-corner", options.lowerCorner, 3, "three numbers X,Y,Z");
    s.lowerCorner = Vec3{corner[0], corner[1], corner[2]};
  }
  return s;
}

std::string summary(const VolumeTextureContents& contents, const ImportOptions& options) {
  const bool pictures = contents.format == volumeFormats().front().name;
  std::string text =
      fmt::format("{}: {} of {} x {} x {} voxels\n", options.output,
                  pictures ? volumeLayoutName(contents.layout) : contents.format,
                  contents.resolution.x(), contents.resolution.y(), contents.resolution.z());
  for (const auto& grid : contents.grids)
    text += fmt::format("  {}: {}, {} active voxels\n", grid->getName(), grid->valueType(),
                        grid->activeVoxelCount());
  return text;
}

void run(const ImportOptions& options, Context& context) {
  const VolumeTextureReadSettings settings = settingsOf(options);
  context.output(options.output);
  if (context.dryRun()) {
    const VolumeTextureNeed need = volumeTextureReadNeed(options.file, settings);
    return context.plan({fmt::format("read {}, {} x {} x {} voxels", options.file,
                                     need.resolution.x(), need.resolution.y(), need.resolution.z()),
                         "write grids to " + options.output},
                        need.memory);
  }
  VolumeTextureContents contents =
      context.timed("read", [&] { return readVolumeTexture(options.file, settings); });
  moveGrids(contents.grids, inputToOutput(context.space()));
  if (contents.notFinite > 0)
    context.warning(
        fmt::format("{}: {} values are infinite or no numbers", options.file, contents.notFinite));
  writeGridFile(options.output, contents.grids, NamingScheme::innermap, context);
  std::uint64_t active = 0;
  std::vector<std::string> names;
  for (const auto& grid : contents.grids) {
    active += grid->activeVoxelCount();
    names.push_back(grid->getName());
  }
  Report& report = context.report();
  const auto& size = contents.resolution;
  if (contents.format == volumeFormats().front().name)
    report.add("texture", layoutFigures(volumeLayoutName(contents.layout)));
  report.add("texture", figures(ReportImport{{double(size.x()), double(size.y()), double(size.z())},
                                             names,
                                             active,
                                             contents.notFinite}));
  context.print(summary(contents, options));
}

}  // namespace

Command makeImportCommand() {
  auto o = std::make_shared<ImportOptions>();
  Command c("import", "Read a volume texture or a scan into a .vdb file");
  c.description(
      "Restores files of `innermap export`, up to the rounding of the pixels: their attributes "
      "hold types, names, classes, backgrounds and transform. Voxels with the background's value "
      "are inactive. For textures of other programs, give by options what the file does not say; "
      "an option wins over an attribute. NIfTI files (.nii, .nii.gz) become a grid in their own "
      "world, by sform or qform, in millimetres; labels stay whole numbers.");
  c.positional(
      "FILE", &o->file,
      "the .exr, .nii or .nii.gz file; of slices, any of the files or a pattern with #### or %04d");
  c.outputFile(&o->output, {".vdb"}, "the .vdb file to write");
  c.option("--grids", "LIST", &o->grids,
           "grids to read, with commas between; if the file does not say what its channels are, "
           "names for them (R, G, B together and X, Y, Z are one vector)")
      .defaults("all")
      .was("--grid");
  c.settings(describe(o->texture));
  c.option("--tiles", "CxR", &o->tiles, "columns and rows of an atlas, such as 8x8")
      .defaults("from the file")
      .advanced();
  c.option("--lower-corner", "X,Y,Z", &o->lowerCorner, "least corner of the box, with --voxel-size")
      .unit("world units")
      .defaults("0,0,0")
      .advanced();
  c.choice("--rows", "ORDER", &o->texture.rowsUp, {{"down", false}, {"up", true}},
           "down: a slice's first row has the least index; up: the largest")
      .defaults("from the file, else down");
  c.choice("--class", "NAME", &o->texture.gridClass,
           {{"level-set", "level set"}, {"fog", "fog volume"}, {"unknown", "unknown"}},
           "class of the grids")
      .defaults("from the file, else unknown")
      .advanced();
  c.addSpace();
  c.example("innermap import smoke.exr -o smoke.vdb");
  c.example("innermap import scan.nii.gz -o scan.vdb");
  c.example(
      "innermap import cloud.exr -o cloud.vdb --tiles 12x12 --voxel-size 0.1 --grids density "
      "--class fog");
  return c.running(o, run);
}

}  // namespace innermap::tool
