#include "report/sequence_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "report/figures.h"
#include "report/table.h"

namespace innermap {

namespace {

// A row has no lists.
Figures proofOf(const ProofFigures& proof) {
  Figures out = when(proof.cells > 0, figures(proof));
  out.erase(std::remove_if(out.begin(), out.end(),
                           [](const Figure& f) {
                             return std::holds_alternative<std::vector<double>>(f.value);
                           }),
            out.end());
  return out;
}

}  // namespace

SequenceRow sequenceRow(const FrameFit& fit, const MapGrids& grids) {
  SequenceRow row;
  row.outside = fit.injectivity.outside;
  row.error = fit.error;
  row.harmonic = grids.harmonicTotal;
  row.deformation = grids.deformationTotal;
  row.deformationMean = grids.volume > 0 ? grids.deformationTotal / grids.volume : 0;
  row.jacobianMin = grids.jacobianMin;
  row.jacobianMax = grids.jacobianMax;
  row.folded = grids.foldedFraction;
  row.volume = fit.boundary.volume;
  row.proof = fit.injectivity.proof;
  if (fit.injectivity.boundary.checked > 0) row.statement = injectivityStatement(fit.injectivity);
  return row;
}

Figures figures(const SequenceRow& r) {
  Figures out;
  eachNumber(r, [&](const auto&... figure) { out.emplace_back(figure...); });
  out.emplace_back("tolerance_met", !r.misses, "tolerance met", "1: it is");
  out.emplace_back("seconds", r.seconds, "time", "", FigureUnit::seconds);
  return when(r.broken.empty(), together({std::move(out),
                                          proofOf(r.proof),
                                          {Figure("statement", r.statement, "one-to-one, in words",
                                                  "what was proven and checked")
                                               .when(!r.statement.empty())}}));
}

Figures worstFigures(const std::vector<SequenceRow>& rows) {
  BoundaryError worst;
  for (const SequenceRow& r : rows) {
    worst.rms = std::max(worst.rms, r.error.rms);
    worst.p99 = std::max(worst.p99, r.error.p99);
    worst.max = std::max(worst.max, r.error.max);
    worst.samples = std::max(worst.samples, r.error.samples);
  }
  return figures(worst);
}

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
  writeTable(
      path, columns(rows, [](const SequenceRow& r) -> Figures {
        return together({{{"frame", r.file.number, "frames"}, {"file", r.file.path, "files"}},
                         figures(r),
                         {{"error", r.broken, "what broke it"}}});
      }));
}

SvgChart sequenceChart(const std::vector<SequenceRow>& rows, const std::string& rest) {
  constexpr double kLeastHarmonic = 1e-3, kLeastDeformation = 1e-9;
  std::vector<double> numbers;
  double worst = 0, folded = 0;
  std::size_t broken = 0;
  for (const SequenceRow& r : rows) {
    numbers.push_back(static_cast<double>(r.file.number));
    broken += !r.broken.empty();
    worst = std::max(worst, r.error.p99);
    folded = std::max(folded, r.folded);
  }
  const Figures table = columns(rows, [](const SequenceRow& r) { return figures(r); });
  const auto panel = [&](const std::string& title, const std::string& key, double leastSpan) {
    SvgPanel out;
    out.title = title;
    out.xLabel = "frame";
    out.yLeastSpan = leastSpan;
    out.series = {{{}, numbers, std::get<std::vector<double>>(findFigure(table, key)->value)}};
    return out;
  };
  SvgChart chart;
  chart.title = "Energy of the maps from " + std::filesystem::path(rest).filename().string();
  chart.subtitle = fmt::format(
      "{} frames{}; 99% of the boundary within {:.2g} of the diagonal in all, at most {:.2g}% of "
      "the volume folded",
      rows.size(), broken ? fmt::format(", {} of them broken", broken) : std::string(), worst,
      100 * folded);
  chart.panels = {panel("harmonic energy (3: rigid)", "harmonic", kLeastHarmonic),
                  panel("deformation energy (0: rigid)", "deformation", kLeastDeformation)};
  chart.panelsAcross = 1;
  chart.panelWidth = 960;
  chart.panelHeight = 280;
  return chart;
}

void fillReport(const std::vector<SequenceRow>& rows, Report& report) {
  report.add("energies", columns(rows, [](const SequenceRow& r) { return figures(r); }));
  report.add("worst_boundary_error", worstFigures(rows));
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

}  // namespace innermap
