#include "job_cost.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"

namespace innermap::tool {
namespace {

// What a stage's time grows with (null: nothing); core seconds at all, and for each unit of that
// (JobSize); the share of them that one core spends while the others wait; whether measured runs
// are within a factor of two of that.
struct StageWeight {
  double JobSize::*measure;
  double once, weight, alone;
  bool steady;
};

#include "stage_weights.inc"

constexpr double kMillion = 1e6, kThousand = 1e3;

double secondsOf(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Of this machine, as busy as it is now: seconds for a second of work of one core of the machine
// that the weights are from, where one core works alone and where all do.
struct Pace {
  double alone, together;
};

Pace measurePace() {
  constexpr std::size_t kCharges = 1024, kPoints = 256, kBlocks = 500, kFirst = 12;
  Points places(kCharges), points(kPoints);
  for (std::size_t i = 0; i < kCharges; ++i)
    places[i] = {std::sin(0.1 * static_cast<double>(i)), std::cos(0.3 * static_cast<double>(i)), 1};
  for (std::size_t i = 0; i < kPoints; ++i) points[i] = {0.01 * static_cast<double>(i), 0, 0};
  const Charges charges(places, Matrix(kCharges, 3));
  const auto block = [&](std::size_t, std::size_t) {
    std::vector<double> values(3 * kPoints);
    charges.addTo(points.data(), kPoints, values.data(), nullptr);
  };
  parallelBlocks(kFirst, 1, block);  // wakes the processor, and starts the threads
  // The middle of some tries: one may be broken off by what else runs.
  std::array<double, 5> alone{};
  for (double& seconds : alone)
    seconds = secondsOf([&] {
      for (std::size_t i = 0; i < kFirst; ++i) block(0, 1);
    });
  std::sort(alone.begin(), alone.end());
  Pace pace{};
  pace.alone = alone[alone.size() / 2] / (kFirst * kBlockSeconds);
  pace.together = secondsOf([&] { parallelBlocks(kBlocks, 1, block); }) / (kBlocks * kBlockSeconds);
  return pace;
}

// Measured once, in some milliseconds.
const Pace& machinePace() {
  static const Pace kPace = measurePace();
  return kPace;
}

}  // namespace

JobSize jobSize(double volume, double area, double voxelSize, std::size_t charges) {
  JobSize size;
  size.inside = volume / std::pow(voxelSize, 3) / kMillion;
  size.surface = area / (voxelSize * voxelSize) / kMillion;
  size.charges = static_cast<double>(charges) / kThousand;
  return size;
}

JobPhase stageOf(const std::string& stage, const JobSize& size, int times,
                 const std::string& title) {
  const auto found = stageWeights().find(stage);
  if (found == stageWeights().end()) throw Error("no weight is known of " + stage);
  const StageWeight& w = found->second;
  const double work = w.once + w.weight * (w.measure ? size.*w.measure : 1);
  const Pace& pace = machinePace();
  const double seconds = work * (w.alone * pace.alone + (1 - w.alone) * pace.together);
  // A size that cannot be is refused elsewhere, with what is wrong.
  JobPhase phase{stage.substr(0, stage.find(':')), std::isfinite(seconds) ? seconds : 0, false,
                 title};
  phase.doubtful = w.steady ? 0 : phase.seconds;
  phase.works = {{stage, size}};
  phase.times = times;
  phase *= times;
  return phase;
}

StageFigures stageFigures(const std::vector<JobPhaseTaken>& taken) {
  const Pace& pace = machinePace();
  StageFigures out{kBlockSeconds * pace.alone, kBlockSeconds * pace.together, {}};
  for (const JobPhaseTaken& t : taken)
    for (const auto& [row, size, times] : t.phase.works)
      out.works.push_back({t.phase.stage, t.seconds, t.coreSeconds, t.phase.seconds, row, times,
                           size.inside, size.surface, size.charges, size.items});
  return out;
}

std::vector<JobPhase> evaluationPhases(const JobSize& size) {
  JobPhase folds = stageOf("repairing folds", size);
  folds.perhaps = true;
  folds.steady = false;
  return {stageOf("level set", size),
          stageOf("evaluating the map", size),
          folds,
          stageOf("looking outside the target", size),
          stageOf("checking cells", size),
          stageOf("writing the VDB file", size)};
}

double bentPlaces(const Mesh& source, const Points& moved, double tolerance) {
  constexpr double kFlat = 1e-3;  // of the edges' spread: what lies across a flat surface is open
  struct Affine {
    Mat3 edges{}, images{};
    double bend = 0;
    int count = 0;
  };
  std::vector<Affine> at(source.vertices.size());
  const auto eachEdge = [&](const auto& body) {
    for (const Triangle& t : source.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(t[k]), w = static_cast<std::size_t>(t[(k + 1) % 3]);
        body(at[v], source.vertices[w] - source.vertices[v], moved[w] - moved[v]);
        body(at[w], source.vertices[v] - source.vertices[w], moved[v] - moved[w]);
      }
  };
  eachEdge([](Affine& a, const Vec3& edge, const Vec3& image) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        a.edges[i][j] += edge[static_cast<int>(i)] * edge[static_cast<int>(j)];
        a.images[i][j] += image[static_cast<int>(i)] * edge[static_cast<int>(j)];
      }
  });
  for (Affine& a : at) {
    const double spread = a.edges[0][0] + a.edges[1][1] + a.edges[2][2];
    for (std::size_t i = 0; i < 3; ++i) a.edges[i][i] += kFlat * spread + 1e-300;
    a.images = product(a.images, inverse(a.edges));
  }
  eachEdge([](Affine& a, const Vec3& edge, const Vec3& image) {
    a.bend += squaredNorm(image - a.images * edge);
    ++a.count;
  });
  const double allowed = tolerance * boundingBox(moved).diagonal();
  double places = 0;
  for (const Affine& a : at)
    if (a.count > 0) places += std::sqrt(a.bend / a.count) / allowed;
  return std::isfinite(places) ? places / kThousand : 0;
}

double likelyPlaces(std::size_t vertices, double tolerance) {
  constexpr double kLikelyBend = 1e-3;
  return static_cast<double>(vertices) / kThousand * kLikelyBend / tolerance;
}

std::vector<JobPhase> correspondPhases(std::size_t vertices) {
  JobSize size;
  size.items = static_cast<double>(vertices) / kThousand;
  return {stageOf("coarsening", size),        stageOf("trying rotations", size),
          stageOf("trying first maps", size), stageOf("judging first maps", size),
          stageOf("refining the map", size),  stageOf("measuring the map", size)};
}

std::vector<JobPhase> framePhases(std::size_t charges, std::size_t frames,
                                  const JobPhase& perFrame) {
  JobSize size;
  size.charges = static_cast<double>(charges) / kThousand;
  JobPhase all = stageOf("frames", size);
  all += perFrame;
  all *= static_cast<double>(frames);
  all.gate = true;
  return {stageOf("placing samples", size), stageOf("factoring clusters", size), all};
}

}  // namespace innermap::tool
