// `innermap slice`: a .vdb file as EXR slices and as a picture of one section.
#include "innermap/io/slice.h"

#include <fmt/format.h>

#include "commands.h"
#include "innermap/core/memory.h"
#include "innermap/io/exr/exr_slices.h"
#include "innermap/io/picture/section_image.h"
#include "innermap/io/vdb/vdb_file.h"
#include "lists.h"

namespace innermap::tool {
namespace {

struct SliceOptions {
  std::string file, output, section, axis = "z", grids, grid, component = "length";
  int count = ExrSliceSettings().count;
  bool half = false, colour = false;
  double at = SectionSettings().at;
  std::optional<double> position;
  std::optional<NumberPair> range;
  int pixels = SectionSettings().pixels;
};

Component componentOf(const std::string& text) {
  return text == "x"   ? Component::x
         : text == "y" ? Component::y
         : text == "z" ? Component::z
                       : Component::length;
}

ExrSliceSettings exrSettings(const SliceOptions& options, Context& context) {
  ExrSliceSettings s;
  s.axis = parseAxis("--axis", options.axis);
  s.count = options.count;
  s.half = options.half;
  s.maxMemory = context.maxMemory();
  s.progress = context.progress();
  return s;
}

SectionSettings sectionSettings(const SliceOptions& options, Context& context) {
  SectionSettings s;
  s.grid = options.grid;
  s.component = componentOf(options.component);
  s.colour = options.colour;
  s.axis = parseAxis("--axis", options.axis);
  s.at = options.at;
  s.position = options.position;
  s.range = options.range;
  s.pixels = options.pixels;
  s.maxMemory = context.maxMemory();
  s.progress = context.progress();
  return s;
}

// Which grids are read: all unless chosen; for the section alone, its grid and the solid's.
std::vector<std::string> namesToRead(const SliceOptions& options, const VdbInfo& info) {
  std::vector<std::string> names = commaList(options.grids);
  if (names.empty() && !options.output.empty()) return {};
  if (options.section.empty() || (options.output.empty() && options.grid.empty())) return names;
  if (!options.grid.empty()) names.push_back(options.grid);
  if (options.output.empty())
    for (const VdbGridInfo& grid : info.grids)
      if (grid.name == "surface" || grid.name == "density") names.push_back(grid.name);
  return names;
}

void writeSlices(const SliceOptions& options, const openvdb::GridPtrVec& grids, Context& context) {
  const ExrSliceResult r = writeExrSlices(options.output, grids, exrSettings(options, context));
  if (r.slices < options.count)
    context.note(fmt::format("{}: {} slices instead of {}: the box has no more layers of voxels",
                             options.output, r.slices, options.count));
  if (r.clamped > 0)
    context.warning(
        fmt::format("{}: {} values do not fit half floats and were clamped; leave out "
                    "--half",
                    options.output, r.clamped));
  context.report().set("slices.count", static_cast<std::int64_t>(r.slices));
  context.report().set("slices.width", static_cast<std::int64_t>(r.columns));
  context.report().set("slices.height", static_cast<std::int64_t>(r.rows));
}

void writeSection(const SliceOptions& options, const openvdb::GridPtrVec& grids, Context& context) {
  const SectionResult r =
      writeSectionImage(options.section, grids, sectionSettings(options, context));
  context.report().set("section.grid", r.grid);
  context.report().set("section.position", r.position);
  context.report().set("section.least", r.least);
  context.report().set("section.most", r.most);
  context.report().set("section.range", std::vector<double>{r.lower, r.upper});
}

void run(const SliceOptions& options, Context& context) {
  if (options.output.empty() && options.section.empty())
    throw UsageError(
        "give --output for EXR slices, --section for a picture, or both; "
        "see 'innermap slice --help'");
  for (const std::string* path : {&options.output, &options.section})
    if (!path->empty()) context.output(*path);
  const VdbInfo info = readVdbInfo(options.file, {context.progress()});
  VdbReadSettings read;
  read.names = namesToRead(options, info);
  read.maxMemory = context.maxMemory();
  read.progress = context.progress();
  if (context.dryRun()) {
    std::vector<std::string> lines;
    if (!options.output.empty())
      lines.push_back(fmt::format("cut {} into {} slices along {} to {}", options.file,
                                  options.count, options.axis, options.output));
    if (!options.section.empty())
      lines.push_back("draw a section of " + options.file + " to " + options.section);
    return context.plan(lines, readMemory(info));
  }
  openvdb::GridPtrVec grids;
  context.timed("read", [&] { grids = readVdb(options.file, read).grids; });
  if (!options.output.empty())
    context.timed("slices", [&] { writeSlices(options, grids, context); });
  if (!options.section.empty())
    context.timed("section", [&] { writeSection(options, grids, context); });
}

}  // namespace

Command makeSliceCommand() {
  auto o = std::make_shared<SliceOptions>();
  Command c("slice", "Cut a .vdb file into EXR slices, and draw a section");
  c.description(
      "The EXR file has a part a slice and a channel a grid (`jacobian.V`, `map.X`), cropped to "
      "the active box; each slice is a layer of voxels, with its place as attributes. The picture "
      "shows one grid from blue (least) to red (most), or colours as they are.");
  c.positional("FILE", &o->file, "the .vdb file");
  c.option("--output", "FILE", &o->output, "the .exr file to write").shortName("-o");
  c.option("--axis", "AXIS", &o->axis, "direction across the slices").choices({"x", "y", "z"});
  c.option("--count", "N", &o->count, "number of slices, evenly spaced").range(1, 65536);
  c.option("--grids", "LIST", &o->grids, "grids to slice, with commas between").defaults("all");
  c.flag("--half", &o->half, "half floats: half the size, three digits");
  c.option("--section", "FILE", &o->section, "the .png picture to write");
  c.option("--grid", "NAME", &o->grid, "grid that the picture shows")
      .defaults("jacobian, else the first energy, map, density or surface there is");
  c.option("--component", "PART", &o->component, "of a vector grid in the picture")
      .choices({"x", "y", "z", "length"});
  c.flag("--colour", &o->colour,
         "the picture shows a vector grid's values as red, green and blue; by default of Cd");
  c.option("--at", "T", &o->at, "where the picture cuts")
      .unit("fraction of the box along the axis")
      .range(0, 1);
  c.option("--position", "P", &o->position, "where the picture cuts, instead of --at")
      .unit("world units");
  c.option("--range", "LO,HI", &o->range,
           "values that are blue and red in the picture; with --colour, black and white")
      .defaults("all but the outermost 0.5% on each side");
  c.option("--pixels", "N", &o->pixels, "longer side of the section in the picture")
      .range(64, 8192);
  c.example("innermap slice map.vdb --axis z --count 16 -o slices.exr");
  c.example("innermap slice map.vdb --section section.png --grid jacobian --axis x --at 0.5");
  c.example("innermap slice texture.vdb --section section.png --colour --axis x");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
