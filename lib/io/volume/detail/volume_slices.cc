#include <algorithm>
#include <atomic>

#include "innermap/core/run.h"
#include "io/volume/detail/volume_plan.h"

namespace innermap {
namespace {

// One row of the grids first ... end - 1.
PixelCounts sampleRow(const VolumePlan& plan, std::size_t first, std::size_t end, int slice,
                      int row, SliceValues& values) {
  PixelCounts counts;
  std::size_t channel = 0;
  const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(plan.lattice.width());
  for (std::size_t g = first; g < end; ++g) {
    const VolumeGrid& grid = plan.grids[g];
    double* outputs[4] = {};
    for (std::size_t c = 0; c < grid.channelCount(); ++c)
      outputs[c] = values[channel++].data() + at;
    double* active = grid.activeChannel.empty() ? nullptr : outputs[grid.channels.size()];
    const PixelCounts c = plan.samplers[g]->row(plan.lattice, slice, row, outputs, active);
    counts.clamped += c.clamped;
    counts.inexact += c.inexact;
  }
  return counts;
}

}  // namespace

PixelCounts forSlices(const VolumePlan& plan, std::size_t first, std::size_t end,
                      const std::string& stage,
                      const std::function<void(int slice, const SliceValues& values)>& use) {
  const VolumeLattice& lattice = plan.lattice;
  std::size_t channels = 0;
  for (std::size_t g = first; g < end; ++g) channels += plan.grids[g].channelCount();
  const auto rows = static_cast<std::size_t>(lattice.height());
  const auto width = static_cast<std::size_t>(lattice.width());
  SliceValues values(channels, std::vector<double>(rows * width));
  std::atomic<std::size_t> clamped{0}, inexact{0};
  const double grids = static_cast<double>(plan.grids.size());
  for (int slice = 0; slice < lattice.slices(); ++slice) {
    const double part = static_cast<double>(slice) / lattice.slices();
    reportProgress(stage, (static_cast<double>(first) + part * double(end - first)) / grids);
    parallelBlocks(
        rows, std::max<std::size_t>(1, 4096 / width), [&](std::size_t from, std::size_t to) {
          PixelCounts sum;
          for (std::size_t row = from; row < to; ++row) {
            const PixelCounts c = sampleRow(plan, first, end, slice, static_cast<int>(row), values);
            sum.clamped += c.clamped;
            sum.inexact += c.inexact;
          }
          clamped += sum.clamped;
          inexact += sum.inexact;
        });
    use(slice, values);
  }
  return {clamped, inexact};
}

std::uint64_t sliceMemory(const VolumePlan& plan) {
  return 2 * sizeof(double) * std::uint64_t(plan.lattice.width()) *
         std::uint64_t(plan.lattice.height()) * plan.channels.size();
}

}  // namespace innermap
