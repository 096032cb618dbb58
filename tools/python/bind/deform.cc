// deform(): what is inside, through the frames of an animation.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "bind/arrays.h"
#include "bind/carry_options.h"
#include "bind/deformer.h"
#include "bind/errors.h"
#include "bind/frame_set.h"
#include "bind/grids.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "core/frame_files.h"
#include "innermap/core/memory.h"
#include "innermap/transfer/carry.h"
#include "jobs/frames_job.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct DeformOptions : CarryOptions {
  FittingOptions fitting;
  bool velocity = false;
  double shutter = kUsualShutter;

  void describe(Keywords& k) {
    k.flag("velocity", &velocity,
           "of grids: also a grid velocity for motion blur, world units a second, from the "
           "neighbouring frames");
    k.number("shutter", &shutter, {0, 10},
             "how long the shutter is open, in frames: the grid velocity goes on around the solid "
             "as far as it moves meanwhile");
    fitting.describe(k);
    CarryOptions::describe(k);
  }
};

class Deformation {
 public:
  Deformation(const Mesh& rest, const FrameSet& frames, const DeformOptions& o)
      : rest_(rest),
        frames_(frames),
        o_(o),
        outside_(frameOutside(o.outside, fadeToFrom(o.outside, o.fadeTo))) {}

  py::object grids(const py::object& what, const std::optional<FramePattern>& pattern) const;
  py::object points(const Points& points) const;
  py::object file(const std::string& from, const FramePattern& pattern) const;

 private:
  // carry: of a frame's number, its fit and the pusher to it.
  template <class Carry>
  FrameTable table(const FrameCarrier& carrier, const Carry& carry) const {
    return frames_.table(carrier.fitter, [&](const FittedFrame& frame) {
      const FrameFit& fit = *frame.fit.fit;
      carry(frame.fit.number, fit, carrier.pusher.to(fit.boundary.moved));
      return rowOf(fit);
    });
  }

  const Mesh& rest_;
  const FrameSet& frames_;
  const DeformOptions& o_;
  FrameOutside outside_;
};

py::object Deformation::grids(const py::object& what,
                              const std::optional<FramePattern>& pattern) const {
  const openvdb::GridPtrVec given =
      takeGrids(what, "inside", textsFrom(o_.grids, "grids"), o_.call);
  FrameCarry how{o_.carry(), outside_, {}, o_.velocity, o_.fitting.animation.framesPerSecond,
                 o_.shutter};
  std::vector<PushResult> results;  // of frames that are not left out
  const FrameTable made = call(o_.call, [&]() {
    how.output = carriedVoxels(given, o_.lattice);
    requireNoVelocity(how, given, o_.names, "inside", asCalled);
    SourceBoundary rest = makeSourceBoundary(rest_);
    const std::uint64_t others = frameCarryMemory(rest.solid, given, how);
    const FrameFitter fitter = fitterOf(std::move(rest), o_.fitting, others);
    const FramePusher pusher(fitter, given, pushSettings(how));
    return frames_.table(fitter, [&](const FittedFrame& frame) {
      PushResult result = pusher.push(frame.fit, carriedFields(how, frame.all, frame.index)).result;
      frame.warnings.insert(frame.warnings.end(), result.warnings.begin(), result.warnings.end());
      Figures row = rowOf(*frame.fit.fit);
      row.emplace_back("inverted_fraction", result.statistics.invertedInside(), "inverted");
      row.emplace_back("voxels", result.statistics.voxels, "voxels");
      VdbWriteSettings writing;
      writing.names = o_.names;
      if (pattern)
        writeFrame(frame.fit.number,
                   [&] { writeVdb(pattern->path(frame.fit.number), result.grids, {}, writing); });
      else
        results.push_back(std::move(result));
      return row;
    });
  });
  const py::dict figures = made.dict();
  if (pattern) return figures;
  py::list out;
  auto result = results.begin();
  for (const std::string& error : made.error) {
    if (!error.empty()) {
      out.append(py::none());
      continue;
    }
    const py::dict totals = totalsOf(*result);
    out.append(gridsObject(std::move((result++)->grids), totals, o_.call));
  }
  return std::move(out);
}

