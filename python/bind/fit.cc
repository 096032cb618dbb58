#include <fmt/format.h>

#include "bind/arrays.h"
#include "bind/call.h"
#include "bind/correspondence.h"
#include "bind/keywords.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/boundary/fit_map.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/read.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct FitOptions {
  FitMapSettings fit;
  ShellSettings shell;
  std::optional<double> tolerance;
  std::optional<std::size_t> sources, collocation;
  CorrespondOptions correspond;
  CallOptions call;

  FitOptions() { correspond.map.subdivide = kLaidOnSubdivide; }
  void describe(Keywords& k);
  void describeShell(Keywords& k);
  // laidOn: the source is laid onto a stranger.
  FitMapSettings settings(bool laidOn) const;
};

void FitOptions::describe(Keywords& k) {
  k.number("tolerance", &tolerance, {kSmallestTolerance, 1},
           "charges are placed where the error is until 99% of the boundary lies within it, a "
           "fraction of the target's diagonal; 0.001 if not given, 0.002 where one mesh is laid "
           "onto the other first; not with what places a number of charges");
  k.count("max_sources", &fit.maxSources, {1000, 1000000}, "charges that the tolerance may take");
  k.choice<OneToOne>(
      "one_to_one", &fit.oneToOne,
      {{"auto", OneToOne::automatic}, {"on", OneToOne::on}, {"off", OneToOne::off}},
      "go in steps through intermediate shapes where one harmonic map folds; auto: where it folds "
      "over 0.5% of the inside or takes over 1% of it out of the target; on: until nothing that "
      "is checked folds; off: one harmonic map");
  k.count("max_steps", &fit.maxSteps, {1, 256}, "steps at most");
  k.choice<Interpolation>("interpolation", &fit.interpolation,
                          {{"auto", Interpolation::automatic},
                           {"linear", Interpolation::linear},
                           {"smooth", Interpolation::smooth}},
                          "what the target is between vertices: linear, as its triangles; smooth, "
                          "when vertices sample a smooth deformation; auto: by the error at "
                          "held-out vertices");
  k.count("seed", &fit.seed, {0, 1e15}, "of all random choices");
  describeShell(k);
  correspond.describe(k);
  call.describe(k);
  call.describeTime(k);
}

void FitOptions::describeShell(Keywords& k) {
  k.count("sources", &sources, {1, 1000000},
          "a number of charges on one shell, in place of the tolerance");
  k.count("collocation", &collocation, {8, 1e7},
          "boundary points that such a shell is fitted to, at least sources + 4; 4 a source if "
          "not given, 3 above 3000");
  k.number("distance", &shell.distance, {1e-4, 2},
           "of such a shell from the surface, a fraction of the source's diagonal; chosen by "
           "held-out error if not given");
  k.number("radius_ratio", &shell.radiusRatio, {1, 100},
           "charges on a sphere, in place of a shell: its radius as a multiple of half the "
           "diagonal, above 1");
  k.choice<FitSolver>("solver", &shell.solver,
                      {{"auto", FitSolver::automatic},
                       {"dense", FitSolver::dense},
                       {"iterative", FitSolver::iterative}},
                      "of such a shell: dense up to some 3000 charges, iterative for many");
  k.choice<Regularization>(
      "method", &shell.method,
      {{"tikhonov", Regularization::tikhonov}, {"tsvd", Regularization::truncatedSvd}},
      "regularisation of a dense solve: Tikhonov's, or truncation of "
      "singular values");
  k.number("regularization", &shell.regularization, {0, 1},
           "its threshold, a fraction of the largest singular value; chosen by held-out error if "
           "not given");
}

