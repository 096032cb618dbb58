// `innermap import`: volume textures back into grids.
#include <fmt/format.h>

#include "commands.h"
#include "innermap/io/slice.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/io/volume/volume_texture.h"
#include "lists.h"
#include "volume_options.h"

namespace innermap::tool {
namespace {

struct ImportOptions {
  std::string file, output, layout, grids, tiles, axis, rows, lowerCorner, gridClass;
  std::optional<int> slices;
  std::optional<double> voxelSize, background;
};

VolumeTextureReadSettings settingsOf(const ImportOptions& options, Context& context) {
  VolumeTextureReadSettings s;
  s.names = commaList(options.grids);
  if (!options.layout.empty()) s.layout = parseVolumeLayout("--layout", options.layout);
  if (!options.tiles.empty()) s.tiles = parseTiles("--tiles", options.tiles);
  s.slices = options.slices;
  if (!options.axis.empty()) s.axis = parseAxis("--axis", options.axis);
  if (!options.rows.empty()) s.rowsUp = options.rows == "up";
  s.voxelSize = options.voxelSize;
  if (!options.lowerCorner.empty()) {
    if (!s.voxelSize) throw UsageError("--lower-corner: has a meaning with --voxel-size only");
    s.lowerCorner = parsePoint("--lower-corner", options.lowerCorner);
  }
  s.background = options.background;
  if (!options.gridClass.empty())
    s.gridClass = options.gridClass == "level-set" ? "level set"
                  : options.gridClass == "fog"     ? "fog volume"
                                                   : "unknown";
  s.maxMemory = context.maxMemory();
  s.progress = context.progress();
  return s;
}

std::string summary(const VolumeTextureContents& contents, const ImportOptions& options) {
  std::string text = fmt::format("{}: {} of {} x {} x {} voxels\n", options.output,
                                 volumeLayoutName(contents.layout), contents.resolution.x(),
                                 contents.resolution.y(), contents.resolution.z());
  for (const auto& grid : contents.grids)
    text += fmt::format("  {}: {}, {} active voxels\n", grid->getName(), grid->valueType(),
                        grid->activeVoxelCount());
  return text;
}

void run(const ImportOptions& options, Context& context) {
  const VolumeTextureReadSettings settings = settingsOf(options, context);
  context.output(options.output);
  if (context.dryRun()) {
    const VolumeTextureNeed need = volumeTextureReadNeed(options.file, settings);
    return context.plan(
        {fmt::format("read the volume texture {}, {} x {} x {} voxels", options.file,
                     need.resolution.x(), need.resolution.y(), need.resolution.z()),
         "write grids to " + options.output},
        need.memory);
  }
  VolumeTextureContents contents;
  context.timed("read", [&] { contents = readVolumeTexture(options.file, settings); });
  if (contents.notFinite > 0)
    context.warning(
        fmt::format("{}: {} values are infinite or no numbers", options.file, contents.notFinite));
  context.timed("write", [&] {
    VdbWriteSettings write;
    write.progress = context.progress();
    writeVdb(options.output, contents.grids, {}, write);
  });
  std::uint64_t active = 0;
  std::vector<std::string> names;
  for (const auto& grid : contents.grids) {
    active += grid->activeVoxelCount();
    names.push_back(grid->getName());
  }
  Report& report = context.report();
  report.set("texture.layout", volumeLayoutName(contents.layout));
  report.set("texture.resolution",
             std::vector<double>{double(contents.resolution.x()), double(contents.resolution.y()),
                                 double(contents.resolution.z())});
  report.set("texture.grids", names);
  report.set("texture.active_voxels", static_cast<std::int64_t>(active));
  report.set("texture.not_finite", static_cast<std::int64_t>(contents.notFinite));
  context.print(summary(contents, options));
}

}  // namespace

Command makeImportCommand() {
  auto o = std::make_shared<ImportOptions>();
  Command c("import", "Read a volume texture back into a .vdb file");
  c.description(
      "What `innermap export` writes comes back as it was, within the rounding of the pixels: "
      "types, names, classes, backgrounds and transform stand in the attributes. Voxels that have "
      "the background are inactive. For textures of other programs, options say what the file does "
      "not; an option wins over an attribute.");
  c.positional("FILE", &o->file,
               "the .exr file; of slices, any of the files or a pattern with #### or %04d");
  c.option("--output", "FILE", &o->output, "the .vdb file to write").shortName("-o").required();
  c.option("--grid", "LIST", &o->grids,
           "grids to read, with commas between; of a file that does not say what its channels are, "
           "their names: R, G, B together and X, Y, Z are a vector")
      .defaults("all");
  c.option("--layout", "NAME", &o->layout, "what the pictures are")
      .choices({"atlas", "slices", "parts"})
      .defaults("from the file");
  c.option("--tiles", "CxR", &o->tiles, "columns and rows of an atlas, such as 8x8")
      .defaults("from the file");
  c.option("--slices", "N", &o->slices, "slices, when fewer than tiles, parts or files")
      .range(1, 65536)
      .defaults("from the file, else all");
  c.option("--voxel-size", "L", &o->voxelSize, "edge of a voxel, in place of the file's matrix")
      .unit("world units")
      .above(0)
      .defaults("from the file");
  c.option("--lower-corner", "X,Y,Z", &o->lowerCorner, "least corner of the box, with --voxel-size")
      .unit("world units")
      .defaults("0,0,0");
  c.option("--axis", "AXIS", &o->axis, "direction across the slices")
      .choices({"x", "y", "z"})
      .defaults("from the file, else z");
  c.option("--rows", "ORDER", &o->rows,
           "down: a slice's first row has the least index; up: the largest")
      .choices({"down", "up"})
      .defaults("from the file, else down");
  c.option("--background", "V", &o->background, "value of what is not active")
      .defaults("from the file, else 0");
  c.option("--class", "NAME", &o->gridClass, "class of the grids")
      .choices({"level-set", "fog", "unknown"})
      .defaults("from the file, else unknown");
  c.example("innermap import smoke.exr -o smoke.vdb");
  c.example(
      "innermap import cloud.exr -o cloud.vdb --tiles 12x12 --voxel-size 0.1 --grid density "
      "--class fog");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
