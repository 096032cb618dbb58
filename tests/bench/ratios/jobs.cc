// The main job as users run it: from two mesh files to grids, slices, picture and report.
#include "pairs.h"
#include "program.h"

namespace innermap::bench {

Tables jobs(const Options& options) {
  Table table("The whole job: innermap map, horse reference to pose-03, all five files");
  const Pair pair = poses(options)[2];
  for (const int across : options.quick ? std::vector<int>{32} : std::vector<int>{128, 256, 512}) {
    std::vector<std::string> command{
        "map",          pair.source,           pair.target, "-o", options.scratch + "/out",
        "--resolution", std::to_string(across)};
    if (options.quick) command.insert(command.end(), {"--charges", "300"});
    const ProgramRun run = runProgram(command, options);
    table.add({{"across", across},
               {"voxels", run.report["grid"]["active_voxels"]},
               {"sources", run.report["solve"]["sources"]},
               {"seconds", run.seconds},
               {"to weights s", secondsToWeights(run.report)},
               {"rms", run.report["boundary_error"]["rms"]},
               {"p99", run.report["boundary_error"]["p99"]},
               {"peak GB", gigabytes(run.report)}});
  }
  return {table.json()};
}

}  // namespace innermap::bench