py::object Deformation::points(const Points& points) const {
  std::vector<Points> places;
  PlacedPoints placed;
  const FrameTable made = call(o_.call, [&]() {
    const FrameCarrier carrier(fitterOf(makeSourceBoundary(rest_), o_.fitting, 0), outside_);
    placed = carrier.pusher.place(points);
    return table(carrier, [&](std::int64_t, const FrameFit& fit, const PointPusher& pusher) {
      places.push_back(placesOf(pusher.push(HarmonicMap(fit.field), placed, false)));
    });
  });
  made.tell();
  py::array_t<double> out({static_cast<py::ssize_t>(made.frame.size()),
                           static_cast<py::ssize_t>(points.size()), py::ssize_t(3)});
  double* to = out.mutable_data();
  auto frame = places.begin();
  for (const std::string& error : made.error)
    if (!error.empty()) {
      to = std::fill_n(to, 3 * points.size(), kNone);
    } else {
      for (const Vec3& p : *frame++)
        for (int axis = 0; axis < 3; ++axis) *to++ = p[axis];
    }
  return py::make_tuple(out, foundOf(placed));
}

py::object Deformation::file(const std::string& from, const FramePattern& pattern) const {
  ReadGeometrySettings reading = geometrySettings(o_);
  requireWritableAs(from, pattern.path(0));
  const FrameTable made = call(o_.call, [&]() {
    const FrameCarrier carrier(
        fitterOf(makeSourceBoundary(rest_), o_.fitting, geometryMemory(from)), outside_);
    return table(carrier, [&](std::int64_t number, const FrameFit& fit, const PointPusher& pusher) {
      const HarmonicMap map(fit.field);
      writeFrame(number, [&] {
        carryFile(from, pattern.path(number), reading, {0, o_.splats, fit.injectivity.mirrored},
                  [&](const Points& points, bool jacobians) {
                    return pusher.push(map, points, jacobians);
                  });
      });
    });
  });
  return made.dict();
}

py::object deform(const Arguments& a, DeformOptions& o) {
  const Mesh rest = restFrom(a[0], o.fitting);
  const FrameSet frames(a[2], o.fitting, rest);
  if (o.velocity && frames.numbers().size() < 2)
    wrongValue("velocity", "needs two frames at least");
  std::optional<FramePattern> pattern;
  if (!a[3].is_none()) pattern.emplace("output", pathFrom(a[3], "output"));
  const Deformation job(rest, frames, o);
  const std::string from = isPath(a[1]) ? pathFrom(a[1], "inside") : "";
  if (!from.empty() && isGeometryFile(from)) {
    if (!pattern) wrongValue("output", "is needed for files of geometry");
    return job.file(from, *pattern);
  }
  if (!from.empty() || isGrids(a[1])) return job.grids(a[1], pattern);
  if (pattern) wrongValue("output", "is for grids and files of geometry");
  return job.points(pointsFrom(a[1], "inside"));
}

}  // namespace

void bindDeform(py::module_& m) {
  define<DeformOptions>(
      m,
      {"deform", "source, inside, frames, output=None",
       "Carries volumes or geometry inside a rest pose through the frames of an "
       "animation.\n\nsource: the rest pose, a mesh: (V, F), a path, an innermap.Mesh, or that of "
       "a glTF file. inside: points (n, 3), which come back as (places (frames, n, 3), found "
       "(n,)), NaN where a point lies too far outside and in a frame that is left out; an "
       "innermap.Grids or the path of a .vdb file, which come back as a list of Grids, None for a "
       "frame that is left out, or are written to output and figures come back; or the path of a "
       "file of geometry (.obj, .ply, ..., .vtu, .msh), written to output. frames: paths, a "
       "pattern ('walk.*.obj'), a point cache (.mdd, .pc2), glTF (.glb, .gltf), or an array of "
       "each frame's vertices. output: a path with #### or %04d for the frame's number. Figures "
       "are a dict of columns: frame, boundary_rms and so on, error, the text of what was wrong "
       "with a frame that is left out. A RuntimeWarning says of each frame what makes it doubtful, "
       "or that it is left out. All frames are made, also those whose output is there. Raises "
       "DataError where no frame can be used, FileError, MemoryError."},
      deform);
}

}  // namespace innermap::python
