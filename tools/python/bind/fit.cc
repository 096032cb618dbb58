
#include "bind/arrays.h"
#include "bind/call.h"
#include "bind/correspondence.h"
#include "bind/keywords.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/fit/fit_map.h"
#include "jobs/map_job.h"

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

MapJob jobOf(const Arguments& a, const CallOptions& options) {
  if (a.size() == 1 && py::isinstance<PyCorrespondence>(a[0])) {
    const auto& c = py::cast<const PyCorrespondence&>(a[0]);
    return {c.source, c.target("target"), true, true};
  }
  std::size_t at = 0;
  Mesh source = takeMesh(a, at, "source");
  if (at >= a.size()) throw py::type_error("fit() lacks its target: V_target, or a mesh");
  const bool last = at + 1 == a.size();
  if (last && isArrayLike(a[at])) {
    Mesh target = takeTarget(a, at, source);
    return {std::move(source), std::move(target)};
  }
  if (last && isPath(a[at])) {
    const std::string path = pathFrom(a[at], "target");
    TargetMesh target = call(options, [&] { return readTarget(path, source); });
    return {std::move(source), std::move(target.mesh), target.related};
  }
  Mesh target = takeMesh(a, at, "target");
  if (at < a.size()) throw py::type_error("fit() takes a source and a target, no more");
  return mapJob(std::move(source), std::move(target));
}

py::object fit(const Arguments& a, FitOptions& o) {
  MapJob job = jobOf(a, o.call);
  const FitMapSettings settings = o.fit.settings(job.laidOn());
  if (!job.related) {
    CallOptions laying = o.call;
    laying.timeShare = kLayingTimeShare;
    const auto laid = correspondMeshes(
        job.source, job.target, layingSettings(o.correspond.settings(), settings.seed), laying);
    job = {laid->source, laid->target(job.target.name), true, true};
  }
  return py::cast(std::make_shared<PyMap>(call(o.call, [&]() {
    requireMemory(fitNeed(settings, job.source.vertices.size()));
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
