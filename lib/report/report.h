// What was done and how good it is, as a JSON file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/figure.h"

namespace innermap {

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

struct Report {
  std::string command;
  std::optional<ReportRun> run;
  Figures figures;  // with their sections in their keys: "solve.sources"
  std::vector<std::pair<std::string, double>> seconds;  // of each stage, in order
  std::uint64_t peakMemory = 0;                         // bytes
  std::vector<ReportFinding> verdict;
  std::vector<ReportOutput> outputs;  // but the report itself
  std::vector<std::string> notes, warnings;

  // Those of a section; "": beside the sections. Later ones of the same key win.
  void add(const std::string& section, const Figures& more);
};

// The report as indented JSON, as docs/report.schema.json says. Figures that are not known are left
// out; numbers that are not finite become null, text that is not UTF-8 (a path) gets replacement
// characters.
std::string reportJson(const Report& report);

// Throws FileError. The file appears whole or not at all.
void writeReport(const std::string& path, const Report& report);

}  // namespace innermap
