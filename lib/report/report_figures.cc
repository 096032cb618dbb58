#include "report/report_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "report/figures.h"

namespace innermap {

Figures figures(const ReportMesh& m) {
  return together(
      {{{"path", m.path, "file", ""},
        {"vertices", m.vertices, "vertices", ""},
        {"triangles", m.triangles, "triangles", ""},
        {"boundary_loops", m.boundaryLoops, "open loops", "of edges with one triangle only"},
        {"caps", m.caps, "caps", "holes that were closed"},
        {"genus", m.genus, "handles", "0 for a ball, 1 for a ring"},
        {"volume", m.volume, "volume", "", FigureUnit::volume},
        {"diagonal", m.diagonal, "diagonal", "of the bounding box", FigureUnit::length}},
       when(!m.capPlaces.empty(), under("cap_places", "caps", placeFigures(m.capPlaces))),
       {{"self_intersections", m.selfIntersections, "self-intersections",
         "pairs of triangles that pass through each other"}}});
}

Figures frameFigures(const std::vector<FrameResult>& results) {
  std::vector<std::string> broken;
  for (const FrameResult& r : results)
    if (!r.error.empty()) broken.push_back(fmt::format("{}: {}", r.file.number, r.error));
  const auto frame = [](const FrameResult& r) -> Figures {
    return {{"number", r.file.number, "numbers", ""},
            {"file", r.file.path, "files", ""},
            {"seconds", r.seconds, "times", "", kSeconds}};
  };
  return together({{{"count", results.size(), "frames", ""},
                    {"broken", broken, "broken frames", "number and reason"}},
                   columns(results, frame)});
}

Figures deformedFigures(const std::vector<DeformedFrame>& frames) {
  return columns(frames, [](const DeformedFrame& f) -> Figures {
    const InverseStatistics inverse = f.inverse.value_or(InverseStatistics{});
    const BoundaryError error = f.error.value_or(BoundaryError{});
    return together(
        {when(f.inverse.has_value(),
              {{"voxels", inverse.voxels, "voxels", "that were asked where they come from"},
               {"inverted_fraction", inverse.invertedInside(), "found",
                "share of the voxels inside whose origin was found", kShare}}),
         when(f.error.has_value(),
              {{"boundary_rms", error.rms, "boundary error", "root mean square", kDiagonals},
               {"boundary_p99", error.p99, "boundary error", "99% within", kDiagonals},
               {"boundary_max", error.max, "boundary error", "largest", kDiagonals}}),
         {{"folded_fraction", f.folded, "folded", "of the inside", kShare},
          {"outside_fraction", f.outside, "outside", "of the inside", kShare}}});
  });
}

Figures finishedFigures(std::uint64_t before) {
  return {{"finished_before", before, "finished before", "this run"}};
}

Figures figures(const FarmFigures& farm) {
  constexpr std::array<double, 3> kMachines{1, 10, 100};
  std::map<std::string, double> hosts;
  std::set<std::string> codes;
  double sum = 0, longest = 0, setup = 0;
  std::uint64_t memory = 0, restarted = 0, failures = 0;
  for (const FarmPart& p : farm.parts) {
    restarted += p.restarts > 0;
    failures += p.failures;
    hosts[p.host] += 1;
    codes.insert(p.code);
    sum += p.seconds;
    longest = std::max(longest, p.seconds);
    setup = std::max(setup, p.setup);
    memory = std::max(memory, p.memory);
  }
  std::vector<std::string> names;
  std::vector<double> counts, times;
  for (const auto& [name, count] : hosts) {
    names.push_back(name);
    counts.push_back(count);
  }
  for (const double n : kMachines) times.push_back(setup + std::max(longest, sum / n));
  return {
      {"hosts", names, "machines", "that made frames"},
      {"host_frames", counts, "frames of each machine", ""},
      {"code", std::vector<std::string>(codes.begin(), codes.end()), "vector code",
       "kinds; results of one kind are the same to the bit"},
      {"seconds", sum, "time of all frames", "one after the other", kSeconds},
      {"setup_seconds", setup, "set-up", "of a worker, before its first frame", kSeconds},
      {"peak_memory_bytes", memory, "peak memory", "of the worker with most", FigureUnit::bytes},
      {"restarted", restarted, "made by restarted tasks", "frames, as far as the engine tells"},
      {"failed_tries", failures, "failed tries", "of frames that were tried again"},
      {"machines", std::vector<double>(kMachines.begin(), kMachines.end()),
       "so many machines alike", ""},
      {"machines_seconds", times, "would take", "at best", kSeconds}};
}

Figures figures(const StageFigures& stages) {
  const auto work = [](const StageWork& w) -> Figures {
    return {{"stage", w.stage, "stages", ""},
            {"seconds", w.seconds, "times", "of the stage", kSeconds},
            {"core_seconds", w.coreSeconds, "times of all cores", "of the stage", kSeconds},
            {"expected_seconds", w.expected, "expected times", "of the stage", kSeconds},
            {"work", w.work, "works", "that a stage is the sum of"},
            {"times", w.times, "so often", ""},
            {"inside", w.inside, "voxels inside", "millions"},
            {"surface", w.surface, "voxels of the surface", "millions"},
            {"charges", w.charges, "charges", "thousands"},
            {"items", w.items, "items", "that this kind of work counts"}};
  };
  return together({{{"block_seconds_alone", stages.alone, "pace", "of a core alone", kSeconds},
                    {"block_seconds", stages.together, "pace", "of all cores", kSeconds}},
                   columns(stages.works, work)});
}

Figures leftFigures(std::uint64_t left) {
  return {{"left", left, "left", "not begun, as --max-time ended"}};
}

Figures frameSeconds(double mean, double least, double most) {
  return {{"seconds_mean", mean, "seconds a frame", "mean", kSeconds},
          {"seconds_least", least, "fastest frame", "", kSeconds},
          {"seconds_most", most, "slowest frame", "", kSeconds}};
}

const char* missedMark(bool misses) { return misses ? "  misses the tolerance" : ""; }

Figures judgedFigures(double tolerance, const std::vector<std::int64_t>& missed) {
  return {{"tolerance", tolerance, "tolerance", "that frames are judged by", kDiagonals},
          {"missed", std::vector<double>(missed.begin(), missed.end()), "missed",
           "numbers of the frames that miss it"}};
}

Figures outsideFigures(double share) {
  return {{"outside_fraction", share, "outside",
           "share of the inside that lands outside the target by more than the error of 99% of the "
           "boundary",
           kShare}};
}

Figures stoppedByTimeFigures() {
  return {{"stopped_by_time", true, "stopped by time",
           "--max-time ended something: another run may differ"}};
}

Figures planFigures(double seconds, std::uint64_t bytes) {
  return {
      Figure("seconds_expected", seconds, "time needed", "estimate", kSeconds).when(seconds > 0),
      {"dry_run", true, "dry run", "nothing was done but planned"},
      {"memory_needed_bytes", bytes, "memory needed", "estimate", FigureUnit::bytes}};
}

Figures voxelSizeFigures(double voxelSize) {
  return only(gridFigures(voxelSize, 0, 0), {"voxel_size"});
}

Figures findingFigures(const std::string& name, std::uint64_t count) {
  return {{name, count, name, "how many"}};
}

Figures memoryFigures(const std::string& stage, std::uint64_t bytes) {
  return {{stage, bytes, stage, "the most memory that the process had held when it ended",
           FigureUnit::bytes}};
}

Figures shellFigures(std::uint64_t shells) { return {{"shells", shells, "shells", ""}}; }

Figures polycubeMeshFigures(std::uint64_t vertices) {
  return {{"vertices", vertices, "vertices", "of the surface that was written"}};
}

Figures pulledFigures(std::uint64_t voxels) { return {{"voxels", voxels, "voxels", ""}}; }

Figures distanceRangeFigures(const std::pair<double, double>& range) {
  return {{"range", std::vector<double>{range.first, range.second}, "range", "of the colours",
           FigureUnit::length}};
}

Figures blendFigures(std::uint64_t pieces, std::uint64_t groups) {
  return {{"pieces", pieces, "pieces", "that the charts come in"},
          {"groups", groups, "groups", "of these, whose seams are blended"}};
}

Figures layoutFigures(const std::string& layout) { return {{"layout", layout, "layout", ""}}; }

Figures figures(const ReportImage& image) {
  return together({{{"image", image.name, "image", ""}},
                   when(image.count > 0, {{"colour_space", image.colourSpace, "colour space", ""},
                                          {"image_channels", image.channels, "channels", ""},
                                          {"width", image.width, "width", "pixels"},
                                          {"height", image.height, "height", "pixels"}}),
                   {Figure("image_tiles", image.count, "tiles", "files").when(image.tiled)}});
}

Figures figures(const ReportImport& read) {
  return {{"resolution", read.resolution, "resolution", "voxels along x, y and z"},
          {"grids", read.grids, "grids", ""},
          {"active_voxels", read.active, "active voxels", "of all grids"},
          {"not_finite", read.notFinite, "not finite", "values that are infinite or no numbers"}};
}

}  // namespace innermap
