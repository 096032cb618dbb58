// Accuracy asked for, not a number of charges: what each pair of meshes takes.
#include "innermap/field/field_file.h"
#include "pairs.h"
#include "program.h"

namespace innermap::bench {
namespace {

Json run(const Pair& pair, const char* tolerance, const Options& options) {
  const std::string file = options.scratch + "/map.ply";
  const ProgramRun done = runProgram({"fit", pair.source, pair.target, "-o", file, "--tolerance",
                                      tolerance, "--best-effort", "--one-to-one", "off"},
                                     options);
  const HarmonicField field = readField(file).steps.front();
  const FreshError error = freshError(field, pair);
  Json row{{"pair", pair.name},
           {"tolerance", tolerance},
           {"met", error.p99 <= std::stod(tolerance) ? "yes" : "NO"},
           {"to weights s", secondsToWeights(done.report)},
           {"sources", field.sources().size()},
           {"rms", error.rms},
           {"p99", error.p99},
           {"max", error.max},
           {"max / rms", error.max / error.rms}};
  row.update(done.costs(options));
  return row;
}

}  // namespace

Tables tolerance(const Options& options) {
  Table table("Tolerance for 99% of the boundary, measured at 30,000 fresh points");
  std::vector<Pair> pairs = poses(options);
  for (const char* name : {"spot", "homer", "cheburashka", "fandisk", "rocker-arm", "suzanne",
                           "teapot", "stanford-bunny"})
    pairs.push_back(bentAndTwistedPair(name, options));
  if (options.quick) pairs = {pairs[5]};
  for (const char* wanted : {"1e-3", "3e-4"}) {
    for (const Pair& pair : pairs) table.add(run(pair, wanted, options));
    if (options.quick) break;
  }
  table.note(
      "poses: the horse's; others onto copies of themselves, twisted by 90 degrees along the "
      "longest axis and bent along it into an eighth of a circle");
  return {table.json()};
}

}  // namespace innermap::bench
