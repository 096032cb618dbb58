#include "frame_options.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/file.h"
#include "innermap/core/memory.h"
#include "innermap/field/fit.h"
#include "innermap/io/vdb_file.h"
#include "inputs.h"
#include "map_report.h"
#include "report/page/contents.h"

namespace innermap::tool {
namespace {

std::vector<std::string> withFilesBeside(const std::string& path) {
  std::vector<std::string> all = filesBeside(path);
  all.push_back(path);
  return all;
}

}  // namespace

void addFrameArgument(Command& command, FrameOptions& o) {
  command
      .positional("FRAMES", &o.files,
                  "meshes of the rest pose's connectivity, a frame number in each name: files, "
                  "a folder, or a pattern in quotes with *, ?, #### or %04d; or a point cache "
                  "of the rest pose's vertices (.mdd, .pc2), or glTF (.glb, .gltf), which may "
                  "also be SOURCE alone")
      .optional();
}

void addFrameOptions(Command& command, FrameOptions& o) {
  command.group("frames");
  command.option("--frames", "LIST", &o.ranges, "which frames: 12, 1-48, 1-48x2 (every second)")
      .defaults("all");
  command.settings(describe(o.animation));
  command.option("--mesh", "NAME", &o.animation.mesh,
                 "mesh or node of glTF to read, if it has several");
  command
      .option("--animation", "NAME", &o.animation.animation,
              "animation of glTF to read, if several move the same")
      .defaults("all");
  command.limitTime(
      "begin no frame after this time, except the first; the run reports how many are left");
  command
      .option("--usd", "FILE", &o.usd,
              "also write a .usda file that refers to the frames' grids, for Solaris and usdview")
      .writes({".usda"});
  command.settings(describe(o.fitting));
  command
      .option("--tolerance", "T", &o.tolerance,
              "99% of each frame's boundary should lie within T; the run marks frames that miss it "
              "and warns")
      .unit("fraction of the frame's diagonal")
      .range(1e-12, 1);
  command.settings(describe(o.verdict, true));
  command.addSpace();
}

Frames listFrames(const FrameOptions& options, const std::string& rest, Context& context) {
  if (options.files.empty() && !isGltf(rest))
    throw UsageError("FRAMES: is missing; give files, a folder, a pattern, or an animation file");
  Frames frames;
  frames.animation = options.animation;
  frames.animation.space = context.space();
  frames.source = openFrames(options.files.empty() ? std::vector<std::string>{rest} : options.files,
                             frames.animation);
  if (isGltf(rest))
    for (const std::string& path : filesBeside(rest)) context.input(path);
  std::vector<std::string> left;
  for (const std::string& path : frames.source->unnumbered)
    if (!isSameFile(path, rest)) left.push_back(path);
  if (!left.empty())
    context.note(fmt::format(
        "{}{} left out: no frame number in the name", left.front(),
        left.size() > 1 ? fmt::format(" and {} others", left.size() - 1) : std::string()));
  for (const std::string& note : frames.source->notes) context.note(note);
  for (std::size_t i = 0; i < frames.source->numbers.size(); ++i)
    frames.all.push_back({frames.source->numbers[i], frames.source->path(i)});
  for (std::size_t i = 0; i < frames.all.size(); ++i)
    if (frames.all[i].path != (i == 0 ? rest : frames.all[i - 1].path))
      for (const std::string& path : withFilesBeside(frames.all[i].path)) context.input(path);
  frames.wanted = wantedFrames(frames.source->numbers, "--frames", options.ranges);
  return frames;
}

void requireUsdOfAll(const FrameOptions& options, bool inShares) {
  if (!options.usd.empty() && inShares)
    throw UsageError(
        "--usd: refers to all frames, but a share makes only some; leave it out, and afterwards "
        "write the .usda file with `innermap export`");
}

void announceUsd(const FrameOptions& options, Context& context) {
  if (!options.usd.empty()) context.output(options.usd);
}

void writeUsd(const FrameOptions& options, const FramePattern& pattern, const Frames& frames,
              Context& context) {
  if (options.usd.empty()) return;
  std::vector<UsdFrame> there;
  std::error_code ignored;
  for (const std::size_t index : frames.wanted) {
    const std::int64_t number = frames.all[index].number;
    if (std::filesystem::is_regular_file(pattern.path(number), ignored))
      there.push_back({number, pattern.path(number)});
  }
  UsdVolumeSettings settings;
  settings.framesPerSecond = options.animation.framesPerSecond;
  // The grids are in it already.
  settings.space.up = context.space().upOfOutput();
  settings.space.unitScale = context.space().unitOfOutput();
  context.timed("write", [&] { writeUsdVolume(options.usd, there, settings); });
}

std::vector<std::string> framePaths(const FramePattern& pattern, const Frames& frames) {
  std::vector<std::string> paths;
  for (const std::size_t index : frames.wanted)
    paths.push_back(pattern.path(frames.all[index].number));
  return paths;
}

SourceBoundary readRest(const std::string& rest, const Frames& frames, Context& context) {
  Mesh mesh = isGltf(rest)
                  ? context.timed("read", [&] { return readRestPose(rest, frames.animation); })
                  : readMeshFile(rest, context);
  frames.source->requireLike(mesh);
  SourceBoundary source = makeSourceBoundary(std::move(mesh));
  reportSource(source, context);
  return source;
}

FrameFitter makeFrameFitter(SourceBoundary source, const FrameFitterSettings& settings,
                            Context& context) {
  FrameFitter fitter(std::move(source), settings);
  addSeconds(context.report().seconds, fitter.seconds());
  reportFitter(fitter, settings, context.report());
  return fitter;
}

void noteJumps(std::int64_t frame, const std::string& jumps, Context& context) {
  context.note(fmt::format("from frame {} on: {}", frame, jumps));
}

FrameFits makeFrameFits(const FrameFitter& fitter, const Frames& frames, Context& context) {
  std::vector<std::int64_t> numbers;
  for (const FrameFile& frame : frames.all) numbers.push_back(frame.number);
  std::shared_ptr<PageFrames> shown;
  if (context.page())
    shown = std::make_shared<PageFrames>(*context.page(), fitter.rest().mesh, frames.wanted.size());
  const auto read = [&](std::size_t index) {
    return context.timed("read", [&] { return frames.source->read(index, fitter.rest().mesh); });
  };
  // The first frame of a share need not be the run's.
  const auto fitted = [&, shown, told = frames.share](std::size_t index, const Mesh& mesh,
                                                      const FrameFit& fit) mutable {
    const std::int64_t number = frames.all[index].number;
    addSeconds(context.report().seconds, fit.seconds);
    for (const std::string& warning : fit.warnings) context.warning(frameWarning(number, warning));
    if (!fit.jumps.empty() && !told) noteJumps(number, fit.jumps, context);
    told = told || !fit.jumps.empty();
    if (shown) shown->add(number, mesh.vertices, fit);
  };
  return frameFits(fitter, std::move(numbers), read, fitted);
}

std::string framesPlan(const FrameFitterSettings& settings, const Frames& frames) {
  return fmt::format("fit {} charges to {} boundary points for {} frames, {} to {}",
                     settings.sources, frameCollocation(settings), frames.wanted.size(),
                     frames.all[frames.wanted.front()].number,
                     frames.all[frames.wanted.back()].number);
}

std::string carryPlan(const std::string& input, const std::string& output, const Frames& frames) {
  const std::vector<std::string> paths = framePaths(FramePattern("--output", output), frames);
  return fmt::format("carry {} to {} to {}", input, paths.front(), paths.back());
}

}  // namespace innermap::tool
