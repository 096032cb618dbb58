#include "block_share.h"

#include <fmt/format.h>

#include <filesystem>

#include "innermap/io/vdb_file.h"

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

void makeShare(const ShareOptions& options, const BlockWork& work, Context& context) {
  Frames frames = framesOf(work.blocks);
  const std::string folder = sharesOf(work.output);
  const FramePattern pattern = blockPattern(folder);
  FrameShare share(options.share, folder, work.inputs, &pattern, frames, context);
  if (frames.wanted.empty() || context.dryRun()) return;
  context.outputs(framePaths(pattern, frames));
  share.begin({});
  PartValues made;
  const auto makeBlock = [&](std::size_t index) {
    const FrameFile& file = frames.all[index];
    const MapBlock block =
        context.timed("evaluate", [&] { return work.make(work.blocks[index].origin); });
    writeFrame(file, [&] {
      context.timed("write", [&] { writeVdb(pattern.path(file.number), block.grids); });
    });
    made = {{kTotals, block.totals}};
  };
  share.conclude(runFrames(frames, true, context, makeBlock,
                           [&](const FrameResult& result) { share.ended(result, made); }));
}

std::vector<MapBlock> readShares(const std::string& output, const std::string& inputs,
                                 Context& context) {
  const std::string folder = sharesOf(output);
  const JoinedParts& joined = *context.joined();
  if (joined.run.inputs != inputs)
    throw DataError(folder +
                    ": its parts were made from other files than those that are there "
                    "now; make the shares again");
  const FramePattern pattern = blockPattern(folder);
  std::vector<MapBlock> blocks;
  context.timed("read", [&] {
    for (const Part& part : joined.parts) {
      const std::string path = pattern.path(part.frame);
      requireOutput(part, path);
      blocks.push_back({readVdb(path).grids, numbersAt(part.values, kTotals)});
    }
  });
  return blocks;
}

}  // namespace innermap::tool
