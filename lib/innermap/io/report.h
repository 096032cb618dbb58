// What was done and how good it is, as a JSON file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace innermap {

struct ReportMesh {
  std::string path;
  std::uint64_t vertices = 0, triangles = 0;
  int boundaryLoops = 0, caps = 0, genus = 0;
  double volume = 0;    // world units cubed
  double diagonal = 0;  // world units
};

struct ReportSolve {
  std::string method;
  std::uint64_t sources = 0, collocation = 0, rank = 0;
  double regularization = 0;
  int iterations = 0;
};

struct ReportBoundaryError {  // fractions of the target's diagonal
  double rms = 0, p99 = 0, max = 0;
  std::uint64_t samples = 0;
  double cError = 0;  // sum of squares at the collocation points
};

struct ReportEnergy {
  double harmonic = 0, deformation = 0;
};

struct ReportJacobian {
  double min = 0, max = 0, foldedFraction = 0;
};

struct ReportGrid {
  double voxelSize = 0;  // world units
  std::uint64_t activeVoxels = 0, interiorVoxels = 0;
};

using ReportValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                                 std::vector<std::string>>;

// What ran, when and where.
struct ReportRun {
  std::string version;                   // of innermap
  std::vector<std::string> commandLine;  // as given
  std::string date;                      // of the start, UTC, ISO 8601: "2026-01-31T23:59:59Z"
  int cores = 0, threads = 0;            // of the machine; that may be used
  // Every argument and option by its name without dashes in front, with the value that it had; NaN:
  // left to the command.
  std::vector<std::pair<std::string, ReportValue>> settings;
};

// One thing that a result is judged by.
struct ReportFinding {
  std::string name;                 // "boundary", "folds"
  std::string statement;            // what was found, one line
  double value = 0, threshold = 0;  // met: the value is at most the threshold
  bool met = true;
  std::string advice;  // what to try, when it is not met
};

struct ReportOutput {
  std::string path;
  std::uint64_t bytes = 0;
};

// Sections that were not computed are left out of the file.
struct Report {
  std::string command;
  std::optional<ReportRun> run;
  std::optional<ReportMesh> source, target;
  std::optional<ReportSolve> solve;
  std::optional<ReportBoundaryError> boundaryError;
  std::optional<ReportEnergy> energy;
  std::optional<ReportJacobian> jacobian;
  std::optional<ReportGrid> grid;
  std::vector<std::pair<std::string, double>> seconds;  // of each stage, in order
  std::uint64_t peakMemory = 0;                         // bytes
  std::vector<ReportFinding> verdict;
  std::vector<ReportOutput> outputs;  // but the report itself
  std::vector<std::string> notes, warnings;

  // Further keys. A dot leads into a section: "solve.distance" stands beside "sources" in "solve".
  // Later values of the same key win.
  std::vector<std::pair<std::string, ReportValue>> extra;
  void set(std::string key, ReportValue value);
  template <class Count,
            std::enable_if_t<std::is_integral_v<Count> && !std::is_same_v<Count, bool>, int> = 0>
  void set(std::string key, Count value) {
    set(std::move(key), ReportValue(static_cast<std::int64_t>(value)));
  }
  // of(entry) of each entry of the list; numbers that are missing: NaN.
  template <class List, class Of>
  void setColumn(std::string key, const List& list, const Of& of) {
    std::vector<double> column;
    for (const auto& entry : list) column.push_back(static_cast<double>(of(entry)));
    set(std::move(key), std::move(column));
  }
};

// The report as indented JSON, as docs/report.schema.json says; numbers that are not finite become
// null, text that is not UTF-8 (a path) gets replacement characters.
std::string reportJson(const Report& report);

// Throws FileError. The file appears whole or not at all.
void writeReport(const std::string& path, const Report& report);

}  // namespace innermap
