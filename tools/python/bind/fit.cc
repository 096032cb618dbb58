
#include "bind/arrays.h"
#include "bind/call.h"
#include "bind/correspondence.h"
#include "bind/keywords.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"
#include "innermap/fit/fit_map.h"
#include "innermap/mesh/mesh_file.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct FitOptions {
  FitChoices fit;
  CorrespondOptions correspond;
  CallOptions call;

  FitOptions() { correspond.map.subdivide = kLaidOnSubdivide; }
  void describe(Keywords& k) {
    k.settings(innermap::describe(fit));
    correspond.describe(k);
    call.describe(k);
    call.describeTime(k);
  }
};

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

void readTargetOf(const std::string& path, const CallOptions& options, Job& job) {
  runCall(options, [&]() {
    TargetMesh target = readTarget(path, job.source);
    job.target = std::move(target.mesh);
    job.related = target.related;
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
    readTargetOf(pathFrom(a[at], "target"), options, job);
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
  const FitMapSettings settings = o.fit.settings(job.laidOn || !job.related);
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
    requireMemory("fitting the map", fitMapMemory(settings, job.source.vertices.size()),
                  "use fewer charges or raise max_memory");
    return fitMap(job.source, job.target, settings);
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
