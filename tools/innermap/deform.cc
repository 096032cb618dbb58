// `innermap deform`: what is inside a rest pose carried through the frames of an animation.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "commands.h"
#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "deform_geometry.h"
#include "frame_loop.h"
#include "innermap/core/version.h"
#include "innermap/io/vdb_file.h"
#include "job_cost.h"
#include "report/report_figures.h"
#include "share.h"
#include "transfer_options.h"

namespace innermap::tool {
namespace {

constexpr char kInputs[] = "innermap_inputs";

struct DeformOptions {
  std::string rest, volume, output;
  FrameOptions frames;
  TransferOptions transfer;
  GeometryOptions geometry;
  ShareOptions farm;
  bool velocity = false, force = false;
  double shutter = kUsualShutter;
  double framesPerSecond() const { return frames.animation.framesPerSecond; }
};

// What decides an output beside the frames' files.
std::string settingsText(const DeformOptions& o, const SpaceSettings& space) {
  const FrameFitterSettings& f = o.frames.fitting;
  const TransferOptions& t = o.transfer;
  const auto number = [](const auto& v) { return v ? fmt::format("{:.17g}", double(*v)) : "-"; };
  const AnimationSettings& a = o.frames.animation;
  const std::string rest = fmt::format("{};{};{};{};{};{};{}", number(a.restFrame), a.mesh,
                                       a.animation, number(space.up), number(space.unitScale),
                                       number(space.outUp), number(space.outUnitScale));
  return fmt::format(
      "{};{};{};{};{};{};{};{};{};{};{};{};{:.17g};{};{};{};{};{};{}", versionText(), f.sources,
      frameCollocation(f), number(f.distance), f.seed, t.grids, static_cast<int>(t.carry.sampling),
      t.carry.allDensities, t.carry.densityLimit, t.densities, t.stress, t.strain, t.outside,
      t.fadeTo, number(t.grid.resolution), number(t.grid.voxelSize), static_cast<int>(t.names),
      o.velocity ? fmt::format("{:.17g}/{:.17g}", o.framesPerSecond(), o.shutter) : "-", rest);
}

// Tells which inputs and settings an output was made from.
class Inputs {
 public:
  Inputs(const DeformOptions& options, const Frames& frames, const SpaceSettings& space)
      : frames_(frames),
        neighbours_(options.velocity),
        common_(fmt::format("rest {}, volume {}, settings {:016x}", fingerprintOf(options.rest),
                            fingerprintOf(options.volume), hashOf(settingsText(options, space)))) {}

  std::string of(std::size_t index) const {
    std::string text = common_ + ", frame " + fingerprint(index);
    if (!neighbours_) return text;
    if (index > 0) text += ", before " + numbered(index - 1);
    if (index + 1 < frames_.all.size()) text += ", after " + numbered(index + 1);
    return text;
  }

 private:
  std::string fingerprint(std::size_t index) const { return frames_.source->fingerprint(index); }
  // A neighbour that cannot be read plays no part.
  std::string numbered(std::size_t index) const try {
    return fmt::format("{} {}", frames_.all[index].number, fingerprint(index));
  } catch (const FileError&) {
    return "none";
  }

  const Frames& frames_;
  const bool neighbours_;
  const std::string common_;
};

// Whether a whole file made from these inputs is there.
bool isFinished(const std::string& path, const std::string& inputs) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  try {
    const VdbInfo info = readVdbInfo(path);
    const auto made = info.metadata.getMetadata<openvdb::StringMetadata>(kInputs);
    return made && made->value() == inputs;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception&) {
    return false;
  }
}

FrameCarry frameCarry(const DeformOptions& o, const openvdb::GridPtrVec& grids) {
  return {carrySettings(o.transfer),
          frameOutside(o.transfer.outside, fadeTo(o.transfer)),
          carriedVoxels(grids, o.transfer.grid),
          o.velocity,
          o.framesPerSecond(),
          o.shutter};
}

// The set-up that all frames share.
class Deformer {
 public:
  Deformer(const DeformOptions& options, const Frames& frames, SourceBoundary rest,
           const openvdb::GridPtrVec& grids, Context& context)
      : options_(options),
        context_(context),
        frames_(frames),
        fitter_(makeFrameFitter(std::move(rest), options.frames.fitting, context)),
        fits_(makeFrameFits(fitter_, frames, context)),
        how_(frameCarry(options, grids)),
        pusher_(fitter_, grids, pushSettings(how_)) {}

