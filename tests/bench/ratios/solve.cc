// Uniform shells of charges: the iterative solver, and beside it the dense one and plain QR.
#include <lapacke.h>

#include "innermap/field/field_file.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/solve/kernel_sum.h"
#include "pairs.h"
#include "program.h"
#include "sample/surface_samples.h"
#include "solve/detail/blocked_qr.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void openblas_set_num_threads(int threads);

namespace innermap::bench {
namespace {

constexpr std::size_t kFresh = 30000;

struct Case {
  std::size_t sources, points;
  std::string solver;
};

struct Solved {
  Json row;
  double seconds = 0, rms = 0;
  std::size_t points = 0, sources = 0;
};

Solved run(const Pair& pair, const Case& c, const Options& options) {
  const std::string file = options.scratch + "/map.ply";
  const ProgramRun done =
      runProgram({"fit", pair.source, pair.target, "-o", file, "--charges",
                  std::to_string(c.sources), "--collocation", std::to_string(c.points), "--solver",
                  c.solver, "--interpolation", "linear"},
                 options);
  const HarmonicField field = readField(file).steps.front();
  const FreshError error = freshError(field, pair, kFresh);
  Solved out;
  out.seconds = secondsToWeights(done.report);
  out.rms = error.rms;
  out.points = c.points;
  out.sources = field.sources().size();
  out.row = {{"solver", c.solver},        {"sources", out.sources},
             {"points", c.points},        {"to weights s", out.seconds},
             {"process s", done.seconds}, {"iterations", done.report["solve"]["iterations"]},
             {"rms", error.rms},          {"p99", error.p99},
             {"max", error.max},          {"peak GB", gigabytes(done.report)}};
  return out;
}

// Seconds of QR of a kernel matrix, and which of two ways was the faster one.
std::pair<double, std::string> qrSeconds(const Pair& pair, std::size_t rows, std::size_t columns,
                                         int threads) {
  const Mesh mesh = readMesh(pair.source);
  const Points points =
      interpolate(mesh.vertices, mesh.triangles, randomSamples(mesh, rows + columns));
  const Points collocation(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(rows));
  const Points sources(points.begin() + static_cast<std::ptrdiff_t>(rows), points.end());
  Matrix a(rows, columns);
  fillKernelMatrix(collocation, sources, 1, a.data(), rows);
  Matrix copy = a;
  Stopwatch watch;
  const BlockedQr ours(std::move(copy));
  const double blocked = watch.lap();
  openblas_set_num_threads(threads);
  std::vector<double> tau(columns);
  watch.lap();
  LAPACKE_dgeqrf(LAPACK_COL_MAJOR, static_cast<lapack_int>(rows), static_cast<lapack_int>(columns),
                 a.data(), static_cast<lapack_int>(rows), tau.data());
  const double lapack = watch.lap();
  if (blocked <= lapack) return {blocked, "BlockedQr"};
  return {lapack, "LAPACK's dgeqrf"};
}

}  // namespace

Tables solve(const Options& options) {
  const std::size_t unit = options.quick ? 20 : 1;
  const Pair pair = poses(options)[2];
  Table shells(
      "Uniform shells, from mesh to weights: horse reference to pose-03, 30,000 fresh points");
  std::vector<Case> cases{{8000, 24000, "iterative"}};
  if (!options.quick)
    cases.insert(cases.end(), {{50000, 100000, "iterative"}, {200000, 400000, "iterative"}});
  Solved first;
  for (Case& c : cases) {
    c.sources /= unit;
    c.points /= unit;
    const Solved solved = run(pair, c, options);
    if (first.row.is_null()) first = solved;
    shells.add(solved.row);
  }
  const auto [seconds, way] = qrSeconds(pair, first.points, cases[0].sources, options.threads);
  shells.note("QR of the dense matrix, " + std::to_string(first.points) + " x " +
              std::to_string(cases[0].sources) + ", by " + way + ": " + digits(seconds) + " s, " +
              digits(seconds / first.seconds) + " times the first row from mesh to weights");

  Table beside("Iterative beside dense");
  for (std::size_t sources : {2000, 4000}) {
    sources /= unit;
    const Solved dense = run(pair, {sources, 3 * sources, "dense"}, options);
    const Solved iterative = run(pair, {sources, 3 * sources, "iterative"}, options);
    beside.add(dense.row);
    beside.add(iterative.row);
    beside.note(
        "rms of the iterative solver over the dense one's: " + digits(iterative.rms / dense.rms) +
        "; seconds: " + digits(iterative.seconds / dense.seconds));
  }
  return {shells.json(), beside.json()};
}

}  // namespace innermap::bench
