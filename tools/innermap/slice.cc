// `innermap slice`: a .vdb file as EXR slices and as a picture of one section.
#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "innermap/core/memory.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/pictures.h"
#include "innermap/io/vdb_file.h"
#include "inputs.h"
#include "lists.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

struct SliceOptions {
  std::string file, output, picture, grids;
  std::string plane;  // of the picture, as it was given
  int axis = 2;
  ExrSliceSettings slices;
  SectionSettings section;
};

// Which grids are read: all unless chosen; for the section alone, its grid and the solid's.
std::vector<std::string> namesToRead(const SliceOptions& options, const VdbInfo& info) {
  std::vector<std::string> names = commaList(options.grids);
  if (names.empty() && !options.output.empty()) return {};
  const std::string& shown = options.section.grid;
  if (options.picture.empty() || (options.output.empty() && shown.empty())) return names;
  if (!shown.empty()) names.push_back(shown);
  if (options.output.empty())
    for (const VdbGridInfo& grid : info.grids)
      if (grid.name == "surface" || grid.name == "density") names.push_back(grid.name);
  return names;
}

void writeSlices(const SliceOptions& options, const openvdb::GridPtrVec& grids, Context& context) {
  auto settings = options.slices;
  settings.axis = options.axis;
  const ExrSliceResult r = writeExrSlices(options.output, grids, settings);
  if (r.slices < settings.count)
    context.note(fmt::format("{}: {} slices instead of {}: the box has no more layers of voxels",
                             options.output, r.slices, settings.count));
  if (r.clamped > 0)
    context.warning(
        fmt::format("{}: {} values do not fit half floats and were clamped; leave out "
                    "--half",
                    options.output, r.clamped));
  context.report().add("slices", figures(r));
}

void writeSection(const SliceOptions& options, const openvdb::GridPtrVec& grids, Context& context) {
  const SectionResult r = writeSectionImage(options.picture, grids, options.section);
  context.report().add("section", figures(r));
}

std::uint64_t memoryOf(const SliceOptions& options, const openvdb::GridPtrVec& grids) {
  std::uint64_t need = 0;
  if (!options.output.empty()) {
    ExrSliceSettings slices = options.slices;
    slices.axis = options.axis;
    need = exrSliceMemory(grids, slices);
  }
  if (options.picture.empty()) return need;
  return std::max(need, sectionImageMemory(grids, options.section));
}

// --section was the picture's file once.
SliceOptions withPlane(SliceOptions options, Context& context) {
  if (std::filesystem::path(options.plane).extension() == ".png") {
    context.note("--section FILE is now called --picture FILE; --section x=0.5 is its plane");
    options.picture = options.plane;
    options.plane.clear();
  }
  Cut cut{options.axis, {}};
  if (!options.plane.empty()) cut = parseCut("--section", options.plane, cut);
  options.section.axis = cut.axis.value_or(options.axis);
  if (cut.at) options.section.at = *cut.at;
  return options;
}

void run(const SliceOptions& given, Context& context) {
  const SliceOptions options = withPlane(given, context);
  if (options.output.empty() && options.picture.empty())
    throw UsageError(
        "give --output for EXR slices, --picture for a section, or both; "
        "see 'innermap slice --help'");
  for (const std::string* path : {&options.output, &options.picture})
    if (!path->empty()) context.output(*path);
  const VdbInfo info = readVdbInfo(options.file);
  const openvdb::GridPtrVec grids = readGridFile(options.file, namesToRead(options, info), context);
  const std::uint64_t need = memoryOf(options, grids);
  if (context.dryRun()) {
    std::vector<std::string> lines;
    if (!options.output.empty())
      lines.push_back(fmt::format("cut {} into {} slices along {} to {}", options.file,
                                  options.slices.count, options.axis, options.output));
    if (!options.picture.empty())
      lines.push_back("draw a section of " + options.file + " to " + options.picture);
    return context.plan(lines, need);
  }
  context.requireMemory(
      {"cutting " + options.file, need, "slice fewer grids or along another axis"});
  if (!options.output.empty())
    context.timed("slices", [&] { writeSlices(options, grids, context); });
  if (!options.picture.empty())
    context.timed("section", [&] { writeSection(options, grids, context); });
}

}  // namespace

Command makeSliceCommand() {
  auto o = std::make_shared<SliceOptions>();
  Command c("slice", "Cut a .vdb file into EXR slices, and draw a section");
  c.description(
      "The EXR file has one part for each slice and one channel for each grid (`jacobian.V`, "
      "`map.X`), cropped to the active box; each slice is a layer of voxels, with its place as "
      "attributes. The picture shows one grid, by default from blue (least) to red (most), or "
      "colours as they are.");
  c.positional("FILE", &o->file, "the .vdb file");
  c.option("--output", "FILE", &o->output, "the .exr file to write")
      .shortName("-o")
      .writes({".exr"});
  c.setting(axisSetting("axis", &o->axis, "direction across the slices"));
  c.settings(without(describe(o->slices), {"axis"}));
  c.option("--grids", "LIST", &o->grids, "grids to slice, with commas between").defaults("all");
  c.group("picture");
  c.option("--picture", "FILE", &o->picture, "a .png of a section to write").writes({".png"});
  c.option("--section", kCutPlaceholder, &o->plane,
           "plane of the picture: x, y or z, and the fraction of the box along it, as in x=0.5")
      .defaults("across --axis, in the middle");
  c.option("--grid", "NAME", &o->section.grid, "grid that the picture shows")
      .defaults("jacobian, else the first energy, map, density or surface there is");
  c.settings(without(describe(o->section), {"axis", "at"}));
  c.setting(only(describe(o->section), {"at"}).front().rare());
  c.option("--range", "LO,HI", &o->section.range,
           "values at the ends of the colours; with --colour, black and white")
      .defaults("all but the outermost 0.5% on each side");
  c.example("innermap slice map.vdb --axis z --slices 16 -o slices.exr");
  c.example("innermap slice map.vdb --picture section.png --grid jacobian --section x=0.5");
  c.example("innermap slice texture.vdb --picture section.png --colour --section x");
  return c.running(o, run);
}

}  // namespace innermap::tool
