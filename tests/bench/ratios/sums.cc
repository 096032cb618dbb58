// Sums of many charges at all interior voxels: hierarchical beside direct.
#include <openvdb/openvdb.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "evaluate/active_region.h"
#include "innermap/field/field_file.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/solve/kernel_sum.h"
#include "memory_peak.h"
#include "pairs.h"
#include "program.h"
#include "sample/source_points.h"
#include "solve/detail/sum_plan.h"

namespace innermap::bench {
namespace {

constexpr std::size_t kChecked = 1000;  // voxels whose error is measured
constexpr std::size_t kTimed = 20000;   // voxels whose direct sums are timed
constexpr std::size_t kVoxelsOfBlock = 512;

struct Sources {
  std::string name;
  Points points;
  Matrix weights;
};

// A fifth each at 1, 1.25, 1.5, 1.75 and 2 spacings from the surface; random weights.
Sources shells(const Solid& solid, std::size_t count) {
  Sources out{"random weights, 1 to 2 spacings", {}, Matrix(count, 3)};
  const double spacing = std::sqrt(solid.area() / static_cast<double>(count));
  for (std::size_t shell = 0; shell < 5; ++shell) {
    SourceSettings settings;
    settings.count = count / 5 + (shell < count % 5);
    settings.seed = shell + 1;
    const double distance = (1 + 0.25 * static_cast<double>(shell)) * spacing;
    const Points more = sourceShell(solid, distance / solid.diagonal(), settings);
    out.points.insert(out.points.end(), more.begin(), more.end());
  }
  const CounterRandom random(1, 1);
  for (std::size_t i = 0; i < 3 * count; ++i) out.weights.data()[i] = random.uniform(i) - 0.5;
  return out;
}

Sources fittedSources(const Pair& pair, std::size_t count, const Options& options) {
  const std::string file = options.scratch + "/map.ply";
  runProgram({"fit", pair.source, pair.target, "-o", file, "--charges", std::to_string(count),
              "--collocation", std::to_string(2 * count)},
             options);
  const HarmonicField field = readField(file).steps.front();
  return {"fitted weights", field.sources(), field.weights()};
}

// The solid's interior voxels in the leaves' order, and those at which errors are measured: half of
// them anywhere, half in leaves that the boundary runs through.
struct Voxels {
  LatticeBlocks lattice;
  std::size_t count = 0;
  struct Place {
    std::size_t block, offset;
  };
  std::vector<Place> checked, timed;

