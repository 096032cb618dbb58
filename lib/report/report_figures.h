// Figures of runs, beside those of results (report/figures.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/frame_files.h"
#include "innermap/core/vec3.h"
#include "innermap/field/fit.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

// "source", "target" and "laid"
struct ReportMesh {
  std::string path;
  std::uint64_t vertices = 0, triangles = 0;
  int boundaryLoops = 0, genus = 0, caps = 0;
  std::vector<Box3> capPlaces;
  double volume = 0, diagonal = 0;  // world units
  std::optional<std::uint64_t> selfIntersections;
};
Figures figures(const ReportMesh& mesh);

// "frames" of any command for animations; of `deform`, whose frames may be finished already; their
// seconds; what they are judged by.
Figures frameFigures(const std::vector<FrameResult>& results);
struct DeformedFrame {
  std::optional<InverseStatistics> inverse;
  std::optional<BoundaryError> error;
  std::optional<double> folded, outside;  // shares
};
Figures deformedFigures(const std::vector<DeformedFrame>& frames);
Figures finishedFigures(std::uint64_t before);
Figures leftFigures(std::uint64_t left);
Figures frameSeconds(double mean, double least, double most);
// What stands behind the line of a frame that misses the tolerance.
const char* missedMark(bool misses);
Figures judgedFigures(double tolerance, const std::vector<std::int64_t>& missed);

// "farm": how the parts of a run were made that was cut into shares.
struct FarmPart {
  std::string host, code;                    // the machine; its kind of vector code
  double seconds = 0, setup = 0;             // of a frame; of its worker before the first one
  std::uint64_t memory = 0;                  // bytes
  std::uint64_t restarts = 0, failures = 0;  // as Part has them
};
struct FarmFigures {
  std::vector<FarmPart> parts;
};
Figures figures(const FarmFigures& farm);

// "stages": what a job's stages took, a row for each kind of work that a stage is the sum of.
struct StageWork {
  std::string stage;
  double seconds = 0, coreSeconds = 0, expected = 0;  // of the whole stage
  std::string work;
  double times = 0;                                        // so often
  double inside = 0, surface = 0, charges = 0, items = 0;  // of what size
};
struct StageFigures {
  double alone = 0, together = 0;  // seconds of a block of work
  std::vector<StageWork> works;
};
Figures figures(const StageFigures& stages);

// Beside the sections.
Figures outsideFigures(double share);
Figures stoppedByTimeFigures();
Figures planFigures(double seconds, std::uint64_t bytes);

Figures voxelSizeFigures(double voxelSize);                            // "grid"
Figures findingFigures(const std::string& name, std::uint64_t count);  // "findings"
Figures memoryFigures(const std::string& stage, std::uint64_t bytes);  // "memory_after_bytes"
Figures shellFigures(std::uint64_t shells);                            // "sphere"
Figures polycubeMeshFigures(std::uint64_t vertices);                   // "polycube"
Figures pulledFigures(std::uint64_t voxels);                           // "pull"
Figures distanceRangeFigures(const std::pair<double, double>& range);  // "distance"
Figures blendFigures(std::uint64_t pieces, std::uint64_t groups);      // "seams"
Figures layoutFigures(const std::string& layout);                      // "texture"
// "texture": an image that is continued; a volume texture that was read.
struct ReportImage {
  std::string name, colourSpace;
  std::uint64_t count = 0;  // of files
  std::string channels;
  int width = 0, height = 0;  // pixels
  bool tiled = false;
};
Figures figures(const ReportImage& image);
struct ReportImport {
  std::vector<double> resolution;
  std::vector<std::string> grids;
  std::uint64_t active = 0, notFinite = 0;
};
Figures figures(const ReportImport& read);

}  // namespace innermap
