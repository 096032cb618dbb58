// `innermap export`: grids as volume textures in EXR files.
#include <fmt/format.h>

#include "commands.h"
#include "innermap/core/frame_files.h"
#include "innermap/io/slice.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/io/volume/volume_texture.h"
#include "lists.h"
#include "volume_options.h"

namespace innermap::tool {
namespace {

struct ExportOptions {
  std::string file, output, layout = "atlas", grids, axis = "z", rows = "down", channels = "auto",
                            tiles;
  std::optional<int> resolution;
  int pad = 0;
  bool half = false, powerOfTwo = false, cube = false, active = false;
};

VolumeTextureSettings settingsOf(const ExportOptions& options, Context& context) {
  VolumeTextureSettings s;
  s.layout = parseVolumeLayout("--layout", options.layout);
  s.axis = parseAxis("--axis", options.axis);
  s.rowsUp = options.rows == "up";
  s.channels = options.channels == "rgba"     ? VolumeChannels::rgba
               : options.channels == "layers" ? VolumeChannels::layers
                                              : VolumeChannels::automatic;
  s.half = options.half;
  s.active = options.active;
  s.pad = options.pad;
  s.cube = options.cube;
  s.resolution = options.resolution.value_or(0);
  s.powerOfTwo = options.powerOfTwo;
  if (!options.tiles.empty()) s.tiles = parseTiles("--tiles", options.tiles);
  s.maxMemory = context.maxMemory();
  s.progress = context.progress();
  return s;
}

void fillReport(const VolumeTextureResult& r, const ExportOptions& options, Context& context) {
  Report& report = context.report();
  const auto number = [](int n) { return static_cast<std::int64_t>(n); };
  report.set("texture.layout", options.layout);
  report.set("texture.files", number(static_cast<int>(r.files.size())));
  report.set("texture.width", number(r.width));
  report.set("texture.height", number(r.height));
  report.set("texture.tiles", std::vector<double>{double(r.tileColumns), double(r.tileRows)});
  report.set("texture.slices", number(r.slices));
  report.set("texture.resolution",
             std::vector<double>{double(r.resolution.x()), double(r.resolution.y()),
                                 double(r.resolution.z())});
  report.set("texture.channels", r.channels);
  report.set("texture.clamped", static_cast<std::int64_t>(r.clamped));
  report.set("texture.rounded", static_cast<std::int64_t>(r.inexact));
}

void run(const ExportOptions& options, Context& context) {
  const VolumeTextureSettings settings = settingsOf(options, context);
  context.output(settings.layout == VolumeLayout::slices
                     ? FramePattern("--output", options.output).path(0)
                     : options.output);
  VdbReadSettings read;
  read.names = commaList(options.grids);
  read.maxMemory = context.maxMemory();
  read.progress = context.progress();
  if (context.dryRun()) {
    const std::uint64_t need =
        readMemory(readVdbInfo(options.file, {context.progress()}), read.names);
    return context.plan({fmt::format("write {} as a volume texture ({}) to {}", options.file,
                                     options.layout, options.output)},
                        need);
  }
  openvdb::GridPtrVec grids;
  context.timed("read", [&] { grids = readVdb(options.file, read).grids; });
  VolumeTextureResult result;
  context.timed("write", [&] { result = writeVolumeTexture(options.output, grids, settings); });
  for (const std::string& warning : warningsOf(result, options.output, settings))
    context.warning(warning);
  fillReport(result, options, context);
  context.print(describe(result, options.output, settings));
}

void addShapeOptions(Command& c, ExportOptions& o) {
  c.option("--resolution", "N", &o.resolution,
           "resample to N voxels along the longest side: linear, the mean where voxels grow")
      .range(1, 8192)
      .defaults("the grids' own voxels");
  c.option("--pad", "N", &o.pad, "voxels about the active box").range(0, 4096);
  c.flag("--cube", &o.cube, "widen the box to a cube");
  c.flag("--power-of-two", &o.powerOfTwo,
         "widen the box so that the slices' number and sides and the picture's are powers of two");
  c.option("--tiles", "CxR", &o.tiles, "columns and rows of the atlas, such as 8x8")
      .defaults("near a square");
}

}  // namespace

Command makeExportCommand() {
  auto o = std::make_shared<ExportOptions>();
  Command c("export", "Write grids as volume textures for engines: an atlas, slices or parts");
  c.description(
      "The common active box of the grids as a dense texture in EXR, with the background where "
      "nothing is active. An atlas has its slices as tiles, row-major from the top left. "
      "Attributes "
      "tell tiling, order, voxel size, bounds, matrices and what each grid is; `innermap import` "
      "reads them. One scalar grid is the channel Y, a vector R, G, B, a vector and a scalar "
      "R, G, B, A; more than four channels are layers (`density.V`, `Cd.R`).");
  c.positional("FILE", &o->file, "the .vdb file");
  c.option("--output", "FILE", &o->output,
           "the .exr file; of slices, with #### or %04d for the number, else it is put before the "
           "extension")
      .shortName("-o")
      .required();
  c.option("--layout", "NAME", &o->layout,
           "atlas: one picture of tiles; slices: a file each; parts: one multi-part file")
      .choices({"atlas", "slices", "parts"});
  c.option("--grid", "LIST", &o->grids, "grids to write, with commas between").defaults("all");
  c.flag("--half", &o->half, "half floats: half the size, three digits");
  c.option("--channels", "NAMES", &o->channels,
           "rgba: Y or R, G, B, A; layers: by the grids' names; auto: rgba where four are enough")
      .choices({"auto", "rgba", "layers"});
  addShapeOptions(c, *o);
  c.option("--axis", "AXIS", &o->axis, "direction across the slices").choices({"x", "y", "z"});
  c.option("--rows", "ORDER", &o->rows,
           "down: a slice's first row has the least index (Direct3D, Unreal); up: the largest "
           "(OpenGL, Unity)")
      .choices({"down", "up"});
  c.flag("--active", &o->active, "also NAME.active: 1 where a voxel is active");
  c.example("innermap export smoke.vdb -o smoke.exr --grid density --resolution 64 --cube --half");
  c.example("innermap export map.vdb -o 'slices/map.####.exr' --layout slices --grid map,density");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
