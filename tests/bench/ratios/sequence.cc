// Frames of one animation on one set-up, as `innermap sequence` fits them.
#include <fmt/format.h>

#include <algorithm>

#include "innermap/fit/frame_fitter.h"
#include "innermap/mesh/mesh_file.h"
#include "section.h"

namespace innermap::bench {

Tables sequence(const Options& options) {
  constexpr int kShown = 12;  // every so manieth frame has a row, and the first two
  const int frames = options.quick ? 3 : 24;
  const Mesh reference = readMesh(options.model("horse-gallop/reference.obj"));
  FrameFitterSettings settings;
  if (options.quick) settings.sources = 600;
  Stopwatch watch;
  const FrameFitter fitter(makeSourceBoundary(reference), settings);
  const double setUp = watch.lap();

  Table table(fmt::format("A sequence: {} frames of the horse's gallop, {} sources", frames,
                          fitter.sources().size()));
  double first = 0, slowest = 0, sum = 0;
  for (int f = 1; f <= frames; ++f) {
    const Mesh frame =
        readMeshLike(options.model(fmt::format("horse-gallop/frame.{:04}.obj", f)), reference);
    watch.lap();
    const FrameFit fit = fitter.fit(frame);
    const double seconds = watch.lap();
    if (f == 1) first = setUp + seconds;
    if (f > 1) slowest = std::max(slowest, seconds);
    if (f > 1) sum += seconds;
    if (f > 2 && f % kShown != 0) continue;
    Json row{{"frame", f},
             {"set-up s", f == 1 ? setUp : 0.0},
             {"fit s", seconds},
             {"iterations", fit.iterations},
             {"fit / first", f == 1 ? 1.0 : seconds / first},
             {"rms", fit.error.rms},
             {"p99", fit.error.p99}};
    Work work;  // the frame's vertices and the charges' weights
    work.bytes =
        static_cast<double>(sizeof(Vec3) * (frame.vertices.size() + fitter.sources().size()));
    row.update(besideLimit(options.limits, work, seconds));
    table.add(row);
  }
  const double mean = sum / (frames - 1);
  table.note(fmt::format(
      "set-up (solid, placing, factoring) and fit of the first: {:.3g} s; further frames, "
      "certificate included: {:.3g} s in the mean, {:.3g} s at most, which is {:.3g} and {:.3g} of "
      "it",
      first, mean, slowest, mean / first, slowest / first));
  return {table.json()};
}

}  // namespace innermap::bench