  Vec3 position(const Place& p) const {
    const auto& first = lattice.blocks[p.block].first;
    const auto along = [&](int axis, std::size_t step) {
      return lattice.spacing * static_cast<double>(first[static_cast<std::size_t>(axis)] +
                                                   static_cast<std::int32_t>(step));
    };
    return lattice.origin +
           Vec3{along(0, p.offset / 64), along(1, p.offset / 8 % 8), along(2, p.offset % 8)};
  }
  Points positions(const std::vector<Place>& places) const {
    Points points;
    for (const Place& p : places) points.push_back(position(p));
    return points;
  }
};

void drawPlaces(const std::vector<Voxels::Place>& from, std::size_t count, std::uint64_t stream,
                std::vector<Voxels::Place>& to) {
  const CounterRandom random(1, stream);
  for (std::size_t i = 0; i < std::min(count, from.size()); ++i)
    to.push_back(from[random.bits(i) % from.size()]);
}

Voxels interiorVoxels(const Solid& solid, int across) {
  LevelSetSettings settings;
  settings.resolution = across;
  const auto levelSet = makeLevelSet(solid, settings);
  RegionSettings withoutSkin;
  withoutSkin.skin = 0;
  const auto region = activeRegion(*levelSet, withoutSkin);
  Voxels out;
  const openvdb::Vec3d origin = region->transform().indexToWorld(openvdb::Vec3d(0));
  out.lattice.origin = {origin.x(), origin.y(), origin.z()};
  out.lattice.spacing = region->voxelSize()[0];
  std::vector<Voxels::Place> all, boundary;
  for (auto leaf = region->tree().cbeginLeaf(); leaf; ++leaf) {
    LatticeBlocks::Block block;
    for (int a = 0; a < 3; ++a) block.first[static_cast<std::size_t>(a)] = leaf->origin()[a];
    for (openvdb::Index x = 0; x < 8; ++x)
      block.wanted[x] = leaf->getValueMask().getWord<std::uint64_t>(x);
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      all.push_back({out.lattice.blocks.size(), voxel.pos()});
      if (!leaf->isDense()) boundary.push_back(all.back());
    }
    out.lattice.blocks.push_back(block);
  }
  out.count = all.size();
  drawPlaces(all, kChecked / 2, 1, out.checked);
  drawPlaces(boundary, kChecked / 2, 2, out.checked);
  drawPlaces(all, kTimed, 3, out.timed);
  return out;
}

// What a grid would hold: three values and nine derivatives a voxel, in single precision; and the
// checked voxels' in double.
class Kept {
 public:
  explicit Kept(const Voxels& voxels)
      : voxels_(voxels),
        grid_(12 * kVoxelsOfBlock * voxels.lattice.blocks.size()),
        values_(voxels.checked.size(), 3),
        gradients_(voxels.checked.size(), 9),
        checkedOf_(voxels.lattice.blocks.size()) {
    for (std::size_t i = 0; i < voxels.checked.size(); ++i)
      checkedOf_[voxels.checked[i].block].push_back(i);
  }

  void operator()(std::size_t block, const double* values, const double* gradients) {
    float* to = grid_.data() + 12 * kVoxelsOfBlock * block;
    for (std::size_t i = 0; i < 3 * kVoxelsOfBlock; ++i) *to++ = static_cast<float>(values[i]);
    for (std::size_t i = 0; i < 9 * kVoxelsOfBlock; ++i) *to++ = static_cast<float>(gradients[i]);
    for (const std::size_t i : checkedOf_[block]) {
      const std::size_t offset = voxels_.checked[i].offset;
      for (std::size_t k = 0; k < 3; ++k) values_(i, k) = values[k * kVoxelsOfBlock + offset];
      for (std::size_t k = 0; k < 9; ++k) gradients_(i, k) = gradients[k * kVoxelsOfBlock + offset];
    }
  }

  const Matrix& values() const { return values_; }
  const Matrix& gradients() const { return gradients_; }

