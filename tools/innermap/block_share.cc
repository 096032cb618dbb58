#include "block_share.h"

#include <fmt/format.h>

#include <filesystem>

#include "innermap/io/vdb_file.h"
#include "job_cost.h"

namespace innermap::tool {
namespace {

constexpr const char* kFolder = ".shares";
constexpr const char* kTotals = "totals";

Frames framesOf(const std::vector<VoxelBlock>& blocks) {
  Frames frames;
  frames.unit = "block";
  for (const VoxelBlock& block : blocks) {
    const openvdb::Coord& o = block.origin;
    frames.wanted.push_back(frames.all.size());
    frames.all.push_back({static_cast<std::int64_t>(frames.all.size() + 1),
                          fmt::format("{},{},{}", o.x(), o.y(), o.z())});
    frames.weights.push_back(block.voxels);
  }
  return frames;
}

}  // namespace

std::string sharesOf(const std::string& output) { return output + kFolder; }

std::string outputOf(const std::string& shares) {
  std::filesystem::path path(shares);
  if (path.filename().empty()) path = path.parent_path();
  if (path.extension() != kFolder || path.stem().empty())
    throw DataError(shares + ": its name must end in " + kFolder +
                    ", as that of a folder beside the output does");
  return path.replace_extension().string();
}

FramePattern blockPattern(const std::string& shares) {
  return {"--output", (std::filesystem::path(shares) / "block.####.vdb").string()};
}

BlockWork evaluationWork(const Solid& solid, const EvaluationOptions& options, std::size_t charges,
                         const MapGridKind& kind) {
  const MapGridSettings settings = mapGridSettings(options);
  const std::vector<JobPhase> all = evaluationPhases(jobSize(solid, settings, charges));
  BlockWork work;
  work.stage = "evaluate";
  work.blocks = [&solid, grid = options.grid] {
    return voxelBlocks(solid, grid.in<LevelSetSettings>());
  };
  work.memory = mapBlockMemory(kind);
  work.joinMemory = mapGridMemory(solid, settings, kind);
  // Folds, what is outside, and cells are the join's.
  work.making = {all[0], all[1], all.back()};
  work.joining = {all.begin() + 2, all.end()};
  return work;
}

void addBlockOptions(Command& command, ShareOptions& options) {
  addShareOptions(command, options, "blocks of 128 voxels along each side",
                  "The blocks go to OUTPUT.shares; innermap join makes one file of all. A share "
                  "skips blocks that are finished");
}

void beginBlocks(const ShareOptions& options, const std::string& output, Context& context) {
  applyCpuTarget(options);
  if (!writesJobs(options, context) && !inShares(options)) context.output(output);
}

namespace {

void makeShare(const ShareOptions& options, const BlockWork& work, Context& context) {
  const std::vector<VoxelBlock> blocks = work.blocks();
  context.requireMemory("making a block of the volume", work.memory, "raise --max-memory");
  Frames frames = framesOf(blocks);
  const std::string folder = sharesOf(work.output);
  const FramePattern pattern = blockPattern(folder);
  FrameShare share(options.share, folder, work.inputs, &pattern, frames, context);
  if (context.dryRun())
    return context.plan({"do a share of: " + work.doing, "write its blocks to " + folder},
                        work.memory);
  if (frames.wanted.empty()) return;
  context.outputs(framePaths(pattern, frames));
  share.begin({});
  PartValues made;
  const auto makeBlock = [&](std::size_t index) {
    const FrameFile& file = frames.all[index];
    const GridBlock block =
        context.timed(work.stage, [&] { return work.make(blocks[index].origin); });
    writeFrame(file, [&] {
      context.timed("write", [&] { writeVdb(pattern.path(file.number), block.grids); });
    });
    made = {{kTotals, block.totals}};
  };
  share.conclude(runFrames(frames, true, context, makeBlock,
                           [&](const FrameResult& result) { share.ended(result, made); }));
}

}  // namespace

ShareRun shareRun(const BlockWork& work) {
  ShareRun run;
  run.unit = "block";
  run.units = work.blocks().size();
  JobPhase blocks{"blocks"};
  blocks.seconds = totalSeconds(work.making);
  run.phases = {blocks};
  run.bytes = work.memory;
  run.joined = sharesOf(work.output);
  run.joining = work.joining;
  run.joiningBytes = work.joinMemory;
  return run;
}

bool madeInShares(const ShareOptions& options, const BlockWork& work, Context& context) {
  if (!inShares(options)) return false;
  if (options.share.empty())
    writeShareJobs(options, shareRun(work), context);
  else
    makeShare(options, work, context);
  return true;
}

std::vector<GridBlock> readShares(const std::string& output, const std::string& inputs,
                                  Context& context) {
  const std::string folder = sharesOf(output);
  const JoinedParts& joined = *context.joined();
  if (joined.run.inputs != inputs)
    throw DataError(folder +
                    ": its parts were made from other files than those that are there "
                    "now; make the shares again");
  const FramePattern pattern = blockPattern(folder);
  std::vector<GridBlock> blocks;
  context.timed("read", [&] {
    for (const Part& part : joined.parts) {
      const std::string path = pattern.path(part.frame);
      requireOutput(part, path);
      blocks.push_back({readVdb(path).grids, numbersAt(part.values, kTotals), path});
    }
  });
  return blocks;
}

}  // namespace innermap::tool
