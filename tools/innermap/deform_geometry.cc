#include "deform_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "frame_loop.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "job_cost.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

// The set-up that all frames share.
class GeometryDeformer {
 public:
  GeometryDeformer(const DeformGeometry& job, const Frames& frames, Context& context)
      : job_(job),
        context_(context),
        frames_(frames),
        fitter_(makeFrameFitter(readRest(job.rest, frames, context), job.frames.fitting, context)),
        fits_(makeFrameFits(fitter_, frames, context)),
        file_(readGeometryFile(job.input, job.geometry, context)) {
    const FrameOutside outside = frameOutside(job.transfer.outside, fadeTo(job.transfer));
    pusher_.emplace(fitter_.solid(), CarryPointsSettings{outside.settings}, outside.fitted);
  }

  // Points that the file has.
  std::size_t points() const { return file_->geometry.ownPoints; }

  // write: puts what was carried in place.
  DeformedRow run(std::size_t index, const std::function<void(const CarriedGeometry&)>& write) {
    const FrameFile& frame = frames_.all[index];
    const std::shared_ptr<const FrameFit> fit = fits_.at(index);
    const PointPusher pusher = pusher_->to(fit->boundary.moved);
    const ComposedMap map = HarmonicMap(fit->field);
    CarryGeometrySettings settings;
    settings.splats = job_.geometry.splats;
    settings.mirrored = fit->injectivity.mirrored;
    last_ = context_.timed("carry", [&] {
      return carryGeometry(
          *file_,
          fromInput([&](const Points& points,
                        bool jacobians) { return pusher.push(map, points, jacobians); },
                    context_),
          settings);
    });
    warnOf(*last_, job_.transfer, fmt::format("frame {}: ", frame.number), context_);
    writeFrame(frame.number, [&] { write(*last_); });
    return {{{}, fit->error, {}, {}},
            judgedFrame({fit.get(), frame.number}),
            fmt::format("{:>10} {:>10}", last_->ownPoints, last_->folded)};
  }

  void writeFile(const std::string& path, const CarriedGeometry& carried) const {
    writeGeometryFile(path, *file_, carried, context_);
  }

  // Of the last frame: which points are outside is the same in all.
  std::string report() const { return last_ ? reportGeometry(*last_, context_) : ""; }

 private:
  const DeformGeometry& job_;
  Context& context_;
  const Frames& frames_;
  const FrameFitter fitter_;
  FrameFits fits_;
  const std::unique_ptr<GeometryFile> file_;
  std::optional<FramePointPusher> pusher_;
  std::optional<CarriedGeometry> last_;
};

// stays: what `write` writes of a frame stays when the others are not made.
DeformedFrames makeFrames(const DeformGeometry& job, const Frames& frames,
                          GeometryDeformer& deformer, bool stays,
                          const std::function<void(std::size_t, const CarriedGeometry&)>& write,
                          Context& context) {
  return deformFrames(frames, job.frames, stays, fmt::format("{:>10} {:>10}", "points", "folded"),
                      context, [&](std::size_t index) {
                        return deformer.run(
                            index, [&](const CarriedGeometry& carried) { write(index, carried); });
                      });
}

// The file's own points, all of which a cache has in every frame.
Points cachePoints(const std::string& input, const CarriedGeometry& carried) {
  const auto end = carried.number.begin() + static_cast<std::ptrdiff_t>(carried.ownPoints);
  const auto cut = std::count(carried.number.begin(), end, -1);
  if (cut > 0)
    throw OutputFailure(
        fmt::format("{}: {} points lie too far outside and would be cut, but a point cache needs "
                    "all; raise --outside, or write files",
                    input, cut));
  return {carried.points.points.begin(),
          carried.points.points.begin() + static_cast<std::ptrdiff_t>(carried.ownPoints)};
}

// All frames in one file.
DeformedFrames makeCache(const DeformGeometry& job, const Frames& frames, const std::string& path,
                         GeometryDeformer& deformer, Context& context) {
  PointCacheLayout layout;
  layout.points = deformer.points();
  layout.framesPerSecond = job.framesPerSecond;
  for (const std::size_t index : frames.wanted) layout.numbers.push_back(frames.all[index].number);
  DeformedFrames made;
  writePointCache(path, layout, [&](const auto& add) {
    made = makeFrames(
        job, frames, deformer, false,
        [&](std::size_t, const CarriedGeometry& carried) { add(cachePoints(job.input, carried)); },
        context);
  });
  return made;
}

}  // namespace

bool DeformGeometry::cache() const { return isPointCache(output); }

void deformGeometry(const DeformGeometry& job, const Frames& frames, Context& context) {
  // What the fitter leaves scattered over the heap counts when the first frame is carried.
  constexpr std::uint64_t kScattered = 25'000'000;
  const FrameFitterSettings& settings = job.frames.fitting;
  const std::uint64_t need = geometryMemory(job.input) + kScattered;
  JobSize size;
  size.items = static_cast<double>(need) / 1e6;
  context.expect(framePhases(job.frames.fitting.sources, frames.wanted.size(),
                             stageOf("frames: geometry", size)));
  const std::string carry = job.cache() ? "carry " + job.input + " to " + job.output
                                        : carryPlan(job.input, job.output, frames);
  if (!context.begins({framesPlan(settings, frames), carry}, framesNeed(settings, need))) return;
  GeometryDeformer deformer(job, frames, context);
  const auto writeFile = [&](std::size_t index, const CarriedGeometry& carried) {
    const FramePattern pattern("--output", job.output);
    deformer.writeFile(pattern.path(frames.all[index].number), carried);
  };
  const DeformedFrames made = job.cache()
                                  ? makeCache(job, frames, job.output, deformer, context)
                                  : makeFrames(job, frames, deformer, true, writeFile, context);
  context.print(deformer.report());
  context.report().add("frames", only(concludeDeformed(made, frames, job.frames, context),
                                      {"boundary_rms", "boundary_p99", "boundary_max"}));
  context.print(secondsText(made.results, context));
}

}  // namespace innermap::tool
