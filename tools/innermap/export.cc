// `innermap export`: grids as volume textures and in other programs' files.
#include <fmt/format.h>

#include <filesystem>

#include "block_share.h"
#include "commands.h"
#include "core/frame_files.h"
#include "innermap/io/pictures.h"
#include "innermap/io/vdb_file.h"
#include "innermap/io/volume_texture.h"
#include "inputs.h"
#include "lists.h"
#include "report/figures.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

struct ExportOptions {
  std::string file, output, grids, tiles;
  VolumeTextureSettings texture;
  UsdVolumeSettings usd;
};

VolumeTextureSettings settingsOf(const ExportOptions& options) {
  auto s = options.texture;
  if (!options.tiles.empty()) s.tiles = parseTiles("--tiles", options.tiles);
  return s;
}

void fillReport(const VolumeTextureResult& r, const ExportOptions& options, Context& context) {
  Report& report = context.report();
  if (r.slices > 0) report.add("texture", layoutFigures(volumeLayoutName(options.texture.layout)));
  report.add("texture", figures(r));
}

// One .vdb file or the blocks of a volume, which stand at all times, or the frames of a pattern or
// a folder.
std::vector<UsdFrame> framesOf(const std::string& file) {
  std::vector<UsdFrame> frames;
  if (isShares(file)) {
    for (const std::string& block : blockFiles(file)) frames.push_back({std::nullopt, block});
    return frames;
  }
  const std::string name = std::filesystem::path(file).filename().string();
  if (name.find_first_of("#*?%") == std::string::npos && !std::filesystem::is_directory(file))
    return {{std::nullopt, file}};
  for (const FrameFile& frame : findFrames({file}, {".vdb"}).frames)
    frames.push_back({frame.number, frame.path});
  return frames;
}

void runReferences(const ExportOptions& options, Context& context) {
  context.output(options.output);
  const std::vector<UsdFrame> frames = framesOf(options.file);
  for (const UsdFrame& frame : frames)
    if (frame.path != options.file) context.input(frame.path);
  if (context.dryRun())
    return context.plan(
        {fmt::format("refer to {} .vdb files in {}", frames.size(), options.output)}, 0);
  UsdVolumeSettings settings = options.usd;
  settings.names = commaList(options.grids);
  settings.space = context.space();
  context.timed("write", [&] { writeUsdVolume(options.output, frames, settings); });
  const std::string format = volumeFormatOf(options.output).name;
  context.print(fmt::format("{}: {}, refers to {} .vdb file{}\n", options.output, format,
                            frames.size(), frames.size() == 1 ? "" : "s"));
}

void run(const ExportOptions& options, Context& context) {
  if (volumeFormatOf(options.output).refers) return runReferences(options, context);
  const VolumeTextureSettings settings = settingsOf(options);
  if (settings.layout == VolumeLayout::slices) {
    const FramePattern slices("--output", options.output);
    context.output(slices.path(0));
    const auto number = frameNumber(options.file);
    if (number.value_or(0) != 0) context.output(slices.path(*number), false);
  } else {
    context.output(options.output);
  }
  const std::vector<std::string> names = commaList(options.grids);
  const openvdb::GridPtrVec grids = readGridFile(options.file, names, context);
  const std::string format = planVolumeTexture(options.output, grids, settings).format;
  if (!context.begins(
          {fmt::format("write {} as {} to {}", options.file, format, options.output)},
          {"writing " + options.output, volumeTextureMemory(options.output, grids, settings),
           "export fewer grids or at a lower {resolution}"}))
    return;
  const VolumeTextureResult result =
      context.timed("write", [&] { return writeVolumeTexture(options.output, grids, settings); });
  for (const std::string& warning : warningsOf(result, options.output, settings))
    context.warning(warning);
  fillReport(result, options, context);
  context.print(describe(result, options.output, settings));
}

std::vector<std::string> outputEndings() {
  std::vector<std::string> endings;
  for (const VolumeFormat& format : volumeFormats()) endings.push_back(format.ending);
  return endings;
}

std::string outputHelp() {
  std::string text = "The ending of --output is the format:";
  for (const VolumeFormat& format : volumeFormats())
    text += fmt::format("{} {}, {}: {}", format.ending == volumeFormats().front().ending ? "" : ";",
                        format.ending, format.name, format.holds);
  return text + ".";
}

void addShapeOptions(Command& c, ExportOptions& o) {
  c.option("--tiles", "CxR", &o.tiles, "columns and rows of the atlas, such as 8x8")
      .defaults("near a square")
      .advanced();
}

}  // namespace

Command makeExportCommand() {
  auto o = std::make_shared<ExportOptions>();
  Command c("export", "Write grids for engines, renderers and other programs");
  c.description(
      outputHelp() +
      " EXR holds the common active box of the grids as a dense texture, with the background where "
      "nothing is active. An atlas has its slices as tiles, row-major from the top left. "
      "Attributes tell tiling, order, voxel size, bounds, matrices and what each grid is; "
      "`innermap import` reads them. One scalar grid is the channel Y, a vector R, G, B, a vector "
      "and a scalar R, G, B, A; more than four channels are layers (`density.V`, `Cd.R`).");
  c.positional(
      "FILE", &o->file,
      "the .vdb file; for .usda also a folder or pattern of frames, with #### or *, or the "
      "folder .shares of a volume that evaluate or voxelize made in shares");
  c.outputFile(
      &o->output, outputEndings(),
      "the file, in the format of its ending; for slices with #### or %04d for the number, "
      "which otherwise goes before the ending");
  c.option("--grids", "LIST", &o->grids, "grids to write, with commas between")
      .was("--grid")
      .defaults("all");
  c.settings(describe(o->texture));
  c.settings(describe(o->usd));
  addShapeOptions(c, *o);
  c.choice("--rows", "ORDER", &o->texture.rowsUp, {{"down", false}, {"up", true}},
           "down: a slice's first row has the least index (Direct3D, Unreal); up: the largest "
           "(OpenGL, Unity)");
  c.addSpace();
  c.example("innermap export smoke.vdb -o smoke.exr --grids density --resolution 64 --cube --half");
  c.example("innermap export smoke.vdb -o smoke.nvdb --half");
  c.example("innermap export 'out/smoke.####.vdb' -o smoke.usda --fps 25");
  c.example("innermap export map.vdb.shares -o map.usda");
  c.example("innermap export map.vdb -o 'slices/map.####.exr' --layout slices --grids map,density");
  return c.running(o, run);
}

}  // namespace innermap::tool