  double voxelSize() const { return pusher_.voxelSize(); }
  // Of all frames so far: the densities that grow most beside their solids.
  const std::map<std::string, JudgedDensity>& densities() const { return densities_; }

  DeformedRow run(std::size_t index, const std::string& path, const std::string& inputs) {
    const FrameFile& frame = frames_.all[index];
    const std::shared_ptr<const FrameFit> fit = fits_.at(index);
    // No structured binding: lambdas cannot capture one in C++17.
    const FramePush pushed =
        pusher_.push({fit.get(), frame.number}, carriedFields(how_, fits_, index));
    const auto& result = pushed.result;
    addSeconds(context_.report().seconds, pushed.seconds);
    for (const std::string& warning : result.warnings)
      context_.warning(frameWarning(frame.number, warning));
    if (options_.velocity)
      for (const openvdb::GridBase::Ptr& grid : result.grids)
        grid->insertMeta("innermap_frames_per_second",
                         openvdb::DoubleMetadata(options_.framesPerSecond()));
    openvdb::MetaMap file;
    file.insertMeta(kInputs, openvdb::StringMetadata(inputs));
    writeFrame(frame.number,
               [&] { writeGridFile(path, result.grids, options_.transfer.names, context_, file); });
    judge(result, *fit, frame.number);
    const InverseStatistics& s = result.statistics;
    const JudgedFrame judged = judgedFrame({fit.get(), frame.number});
    return {{s, fit->error, judged.folded, judged.outside},
            judged,
            fmt::format("{:>10} {:>10.4f}", s.voxels, 100 * s.invertedInside())};
  }

 private:
  void judge(const PushResult& result, const FrameFit& fit, std::int64_t number) {
    const double volumes = volumeRatio(fitter_.solid().volume(), fit.boundary.volume);
    for (const CarriedMass& mass : result.masses) {
      const JudgedDensity now{mass.name, fmt::format("in frame {} ", number),
                              std::min(mass.largestRatio, options_.transfer.carry.densityLimit),
                              volumes};
      JudgedDensity& worst = densities_[mass.name];
      if (worst.grid.empty() || now.growth * now.volumes > worst.growth * worst.volumes)
        worst = now;
    }
  }

