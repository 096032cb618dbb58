// sequence(): the maps of an animation, measured.

#include "bind/errors.h"
#include "bind/frame_set.h"
#include "bind/grids.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "core/frame_files.h"
#include "innermap/evaluate/grids.h"
#include "jobs/frames_job.h"
#include "report/sequence_table.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct SequenceOptions {
  FittingOptions fitting;
  LatticeChoice grid;
  LameConstants lame;
  py::object output, grids;
  NamingScheme names = NamingScheme::innermap;
  CallOptions call;

  void describe(Keywords& k) {
    k.object("output", &output, "path",
             "a .vdb file a frame, with #### or %04d for the number, with `grids`");
    k.object("grids", &grids, "str or Sequence[str]",
             "written to output: of surface, density, map, jacobian, harmonic_energy, "
             "deformation_energy; the two energies if not given");
    fitting.describe(k);
    k.settings(describeProof(&fitting.fitting.prove, &fitting.fitting.proofCells));
    k.settings(innermap::describe(grid));
    k.settings(innermap::describe(lame));
    k.setting(namesSetting(&names));
    call.describe(k);
  }
};

// The columns of the program's energies.csv, but for what tells of its run.
Figures measuresOf(const FrameFit& fit, const MapGrids& grids) {
  Figures out;
  for (Figure& figure : figures(sequenceRow(fit, grids)))
    if (figure.key != "tolerance_met" && figure.key != "seconds") out.push_back(std::move(figure));
  return out;
}

py::object sequence(const Arguments& a, SequenceOptions& o) {
  const Mesh rest = restFrom(a[0], o.fitting);
  const FrameSet frames(a[1], o.fitting, rest);
  std::optional<FramePattern> pattern;
  if (!o.output.is_none()) pattern.emplace("output", pathFrom(o.output, "output"));
  std::vector<std::string> names = textsFrom(o.grids, "grids");
  if (!pattern && !names.empty()) wrongValue("grids", "is for output; give it too");
  if (pattern && names.empty()) names = {"harmonic_energy", "deformation_energy"};
  const FrameTable made = call(o.call, [&]() {
    auto settings = o.grid.in(MapGridSettings{});
    settings.lame = o.lame;
    SourceBoundary boundary = makeSourceBoundary(rest);
    requireMemory(sequenceNeed(o.fitting.fitting, boundary.solid, settings));
    const FrameFitter fitter(std::move(boundary), o.fitting.fitting);
    const FrameEvaluator evaluator(fitter, names, settings);
    FrameTable out = frames.table(fitter, [&](const FittedFrame& frame) {
      const MapGrids grids = evaluator.evaluate(*frame.fit.fit);
      VdbWriteSettings writing;
      writing.names = o.names;
      if (pattern)
        writeFrame(frame.fit.number, [&] {
          writeVdb(pattern->path(frame.fit.number), evaluator.grids(frame.fit, grids), {}, writing);
        });
      return measuresOf(*frame.fit.fit, grids);
    });
    out.general = evaluator.warnings();
    return out;
  });
  return made.dict();
}

}  // namespace

void bindSequence(py::module_& m) {
  define<SequenceOptions>(
      m,
      {"sequence", "source, frames",
       "Measures the maps from a rest pose to the frames of an animation: a dict of columns as the "
       "program's energies.csv has them: frame, harmonic (3 for a rigid motion), deformation (0 "
       "for one), deformation_mean, boundary_rms, boundary_p99, boundary_max (fractions of the "
       "frame's diagonal), jacobian_min, jacobian_max, folded_fraction, outside_fraction, volume "
       "(world units cubed), error: why a frame could not be used; its figures are then NaN. A "
       "RuntimeWarning says of each frame what makes it doubtful, or that it is left out. With "
       "prove also the proofs of each map, named as in Map.prove(), and statement: proofs and "
       "checks in words.\n\nsource and frames as deform() takes them. Raises DataError where no "
       "frame can be used, FileError, MemoryError."},
      sequence);
}

}  // namespace innermap::python