 private:
  const Voxels& voxels_;
  std::vector<float> grid_;
  Matrix values_, gradients_;
  std::vector<std::vector<std::size_t>> checkedOf_;
};

// Largest over the channels (`width` columns each) of the root mean square error over that of the
// exact values.
double relativeError(const Matrix& found, const Matrix& exact, std::size_t width) {
  double worst = 0;
  for (std::size_t c = 0; c < exact.columns(); c += width) {
    double error = 0, size = 0;
    for (std::size_t i = 0; i < width * exact.rows(); ++i) {
      const double e = exact.column(c)[i], d = found.column(c)[i] - e;
      error += d * d;
      size += e * e;
    }
    worst = std::max(worst, std::sqrt(error / size));
  }
  return worst;
}

struct Measured {
  double seconds = 0, direct = 0;
  Json row;
};

// Writing the values and derivatives of a voxel, and evaluating its polynomial; charges nearby come
// on top.
Work leastWork(const Voxels& voxels, double accuracy) {
  const double n = static_cast<double>(voxels.count), order = planFor(accuracy).order;
  Work work;
  work.bytes = 12 * sizeof(float) * n;
  work.multiplyAdds = 12 * (order + 1) * (order + 1) * n;
  return work;
}

Measured measure(const Sources& sources, const Voxels& voxels, int across, double accuracy,
                 const Limits& limits) {
  const Charges charges(sources.points, sources.weights);
  const Points timed = voxels.positions(voxels.timed);
  Measured out;
  Stopwatch watch;
  sumCharges(charges, timed, true);
  out.direct = watch.lap() * static_cast<double>(voxels.count) / static_cast<double>(timed.size());
  const FieldSamples exact = sumCharges(charges, voxels.positions(voxels.checked), true);

  forgetPeakMemory();
  const std::uint64_t before = residentMemory();
  Kept kept(voxels);
  FastSumSettings settings;
  settings.accuracy = accuracy;
  settings.gradients = true;
  settings.method = SumMethod::hierarchical;
  watch.lap();
  FastSum(sources.points, sources.weights).onLattice(voxels.lattice, std::ref(kept), settings);
  out.seconds = watch.lap();
  const double bytes = static_cast<double>(peakSinceForgotten()) - static_cast<double>(before);
  const double n = static_cast<double>(voxels.count);
  out.row = {{"sources", sources.points.size()},
             {"weights", sources.name},
             {"across", across},
             {"voxels", voxels.count},
             {"accuracy", accuracy},
             {"seconds", out.seconds},
             {"direct s", out.direct},
             {"ratio", out.direct / out.seconds},
             {"value error", relativeError(kept.values(), exact.values, 1)},
             {"gradient error", relativeError(kept.gradients(), exact.gradients, 3)},
             {"Mvoxels/s", 1e-6 * n / out.seconds},
             {"bytes/voxel", static_cast<std::int64_t>(std::max(0.0, bytes / n))}};
  out.row.update(besideLimit(limits, leastWork(voxels, accuracy), out.seconds));
  Work plain;
  plain.pairs = n * static_cast<double>(sources.points.size());
  out.row["direct of limit %"] = besideLimit(limits, plain, out.direct)["of limit %"];
  return out;
}

}  // namespace

Tables sums(const Options& options) {
  const std::size_t count = options.quick ? 2000 : 50000;
  const Pair pair = poses(options)[2];
  const Solid solid(readMesh(pair.source));
  const int coarse = options.quick ? 32 : 256, fine = 2 * coarse;
  const Voxels small = interiorVoxels(solid, coarse), large = interiorVoxels(solid, fine);
  const Sources random = shells(solid, count), many = shells(solid, 4 * count);

  Table table("Sums at all interior voxels of the horse: three channels, values and gradients");
  const Limits& limits = options.limits;
  const Measured a = measure(random, small, coarse, 1e-5, limits),
                 b = measure(random, large, fine, 1e-5, limits),
                 c = measure(random, large, fine, 1e-7, limits),
                 d = measure(many, small, coarse, 1e-5, limits),
                 e = measure(many, large, fine, 1e-5, limits);
  for (const Measured& m : {a, b, c, d, e}) table.add(m.row);
  const Sources fitted = fittedSources(pair, count, options);
  table.add(measure(fitted, small, coarse, 1e-5, limits).row);
  table.add(measure(fitted, large, fine, 1e-5, limits).row);
  table.add(measure(fitted, large, fine, 1e-7, limits).row);
  table.note("direct: the vectorised sum, timed at " + std::to_string(kTimed) +
             " of the voxels and scaled; errors: rms over rms at " + std::to_string(kChecked) +
             " voxels against direct sums, half of them in leaves along the boundary");
  const double times = static_cast<double>(large.count) / static_cast<double>(small.count);
  table.note("growth: " + digits(times) + " times the voxels cost " +
             digits(b.seconds / a.seconds) + " times the seconds; 4 times the sources " +
             digits(d.seconds / a.seconds) + " times with the fewer voxels, " +
             digits(e.seconds / b.seconds) + " times with the more");
  table.note(
      "bytes/voxel: peak memory of the sum and its result of 48 bytes a voxel of the leaves, "
      "over interior voxels");
  table.note(
      "limit s: 48 bytes a voxel and the multiply-adds of the far charges' polynomial alone; of "
      "the "
      "direct sum: its pairs");
  return {table.json()};
}

}  // namespace innermap::bench
