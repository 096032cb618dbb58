// Surfaces that were never related, laid onto one another by the program.
#include "innermap/core/error.h"
#include "program.h"

namespace innermap::bench {
namespace {

void addPair(const std::string& a, const std::string& b, const Options& options, Table& table) {
  const std::string output = options.scratch + "/a_on_b.ply";
  std::vector<std::string> command{"correspond", options.model(a), options.model(b),
                                   "-o",         output,           "--close"};
  if (options.quick) command.insert(command.end(), {"--no-refine"});
  const ProgramRun run = runProgram(command, options);
  if (run.exitCode != 0) throw Error("innermap correspond failed on " + a + " and " + b);
  const Json &seconds = run.report["seconds"], &found = run.report["correspondence"];
  const auto stage = [&](const char* name) { return seconds.value(name, 0.0); };
  Json row{{"pair", a + ", " + b},
           {"vertices", found["vertices"]},
           {"of B", found["target_vertices"]},
           {"lay out s", stage("embed_source") + stage("embed_target")},
           {"map s", stage("map")},
           {"flips", found["flips"]},
           {"energy sum", found["energy_sum"]},
           {"stretch 99%", found["stretch"]["p99"]},
           {"max", found["stretch"]["max"]}};
  row.update(run.costs(options));
  table.add(row);
}

}  // namespace

Tables correspond(const Options& options) {
  Table table("Any solid onto any solid: innermap correspond, 8 is an isometry's energy");
  addPair("spot.obj", "homer.obj", options, table);
  if (options.quick) return {table.json()};
  addPair("homer.obj", "cheburashka.obj", options, table);
  addPair("stanford-bunny.obj", "homer.obj", options, table);
  return {table.json()};
}

}  // namespace innermap::bench
