#include "block_share.h"

#include <fmt/format.h>

#include <algorithm>
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
    frames.all.push_back(
        {static_cast<std::int64_t>(frames.all.size() + 1),
         fmt::format("{},{},{}{}", o.x(), o.y(), o.z(),
                     block.density > 0 ? fmt::format(" of density {}", block.density) : "")});
    frames.weights.push_back(block.voxels);
  }
  return frames;
}

}  // namespace

std::string sharesOf(const std::string& output) { return output + kFolder; }

namespace {

std::filesystem::path named(const std::string& folder) {
  const std::filesystem::path path(folder);
  return path.filename().empty() ? path.parent_path() : path;
}

}  // namespace

bool isShares(const std::string& folder) {
  return named(folder).extension() == kFolder && !named(folder).stem().empty();
}

std::string outputOf(const std::string& shares) {
  if (!isShares(shares))
    throw DataError(shares + ": its name must end in " + kFolder +
                    ", as that of a folder beside the output does");
  return named(shares).replace_extension().string();
}

JoinedParts partsWithFiles(JoinedParts joined, const FramePattern& pattern, bool broken) {
  std::vector<Part> whole;
  for (Part& part : joined.parts)
    if (part.broken.empty() ? hasOutput(part, pattern.path(part.frame)) : broken)
      whole.push_back(std::move(part));
    else
      joined.missing.push_back(part.frame);
  joined.parts = std::move(whole);
  std::sort(joined.missing.begin(), joined.missing.end());
  return joined;
}

std::string missingText(const std::string& folder, const JoinedParts& joined) {
  return fmt::format("{}: {} of {} {}s are missing: {}", folder, joined.missing.size(),
                     joined.run.frames.size(), unitOf(joined.run), framesText(joined.missing));
}

std::vector<std::string> blockFiles(const std::string& shares) {
  const FramePattern pattern = blockPattern(shares);
  const JoinedParts joined = partsWithFiles(readParts(shares), pattern, false);
  if (joined.run.command != "evaluate" && joined.run.command != "voxelize")
    throw DataError(shares + ": blocks of " + joined.run.command +
                    " hold no finished grids; make the file with innermap join");
  if (!joined.missing.empty()) throw DataError(missingText(shares, joined) + "; make their shares");
  std::vector<std::string> files;
  for (const Part& part : joined.parts) files.push_back(pattern.path(part.frame));
  return files;
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
  if (!writesJobs(options, context) && !inShares(options)) context.output(output);
}

namespace {

void makeShare(const ShareOptions& options, const BlockWork& work, Context& context) {
  const std::vector<VoxelBlock> blocks = work.blocks();
  context.requireMemory({"making a block of the volume", work.memory});
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
    const GridBlock block = context.timed(work.stage, [&] { return work.make(blocks[index]); });
    const auto write = [&] { writeVdb(pattern.path(file.number), block.grids); };
    writeFrame(
        file.number, [&] { context.timed("write", write); }, frames.unit);
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