  const DeformOptions& options_;
  Context& context_;
  const Frames& frames_;
  const FrameFitter fitter_;
  FrameFits fits_;
  std::map<std::string, JudgedDensity> densities_;
  const FrameCarry how_;
  const FramePusher pusher_;
};

void check(const DeformOptions& options, const Frames& frames) {
  std::string extension = std::filesystem::path(options.output).extension().string();
  const bool cache = isPointCache(options.output);
  requireFitting(options.volume, cache ? options.volume : options.output, options.transfer,
                 options.geometry);
  if (isGeometryFile(options.volume)) {
    if (options.velocity) throw UsageError("--velocity: is for volumes; leave it out");
    if (!options.frames.usd.empty()) throw UsageError("--usd: is for volumes; leave it out");
    if (cache && equalsIgnoringCase(extensionOf(options.volume), ".stl"))
      throw FileError(options.volume,
                      "has no vertices that a point cache could hold; save it as .ply first");
  } else if (extension != ".vdb")
    throw UsageError("--output: '" + options.output + "' must end in .vdb, as in a.####.vdb");
  if (cache && inShares(options.farm))
    throw UsageError("--output: all frames go into one file, '" + options.output +
                     "'; for shares give a file a frame");
  if (options.velocity && frames.all.size() < 2)
    throw UsageError("--velocity: needs at least two frames; give more or leave it out");
  // Refuses what makes no sense before anything is read; which motion fits is not known yet.
  fadeTo(options.transfer);
}

// Those whose output is not there or was made from something else.
Frames framesLeft(const DeformOptions& options, const Frames& frames, const FramePattern& pattern,
                  const Inputs& inputs, Context& context) {
  Frames left = frames;
  left.wanted.clear();
  for (const std::size_t index : frames.wanted) {
    bool toDo = true;
    try {
      toDo = options.force || !isFinished(pattern.path(frames.all[index].number), inputs.of(index));
    } catch (const FileError&) {  // a frame that cannot be read is told of in its turn
    }
    if (toDo) left.wanted.push_back(index);
  }
  const std::size_t finished = frames.wanted.size() - left.wanted.size();
  context.report().add("frames", finishedFigures(finished));
  if (finished > 0)
    context.note(fmt::format("{} of {} frames are finished already; --force makes them again",
                             finished, frames.wanted.size()));
  return left;
}

// The grids that are carried, and what that needs. Throws as requireNoVelocity().
struct Inside {
  openvdb::GridPtrVec grids;
  MemoryNeed need;
};

Inside readInside(const DeformOptions& o, const Solid& solid, Context& context) {
  openvdb::GridPtrVec grids = readVolume(o.volume, o.transfer, context);
  const FrameCarry how = frameCarry(o, grids);
  requireNoVelocity(how, grids, o.transfer.names, o.volume, optionName);
  MemoryNeed need = framesNeed(o.frames.fitting, frameCarryMemory(solid, grids, how));
  return {std::move(grids), std::move(need)};
}

std::vector<JobPhase> phasesOf(const DeformOptions& options, const Solid& solid,
                               const openvdb::GridPtrVec& grids, const Frames& frames) {
  const std::size_t charges = options.frames.fitting.sources;
  if (grids.empty())  // geometry, which takes no time beside the fit
    return framePhases(charges, frames.wanted.size(), stageOf("frames: volume", JobSize{}));
  JobSize size = jobSize(solid, carriedVoxels(grids, options.transfer.grid), charges);
  size.items = static_cast<double>(grids.size()) * size.inside;
  return framePhases(charges, frames.wanted.size(), stageOf("frames: volume", size));
}

// The outputs are the result: there is nothing to join.
void writeJobs(const DeformOptions& options, const Frames& frames, Context& context) {
  const SourceBoundary rest = readRest(options.rest, frames, context);
  Inside inside{{}, framesNeed(options.frames.fitting, 0)};
  if (!isGeometryFile(options.volume)) inside = readInside(options, rest.solid, context);
  writeShareJobs(options.farm,
                 {frames.wanted.size(), phasesOf(options, rest.solid, inside.grids, frames),
                  inside.need.bytes},
                 context);
}

void run(const DeformOptions& options, Context& context) {
  const FramePattern pattern("--output", options.output);
  Frames frames = listFrames(options.frames, options.rest, context);
  check(options, frames);
  requireUsdOfAll(options.frames, inShares(options.farm));
  if (writesJobs(options.farm, context)) return writeJobs(options, frames, context);
  cutToShare(options.farm.share, frames);
  if (frames.wanted.empty()) return context.print("the share has no frames\n");
  // Made first, and gone again if nothing comes into it.
  std::optional<PendingFolder> folder;
  if (!context.dryRun()) folder.emplace(pattern.folder());
  if (isPointCache(options.output))
    context.output(options.output);
  else
    context.outputs(framePaths(pattern, frames));
  announceUsd(options.frames, context);
  if (isGeometryFile(options.volume))
    return deformGeometry({options.rest, options.volume, options.output, options.framesPerSecond(),
                           options.frames, options.transfer, options.geometry},
                          frames, context);
  std::optional<Inputs> inputs;
  Frames left = frames;
  if (!context.dryRun())
    context.timed("compare", [&] {
      inputs.emplace(options, frames, context.space());
      left = framesLeft(options, frames, pattern, *inputs, context);
    });
  if (left.wanted.empty()) return writeUsd(options.frames, pattern, frames, context);
  SourceBoundary rest = readRest(options.rest, frames, context);
  Inside inside = readInside(options, rest.solid, context);
  context.expect(phasesOf(options, rest.solid, inside.grids, left));
  if (!context.begins({framesPlan(options.frames.fitting, frames),
                       carryPlan(options.volume, options.output, frames)},
                      inside.need))
    return;
  Deformer deformer(options, left, std::move(rest), inside.grids, context);
  const DeformedFrames made = deformFrames(
      left, options.frames, true, fmt::format("{:>10} {:>10}", "voxels", "found %"), context,
      [&](std::size_t index) {
        return deformer.run(index, pattern.path(frames.all[index].number), inputs->of(index));
      });
  writeUsd(options.frames, pattern, frames, context);
  context.report().add("grid", voxelSizeFigures(deformer.voxelSize()));
  // Of those that were made now; the others' are missing.
  context.report().add("frames", concludeDeformed(made, left, options.frames, context));
  for (const auto& [name, density] : deformer.densities())
    context.judge(judgeDensity(density, options.transfer.verdict));
  context.print(secondsText(made.results, context));
}

}  // namespace

