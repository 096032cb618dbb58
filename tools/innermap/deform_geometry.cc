#include "deform_geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "frame_loop.h"
#include "innermap/levelset/level_set.h"
#include "job_cost.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

constexpr double kAccuracy = 1e-7;  // of sums of charges

// The set-up that all frames share.
class Deformer {
 public:
  Deformer(const DeformGeometry& job, const Frames& frames, Context& context)
      : job_(job),
        context_(context),
        frames_(frames),
        fitter_(makeFrameFitter(readRest(job.rest, context), job.frames.fitting, context)),
        fits_(makeFrameFits(fitter_, frames, context)),
        file_(readGeometryFile(job.input, job.geometry, context)) {
    if (job.transfer.fadeTo != "fitted") pusher_ = pusherFor({});
  }

  struct Row {
    CarriedGeometry carried;
    BoundaryError error;
    JudgedFrame judged;
  };

  Row run(std::size_t index, const std::string& path) {
    const FrameFile& frame = frames_.all[index];
    const std::shared_ptr<const FrameFit> fit = fits_.at(index);
    const PointPusher pusher = pusher_ ? *pusher_ : pusherFor(fit->boundary.moved);
    const ComposedMap map = HarmonicMap(fit->field);
    Row row;
    row.error = fit->error;
    row.judged = {frame.number, fit->error.p99, fit->folded, fit->outside};
    CarryGeometrySettings settings;
    settings.splats = job_.geometry.splats;
    row.carried = context_.timed("carry", [&] {
      return carryFile(
          *file_,
          [&](const Points& points, bool jacobians) { return pusher.push(map, points, jacobians); },
          settings, context_);
    });
    warnOf(*file_, row.carried, job_.transfer, fmt::format("frame {}: ", frame.number), context_);
    writeFrame(frame, [&] { writeGeometryFile(path, *file_, row.carried, context_); });
    return row;
  }

  // Of the last frame: which points are outside is the same in all.
  std::string report(const CarriedGeometry& carried) const {
    return reportGeometry(*file_, carried, context_);
  }

 private:
  PointPusher pusherFor(const Points& moved) const {
    const OutsideSettings outside =
        outsideSettings(job_.transfer, fitter_.solid().repaired().mesh.vertices, moved);
    return PointPusher(fitter_.solid(), carryPointsSettings(outside, kAccuracy));
  }

  const DeformGeometry& job_;
  Context& context_;
  const Frames& frames_;
  const FrameFitter fitter_;
  FrameFits fits_;
  const std::unique_ptr<GeometryFile> file_;
  std::optional<PointPusher> pusher_;  // none where each frame needs its own
};

}  // namespace

void deformGeometry(const DeformGeometry& job, const Frames& frames, const FramePattern& pattern,
                    Context& context) {
  const auto path = [&](std::size_t i) { return pattern.path(frames.all[i].number); };
  // What the fitter leaves scattered over the heap counts when the first frame is carried.
  constexpr std::uint64_t kScattered = 25'000'000;
  const std::uint64_t need = geometryMemory(job.input) + kScattered;
  JobSize size;
  size.items = static_cast<double>(need) / 1e6;
  context.expect(framePhases(job.frames.fitting.sources, frames.wanted.size(),
                             stageOf("frames: geometry", size)));
  if (context.dryRun()) {
    const FrameFitterSettings settings = job.frames.fitting;
    return context.plan(
        {framesPlan(settings, frames), "carry " + job.input + " to " + path(frames.wanted.front()) +
                                           " to " + path(frames.wanted.back())},
        frameFitterMemory(settings, need));
  }
  requireFrameMemory(job.frames.fitting, need, context);
  Deformer deformer(job, frames, context);
  std::map<std::size_t, BoundaryError> errors;
  std::vector<JudgedFrame> judged;
  std::optional<CarriedGeometry> last;
  context.print(fmt::format("{:>8} {:>10} {:>10} {:>10} {:>10} {:>9}\n", "frame", "points",
                            "folded", "error rms", "error 99%", "seconds"));
  const auto results = runFrames(frames, true, context, [&](std::size_t index) {
    StageSeconds seconds;
    auto row = timed(seconds, "frame", [&] { return deformer.run(index, path(index)); });
    errors[index] = row.error;
    judged.push_back(row.judged);
    context.print(fmt::format("{:>8} {:>10} {:>10} {:>10.2e} {:>10.2e} {:>9.3g}{}\n",
                              frames.all[index].number, row.carried.ownPoints, row.carried.folded,
                              row.error.rms, row.error.p99, seconds.front().second,
                              missedMark(row.judged.misses(job.frames.tolerance))));
    last = std::move(row.carried);
  });
  if (last) context.print(deformer.report(*last));
  std::vector<DeformedFrame> made(results.size());
  for (std::size_t i = 0; i < made.size(); ++i)
    if (const auto error = errors.find(frames.wanted[i]); error != errors.end())
      made[i].error = error->second;
  context.report().add(
      "frames", only(deformedFigures(made), {"boundary_rms", "boundary_p99", "boundary_max"}));
  context.judge(judgeFrames(judged, job.frames.tolerance, job.frames.verdict));
  context.print(secondsText(results, context));
}

}  // namespace innermap::tool
