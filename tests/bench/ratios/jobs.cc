// The main jobs as users run them, from mesh files to grids, slices, picture and report.
#include "pairs.h"
#include "program.h"

namespace innermap::bench {
namespace {

Json mapRow(const Pair& pair, int across, const Options& options) {
  std::vector<std::string> command{"map",
                                   pair.source,
                                   pair.target,
                                   "-o",
                                   options.scratch + "/out",
                                   "--resolution",
                                   std::to_string(across),
                                   "--best-effort"};
  if (options.quick) command.insert(command.end(), {"--charges", "300"});
  const ProgramRun run = runProgram(command, options);
  Json row{{"across", across},
           {"voxels", run.report["grid"]["active_voxels"]},
           {"sources", run.report["solve"]["sources"]},
           {"to weights s", secondsToWeights(run.report)},
           {"rms", run.report["boundary_error"]["rms"]},
           {"p99", run.report["boundary_error"]["p99"]}};
  row.update(run.costs(options));
  return row;
}

Table maps(const std::vector<int>& sizes, const Options& options) {
  Table table("The whole job: innermap map, horse reference to pose-03, all five files");
  for (const int across : sizes) table.add(mapRow(poses(options)[2], across, options));
  return table;
}

Table strangers(const Options& options) {
  Table table("The whole job between strangers: innermap map, spot to homer, all five files");
  const Pair pair{"", options.model("spot.obj"), options.model("homer.obj")};
  table.add(mapRow(pair, options.quick ? 32 : 128, options));
  return table;
}

Table levelSets(const std::vector<int>& sizes, const Options& options) {
  Table table("From a mesh file to a level set in a file: innermap voxelize, the horse");
  for (const int across : sizes) {
    const ProgramRun run =
        runProgram({"voxelize", poses(options)[0].source, "-o", options.scratch + "/set.vdb",
                    "--resolution", std::to_string(across)},
                   options);
    Json row{{"across", across}, {"level set s", run.report["seconds"]["level set"]}};
    row.update(run.costs(options));
    table.add(row);
  }
  return table;
}

// One run of few frames and one of all: the difference is that of further frames.
Table frames(const Options& options) {
  const int few = 2, all = options.quick ? 4 : 24;
  Table table("A frame of an animation with its grids' energies: innermap sequence, the gallop");
  ProgramRun runs[2];
  for (const int i : {0, 1}) {
    std::vector<std::string> command{"sequence",
                                     options.model("horse-gallop/reference.obj"),
                                     options.model("horse-gallop/frame.####.obj"),
                                     "-o",
                                     options.scratch + "/sequence",
                                     "--frames",
                                     "1-" + std::to_string(i ? all : few)};
    if (options.quick) command.insert(command.end(), {"--charges", "300", "--resolution", "16"});
    runs[i] = runProgram(command, options);
    Json row{{"frames", i ? all : few}, {"a further frame s", 0.0}};
    if (i) row["a further frame s"] = (runs[1].seconds - runs[0].seconds) / (all - few);
    row.update(runs[i].costs(options));
    table.add(row);
  }
  return table;
}

}  // namespace

Tables jobs(const Options& options) {
  const std::vector<int> sizes =
      options.quick ? std::vector<int>{32} : std::vector<int>{128, 256, 512};
  return {maps(sizes, options).json(), strangers(options).json(), levelSets(sizes, options).json(),
          frames(options).json()};
}

}  // namespace innermap::bench
