// Uniform shells of charges: the iterative solver, and beside it the dense one.
#include "innermap/field/field_file.h"
#include "pairs.h"
#include "program.h"

namespace innermap::bench {
namespace {

Json run(const Pair& pair, std::size_t sources, std::size_t points, const std::string& solver,
         const Options& options) {
  const std::string file = options.scratch + "/map.ply";
  const ProgramRun done = runProgram(
      {"fit", pair.source, pair.target, "-o", file, "--charges", std::to_string(sources),
       "--collocation", std::to_string(points), "--solver", solver, "--interpolation", "linear"},
      options);
  const HarmonicField field = readField(file).steps.front();
  const FreshError error = freshError(field, pair);
  const Json& stages = done.report["seconds"];
  Json row{{"solver", solver},
           {"sources", field.sources().size()},
           {"points", points},
           {"sample s", stages.value("sample", 0.0)},
           {"fit s", stages.value("fit", 0.0)},
           {"to weights s", secondsToWeights(done.report)},
           {"iterations", done.report["solve"]["iterations"]},
           {"rms", error.rms},
           {"p99", error.p99},
           {"max", error.max}};
  // A dense solver begins with QR of the matrix.
  Work known;
  const double m = static_cast<double>(points), n = static_cast<double>(sources);
  if (solver == "dense") known.multiplyAdds = n * n * (m - n / 3);
  row.update(done.costs(options, known));
  return row;
}

}  // namespace

Tables solve(const Options& options) {
  const std::size_t unit = options.quick ? 20 : 1;
  const Pair pair = poses(options)[2];
  Table shells(
      "Uniform shells, from mesh to weights: horse reference to pose-03, 30,000 fresh points");
  shells.add(run(pair, 8000 / unit, 24000 / unit, "iterative", options));
  if (!options.quick)
    for (const std::size_t sources : {50000, 200000, 1000000})
      shells.add(run(pair, sources, 2 * sources, "iterative", options));

  Table beside("Iterative beside dense");
  const std::size_t sources = 4000 / unit;
  const Json dense = run(pair, sources, 3 * sources, "dense", options),
             iterative = run(pair, sources, 3 * sources, "iterative", options);
  beside.add(dense);
  beside.add(iterative);
  const auto ratio = [&](const char* figure) {
    return digits(iterative[figure].get<double>() / dense[figure].get<double>());
  };
  beside.note("rms of the iterative solver over the dense one's: " + ratio("rms") +
              "; seconds: " + ratio("to weights s"));
  return {shells.json(), beside.json()};
}

}  // namespace innermap::bench