FitMapSettings FitOptions::settings(bool laidOn) const {
  FitMapSettings out = fit;
  const std::pair<bool, const char*> shells[] = {
      {sources.has_value(), "sources"},
      {collocation.has_value(), "collocation"},
      {shell.distance.has_value(), "distance"},
      {shell.radiusRatio.has_value(), "radius_ratio"},
      {shell.solver != FitSolver::automatic, "solver"},
      {shell.method != Regularization::tikhonov, "method"},
      {shell.regularization.has_value(), "regularization"}};
  for (const auto& [given, name] : shells) {
    if (!given) continue;
    if (tolerance) throw SettingError("tolerance", fmt::format("excludes {}; give one", name));
    out.shell = shell;
  }
  if (shell.distance && shell.radiusRatio)
    throw SettingError("distance", "excludes radius_ratio; give one");
  if (out.shell) {
    out.shell->sources = sources.value_or(shell.sources);
    out.shell->collocation = collocation.value_or(0);
  }
  out.tolerance = tolerance.value_or(laidOn ? kLaidOnTolerance : fit.tolerance);
  return out;
}

// What is to be mapped: a pair of one connectivity, or strangers.
struct Job {
  Mesh source, target;
  bool related = true, laidOn = false;
};

Mesh likeSource(const Mesh& source, Points vertices, const std::string& name) {
  Mesh out = source;
  out.name = name;
  out.vertices = std::move(vertices);
  return out;
}

void readTarget(const std::string& path, const CallOptions& options, Job& job) {
  runCall(options, [&]() {
    try {
      job.target = readMeshLike(path, job.source);
    } catch (const DataError&) {
      job.target = readMesh(path);
      job.related = false;
    }
  });
}

Job jobOf(const Arguments& a, const CallOptions& options) {
  Job job;
  if (a.size() == 1 && py::isinstance<PyCorrespondence>(a[0])) {
    const auto& c = py::cast<const PyCorrespondence&>(a[0]);
    job.source = c.source;
    job.target = likeSource(c.source, c.positions, "target");
    job.laidOn = true;
    return job;
  }
  std::size_t at = 0;
  job.source = takeMesh(a, at, "source");
  if (at >= a.size()) throw py::type_error("fit() lacks its target: V_target, or a mesh");
  const bool last = at + 1 == a.size();
  if (last && isArrayLike(a[at])) {
    job.target = takeTarget(a, at, job.source);
    return job;
  }
  if (last && isPath(a[at])) {
    readTarget(pathFrom(a[at], "target"), options, job);
    return job;
  }
  job.target = takeMesh(a, at, "target");
  if (at < a.size()) throw py::type_error("fit() takes a source and a target, no more");
  job.related = sameConnectivity(job.source, job.target);
  if (job.related) job.target = likeSource(job.source, job.target.vertices, job.target.name);
  return job;
}

py::object fit(const Arguments& a, FitOptions& o) {
  Job job = jobOf(a, o.call);
  const FitMapSettings settings = o.settings(job.laidOn || !job.related);
  if (!job.related) {
    CorrespondOptions correspond = o.correspond;
    correspond.map.seed = settings.seed;
    correspond.map.carryBack = false;
    CallOptions laying = o.call;
    laying.timeShare = kLayingTimeShare;
    const auto laid = correspondMeshes(job.source, job.target, correspond.settings(), laying);
    job.source = laid->source;
    job.target = likeSource(laid->source, laid->positions, job.target.name);
  }
  return py::cast(std::make_shared<PyMap>(call(o.call, [&]() {
    const FitMapSettings with = settings;
    requireMemory(o.call, "fitting the map", fitMapMemory(with, job.source.vertices.size()),
                  "use fewer sources or raise max_memory");
    return fitMap(job.source, job.target, with);
  })));
}

}  // namespace

void bindFit(py::module_& m) {
  define<FitOptions>(
      m,
      {"fit", "*meshes",
       "The harmonic map of the inside of a solid, from where its surface goes. Returns an "
       "innermap.Map.\n\n"
       "fit(V, F, V_target): each vertex goes to its like.\n"
       "fit(source, target): meshes as tuples (V, F), paths, what read_mesh() gave, or objects "
       "with points and cells. Of one connectivity as above; else the source is laid onto the "
       "target first, as correspond() does.\n"
       "fit(correspondence): what correspond() gave.\n\n"
       "V: (n, 3) float64, world units. F: (m, 3) integers. Open meshes are capped, overlapping "
       "parts united; a tolerance that cannot be met is no error, see Map.tolerance_met. Raises "
       "DataError (no inside, wrong arrays), SettingError, MemoryError."},
      fit);
}

}  // namespace innermap::python
