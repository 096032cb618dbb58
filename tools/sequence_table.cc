#include "sequence_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <ostream>

#include "innermap/core/file.h"

namespace innermap::tool {
namespace {

struct Column {
  const char* name;
  double (*value)(const SequenceRow&);
};

// The CSV's figures, in order.
const Column kColumns[] = {
    {"harmonic", [](const SequenceRow& r) { return r.harmonic; }},
    {"deformation", [](const SequenceRow& r) { return r.deformation; }},
    {"deformation_mean", [](const SequenceRow& r) { return r.deformationMean; }},
    {"boundary_rms", [](const SequenceRow& r) { return r.error.rms; }},
    {"boundary_p99", [](const SequenceRow& r) { return r.error.p99; }},
    {"boundary_max", [](const SequenceRow& r) { return r.error.max; }},
    {"jacobian_min", [](const SequenceRow& r) { return r.jacobianMin; }},
    {"jacobian_max", [](const SequenceRow& r) { return r.jacobianMax; }},
    {"folded_fraction", [](const SequenceRow& r) { return r.folded; }},
    {"volume", [](const SequenceRow& r) { return r.volume; }},
    {"outside_fraction", [](const SequenceRow& r) { return r.outside; }},
    {"tolerance_met", [](const SequenceRow& r) { return r.misses ? 0.0 : 1.0; }},
    {"seconds", [](const SequenceRow& r) { return r.seconds; }}};

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::vector<double> values(const std::vector<SequenceRow>& rows,
                           double (*value)(const SequenceRow&)) {
  std::vector<double> out;
  for (const SequenceRow& r : rows)
    out.push_back(r.broken.empty() ? value(r) : std::numeric_limits<double>::quiet_NaN());
  return out;
}

}  // namespace

std::vector<SequenceRow> withBroken(const std::vector<SequenceRow>& rows,
                                    const std::vector<FrameResult>& results) {
  std::vector<SequenceRow> out;
  auto good = rows.begin();
  for (const FrameResult& result : results) {
    SequenceRow row;
    if (result.error.empty()) row = *good++;
    row.file = result.file;
    row.broken = result.error;
    row.seconds = result.seconds;
    out.push_back(std::move(row));
  }
  return out;
}

void writeSequenceTable(const std::string& path, const std::vector<SequenceRow>& rows) {
  writeWholeFile(path, [&](std::ostream& file) {
    file << "frame,file";
    for (const Column& column : kColumns) file << "," << column.name;
    file << ",error\n";
    for (const SequenceRow& row : rows) {
      file << row.file.number << "," << quoted(row.file.path);
      for (const Column& column : kColumns)
        file << "," << (row.broken.empty() ? fmt::format("{:.9g}", column.value(row)) : "");
      file << "," << quoted(row.broken) << "\n";
    }
  });
}

Chart sequenceChart(const std::vector<SequenceRow>& rows, const std::string& rest) {
  constexpr double kLeastHarmonic = 1e-3, kLeastDeformation = 1e-9;
  Chart chart;
  chart.title = "Energy of the maps from " + std::filesystem::path(rest).filename().string();
  double worst = 0, folded = 0;
  std::size_t broken = 0;
  for (const SequenceRow& r : rows) {
    chart.x.push_back(static_cast<double>(r.file.number));
    broken += !r.broken.empty();
    worst = std::max(worst, r.error.p99);
    folded = std::max(folded, r.folded);
  }
  chart.subtitle = fmt::format(
      "{} frames{}; 99% of the boundary within {:.2g} of the diagonal in all, at most {:.2g}% of "
      "the "
      "volume folded",
      rows.size(), broken ? fmt::format(", {} of them broken", broken) : std::string(), worst,
      100 * folded);
  chart.xLabel = "frame";
  ChartPanel harmonic{"harmonic energy (3: rigid)", kLeastHarmonic, {}},
      deformation{"deformation energy (0: rigid)", kLeastDeformation, {}};
  harmonic.series.push_back({"harmonic", values(rows, kColumns[0].value)});
  deformation.series.push_back({"deformation", values(rows, kColumns[1].value)});
  chart.panels = {harmonic, deformation};
  return chart;
}

void fillReport(const std::vector<SequenceRow>& rows, Report& report) {
  for (const Column& column : kColumns)
    report.set(std::string("energies.") + column.name, values(rows, column.value));
  BoundaryError worst;
  for (const SequenceRow& r : rows) {
    worst.rms = std::max(worst.rms, r.error.rms);
    worst.p99 = std::max(worst.p99, r.error.p99);
    worst.max = std::max(worst.max, r.error.max);
    worst.samples = std::max(worst.samples, r.error.samples);
  }
  report.set("worst_boundary_error.rms", worst.rms);
  report.set("worst_boundary_error.p99", worst.p99);
  report.set("worst_boundary_error.max", worst.max);
  report.set("worst_boundary_error.samples", worst.samples);
}

std::string sequenceHeader() {
  return fmt::format("{:>8} {:>12} {:>12} {:>10} {:>10} {:>9} {:>9}\n", "frame", "harmonic",
                     "deformation", "error rms", "error 99%", "least det", "folded %");
}

std::string sequenceLine(const SequenceRow& r) {
  return fmt::format("{:>8} {:>12.6g} {:>12.6g} {:>10.2e} {:>10.2e} {:>9.3g} {:>9.3g}{}\n",
                     r.file.number, r.harmonic, r.deformation, r.error.rms, r.error.p99,
                     r.jacobianMin, 100 * r.folded, missedMark(r.misses));
}

}  // namespace innermap::tool
