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

// Core seconds: at all, for a million voxels inside and on the surface, a thousand charges, an
// item; and the share of them that one core spends while the others wait. Measured on samples/ and
// models of 500 to 50,000 vertices at 96 to 512 voxels. "STAGE: WHAT" is a stage that takes another
// time when it does that.
struct StageCost {
  double once, inside, surface, charges, items, alone;
};

const std::map<std::string, StageCost>& stageCosts() {
  static const std::map<std::string, StageCost> kCosts = {
      {"level set", {0.05, 0, 12, 0, 0, 0.1}},
      {"evaluating the map", {0.01, 0.22, 0, 0, 0.25, 0.1}},
      {"repairing folds", {0.05, 1.2, 0, 0, 0, 0.1}},
      {"looking outside the target", {0.015, 0, 3.4, 0, 0, 0.1}},
      {"checking cells", {0.02, 0, 5.5, 0, 0, 0.6}},
      {"writing the VDB file", {0.01, 0.095, 0, 0, 0.004, 0.6}},
      {"writing slices", {0.03, 0.63, 0, 0, 0, 1}},
      {"drawing the section", {0.2, 0, 0, 0, 0, 0.5}},
      {"coarsening", {0.67, 0, 0, 0, 0.019, 0.6}},
      {"trying rotations", {0.56, 0, 0, 0, 0, 0.1}},
      {"trying first maps", {5.4, 0, 0, 0, 0.11, 0.15}},
      {"judging first maps", {0.58, 0, 0, 0, 0.016, 0.45}},
      {"refining the map", {1.6, 0, 0, 0, 0.082, 0.5}},
      {"measuring the map", {0.48, 0, 0, 0, 0.02, 0.5}},
      {"fitting", {1.1, 0, 0, 0, 0, 0.9}},
      {"fitting: a shell", {0.3, 0, 0, 0, 1, 0.6}},
      {"meeting the tolerance", {0.15, 0, 0, 0, 0.33, 0.45}},
      {"meeting the tolerance: cubes", {0, 0, 0, 0, 0.34, 0.45}},
      {"going in steps", {22, 0, 0, 0, 0, 0.25}},
      {"proving that nothing folds", {0.05, 0, 0, 0.13, 0, 0.1}},
      {"bounding the error", {0.05, 0, 0, 0.2, 0, 0.1}},
      {"proving one-to-one", {0.1, 0, 0, 1.6, 0, 0.1}},
      {"placing samples", {0.25, 0, 0, 0.08, 0, 0.25}},
      {"factoring", {0, 0, 0, 0.1, 0, 0.25}},
      {"factoring clusters", {0.1, 0, 0, 0.12, 0, 0}},
      {"solving", {0, 0, 0, 0, 0.045, 0.15}},
      {"frames", {0, 0, 0, 0.05, 0, 0.25}},
      {"frames: grids", {0, 0.2, 0, 0, 0.25, 0.25}},
      {"frames: proof", {0.1, 0, 0, 0.33, 0, 0.15}},
      {"frames: full proof", {0.2, 0, 0, 1.9, 0, 0.1}},
      {"frames: volume", {0.2, 3, 4, 0.08, 0.3, 0.25}},
      {"frames: geometry", {0.1, 0, 0, 0, 0.004, 0.25}},
      {"reading the image", {0.1, 0, 0, 0.011, 0, 0.4}},
      {"continuing inwards", {0, 2.9, 0, 0, 0.38, 0}},
      {"continuing inwards: colours", {0, 4.6, 0, 0, 0.6, 0}},
      {"meeting the surface", {0, 1.6, 0, 0, 0.24, 0.1}},
      {"looking up colours", {0.07, 0.475, 0, 0, 0, 0.1}},
      {"blending charts", {0, 0, 0, 0, 0.09, 0.1}},
      {"distances", {0.05, 1.4, 10, 0, 0, 0.1}},
      {"pulling the grids", {0, 0, 0, 0, 0.33, 0}},
      {"covering the target", {0.05, 1.2, 0, 0.05, 0, 0.3}},
      {"inverting the map", {0, 1.2, 0, 0.1, 0, 0.5}},
      {"carrying the grids", {0.02, 0, 0, 0, 0.3, 0}},
      {"finding the inside", {0, 0.6, 0, 0, 0, 0.2}},
      {"carrying the densities", {0, 0.7, 0, 0.02, 5, 0.1}},
      {"filling with tetrahedra", {0.03, 0, 0, 0, 0.1, 0.6}},
      {"level set: cells", {0.05, 0, 0, 0, 0.2, 0.2}},
      {"looking for thin parts", {0.05, 0, 0, 0, 0.1, 0.2}},
      {"fitting the boundary", {0.02, 0, 0, 0, 0.02, 0.3}},
      {"measuring cells", {0.01, 0, 0, 0, 0.33, 0.75}},
      {"comparing the boundaries", {0.07, 0, 0, 0, 0.02, 0}},
      {"writing cells", {0.02, 0, 0, 0, 0.1, 0.8}},
      {"repairing", {0, 0, 0, 0, 5, 0.25}},
      {"repairing the boundary", {0, 0, 0, 0, 27, 0.2}},
      {"improving shapes", {0, 0, 0, 0, 2.8, 0.3}},
      {"checking hexahedra", {0, 0, 0, 0, 0.1, 0.2}},
      {"untangling hexahedra", {0, 0, 0, 0, 0.29, 0.2}},
      {"shaping hexahedra", {0, 0, 0, 0, 1.86, 0.2}},
      {"evaluating the field", {0, 0, 0, 0, 0.3, 0.1}},
      {"runs", {0, 0, 0, 0, 1.3, 0.5}},
  };
  return kCosts;
}

constexpr double kMillion = 1e6, kThousand = 1e3;

double secondsOf(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Of this machine, as busy as it is now: seconds for a second of work of one core of the machine
// that the costs are from, where one core works alone and where all do.
struct Pace {
  double alone, together;
};

Pace measurePace() {
  constexpr double kBlockSeconds = 7.6e-5;  // of one core there
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
  const auto found = stageCosts().find(stage);
  if (found == stageCosts().end()) throw Error("no cost is known of " + stage);
  const StageCost& c = found->second;
  const double work = c.once + c.inside * size.inside + c.surface * size.surface +
                      c.charges * size.charges + c.items * size.items;
  const Pace& pace = machinePace();
  const double seconds = work * (c.alone * pace.alone + (1 - c.alone) * pace.together);
  // A size that cannot be is refused elsewhere, with what is wrong.
  JobPhase phase{stage.substr(0, stage.find(':')), std::isfinite(seconds) ? times * seconds : 0,
                 false, title};
  phase.times = times;
  return phase;
}

// Near sums: those of a charge with the voxels about it, whose places are along the surface.
constexpr double kNearPower = 0.85;

JobSize withNearSums(JobSize size) {
  size.items = std::pow(size.surface * size.charges, kNearPower);
  return size;
}

std::vector<JobPhase> evaluationPhases(const JobSize& size) {
  JobPhase folds = stageOf("repairing folds", size);
  folds.perhaps = true;
  folds.steady = false;
  return {stageOf("level set", size),
          stageOf("evaluating the map", withNearSums(size)),
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
  all.seconds = static_cast<double>(frames) * (all.seconds + perFrame.seconds);
  all.gate = true;
  return {stageOf("placing samples", size), stageOf("factoring", size),
          stageOf("factoring clusters", size), all};
}

}  // namespace innermap::tool
