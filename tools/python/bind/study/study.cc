// study(): how a map depends on its settings.
#include "innermap/study/study.h"

#include "bind/arrays.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "bind/volumes.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct StudyOptions {
  StudySettings study;
  py::object sources, collocation, distances, radiusRatios, folder;
  CallOptions call;

  void describe(Keywords& k) {
    k.object(
        "charges", &sources, "Sequence[int]",
        "numbers of charges, 16 to 20000; 125 to 2000 if not given; an empty list: not varied");
    k.object("points", &collocation, "Sequence[float]",
             "boundary points a charge, 1 to 100; 1 to 6 if not given");
    k.object("distances", &distances, "Sequence[float]",
             "of the charges, fractions of the source's diagonal, 1e-4 to 2; 0.0025 to 0.32 if not "
             "given");
    k.object("radius_ratios", &radiusRatios, "Sequence[float]",
             "of charges on a sphere, 1 to 100; 1.1 to 5 if not given");
    k.settings(innermap::describe(study));
    k.object("folder", &folder, "path", "where finished runs are kept, to be taken from there");
    call.describe(k);
    call.describeTime(k, "seconds after which no run begins; no limit if not given");
  }
};

py::dict tableOf(const Study& study) {
  py::dict out;
  py::list placement, failure;
  for (const StudyRow& row : study.rows) {
    placement.append(placementText(row));
    failure.append(row.failure);
  }
  out["placement"] = placement;
  for (const StudyColumn& column : studyColumns()) {
    std::vector<double> values;
    for (const StudyRow& row : study.rows) values.push_back(valueOf(column, study, row));
    out[column.name] = arrayOf(values);
  }
  out["failure"] = failure;
  return out;
}

py::dict findingsOf(const Study& study, const StudySettings& settings) {
  const StudyFindings found = studyFindings(study);
  py::dict out;
  if (found.best) out["best"] = optionsOf(*found.best, settings);
  if (found.cheapest) out["cheapest"] = optionsOf(*found.cheapest, settings);
  out["advice"] = found.advice;
  py::list statements;
  for (const StudyStatement& s : found.statements)
    statements.append(py::make_tuple(s.text, verdictText(s.verdict), s.figures));
  out["statements"] = statements;
  out["left"] = study.left;
  out["warnings"] = study.warnings;
  return out;
}

py::object study(const Arguments& a, StudyOptions& o) {
  std::size_t at = 0;
  const Mesh source = takeMesh(a, at, "source");
  if (at + 1 != a.size()) throw py::type_error("study() takes a source and a target");
  const Mesh target = takeTarget(a, at, source);
  takeNumbers(o.sources, "charges", o.study.sources);
  takeNumbers(o.collocation, "points", o.study.collocation);
  takeNumbers(o.distances, "distances", o.study.distances);
  takeNumbers(o.radiusRatios, "radius_ratios", o.study.radiusRatios);
  if (!o.folder.is_none()) o.study.folder = pathFrom(o.folder, "folder");
  const Study made =
      call(o.call, [&]() { return runStudy(makeBoundaryPair(source, target), o.study); });
  return py::make_tuple(tableOf(made), findingsOf(made, o.study));
}

}  // namespace

void bindStudy(py::module_& m) {
  define<StudyOptions>(
      m,
      {"study", "*meshes",
       "How a map's error, energies and stability depend on its settings, as Li et al. (2009) "
       "study "
       "them: (table, findings).\n\nstudy(V, F, V_target), or a source and a target of the same "
       "connectivity. table: a dict of columns, a row a run, as the program's study.csv has them. "
       "findings: the best settings as options of the program, advice, the paper's statements with "
       "whether they hold. Ctrl-C keeps finished runs in folder. Raises DataError, SettingError, "
       "MemoryError."},
      study);
}

}  // namespace innermap::python
