// Volumes through a map: a density and a vector grid pushed into a pose and pulled back.
#include "pairs.h"
#include "program.h"

namespace innermap::bench {
namespace {

double millionsASecond(const Json& voxels, const Json& seconds) {
  return voxels.get<double>() / seconds.get<double>() / 1e6;
}

}  // namespace

Tables transfer(const Options& options) {
  Table table("A density and a vector grid through the map, horse reference to pose-03");
  const Pair pair = poses(options)[2];
  const std::string map = options.scratch + "/map.ply", rest = options.scratch + "/rest.vdb",
                    posed = options.scratch + "/posed.vdb", back = options.scratch + "/back.vdb";
  std::vector<std::string> fit{"fit", pair.source, pair.target, "-o", map};
  if (options.quick) fit.insert(fit.end(), {"--charges", "300"});
  const ProgramRun fitted = runProgram(fit, options);
  for (const int across : options.quick ? std::vector<int>{32} : std::vector<int>{128, 256, 512}) {
    runProgram({"evaluate", map, "-o", rest, "--resolution", std::to_string(across)}, options);
    const ProgramRun push = runProgram(
        {"push", map, rest, "-o", posed, "--grids", "density,map", "--densities", "density"},
        options);
    const ProgramRun pull =
        runProgram({"pull", map, posed, "-o", back, "--densities", "density"}, options);
    const Json &inverse = push.report["inverse"], &mass = push.report["mass"];
    Json row{
        {"across", across},
        {"voxels", inverse["voxels"]},
        {"push s", push.report["seconds"]["push"]},
        {"push Mvoxels/s", millionsASecond(inverse["voxels"], push.report["seconds"]["push"])},
        {"inverted %", 100 * inverse["inverted_fraction"].get<double>()},
        {"mass error %",
         100 * (mass["density_after"].get<double>() / mass["density_before"].get<double>() - 1)},
        {"pull s", pull.report["seconds"]["pull"]},
        {"pull Mvoxels/s",
         millionsASecond(pull.report["pull"]["voxels"], pull.report["seconds"]["pull"])}};
    row.update(push.costs(options));
    table.add(row);
  }
  table.note("charges: " + std::to_string(fitted.report["solve"]["sources"].get<int>()) +
             "; push s and pull s: without reading, checking and writing; process s and what "
             "follows: push with them");
  return {table.json()};
}

}  // namespace innermap::bench