Command makeDeformCommand() {
  auto o = std::make_shared<DeformOptions>();
  Command c("deform", "Carry a volume or geometry in a rest pose through an animation");
  c.description(
      "INSIDE, grids or geometry, lies inside SOURCE. For each frame, deform maps the inside of "
      "SOURCE onto that of the frame and carries INSIDE along, as push does. It sets up once for "
      "all frames. All outputs have the same voxel size and lattice, and a frame does not depend "
      "on which others are made. It skips frames whose output was already made from the same "
      "files and settings (for geometry it makes all). It reports and skips a frame that cannot "
      "be read or fitted; the exit code is then 1.");
  c.positional("SOURCE", &o->rest, "mesh of the rest pose: .obj, .ply, .off or .stl; or glTF");
  c.positional("INSIDE", &o->volume,
               "the things to carry, in the rest pose's world space: grids (.vdb) or geometry "
               "(.obj, .ply, .off, .stl; cells in .vtu, .msh, .mesh)");
  addFrameArgument(c, o->frames);
  c.option("--output", "FILES", &o->output,
           "the files to write, of INSIDE's kind, with #### or %04d for the frame's number, which "
           "otherwise goes before the ending; or one point cache (.mdd, .pc2) with all frames of "
           "geometry; the folder is made if missing")
      .shortName("-o")
      .required();
  addFrameOptions(c, o->frames);
  c.flag("--force", &o->force, "make finished frames again");
  c.flag("--velocity", &o->velocity,
         "also write a grid velocity (v with --names houdini) for motion blur, in world units per "
         "second, from the neighbouring frames");
  c.option("--shutter", "FRAMES", &o->shutter,
           "time that the shutter is open, for --velocity: the grid extends around the solid as "
           "far as it moves in that time, which keeps the blur whole")
      .atLeast(0)
      .atMost(10);
  addTransferOptions(c, o->transfer);
  addGeometryOptions(c, o->geometry, false);
  addShareOptions(c, o->farm, "frames", "All shares together write the files of one run");
  c.example(
      "innermap deform rest.obj smoke.vdb walk.pc2 -o 'out/smoke.####.vdb' --usd out/smoke.usda");
  c.example("innermap deform rest.obj bones.obj 'walk.*.obj' -o 'out/bones.####.obj'");
  c.example("innermap deform rest.obj hair.obj walk.pc2 -o out/hair.pc2");
  c.example("innermap deform rest.obj smoke.vdb 'walk.*.obj' -o 'out/smoke.####.vdb' --density");
  c.example(
      "innermap deform rest.obj smoke.vdb 'walk.*.obj' -o 'out/smoke.%04d.vdb' --velocity --fps "
      "25");
  return c.running(o, run);
}

}  // namespace innermap::tool
