#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/study/study.h"

namespace innermap {
namespace {

// Errors that differ by less are taken for alike.
constexpr double kAlike = 1.05;
// So much larger than the best, an error has risen.
constexpr double kRisen = 1.25;
// So much larger between the collocation points than at them, what is said at them misleads.
constexpr double kMisleads = 2;

using Rows = std::vector<StudyRow>;
using Figure = double StudyRow::*;

double valueOf(const StudyRow& row, StudyAxis axis) {
  if (axis == StudyAxis::place) return row.at;
  return axis == StudyAxis::sources ? static_cast<double>(row.sources) : row.collocation;
}

std::size_t leastOf(const Rows& rows, Figure figure) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (rows[i].*figure < rows[best].*figure) best = i;
  return best;
}

double spacingOf(const Study& study, const StudyRun& run) {
  return study.spacing / std::sqrt(static_cast<double>(run.sources));
}

// "0.0025: 1.2e-03, 0.005: 8e-04"
std::string listed(const Rows& rows, StudyAxis axis, Figure figure) {
  std::string text;
  for (const StudyRow& row : rows)
    text +=
        fmt::format("{}{:.4g}: {:.2g}", text.empty() ? "" : ", ", valueOf(row, axis), row.*figure);
  return text;
}

// Does the figure fall along the series? Steps that rise by under kAlike count as level.
StatementVerdict falls(const Rows& rows, Figure figure) {
  if (rows.size() < 2) return StatementVerdict::unknown;
  const bool lower = rows.front().*figure > kAlike * (rows.back().*figure);
  std::size_t rises = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    rises += rows[i].*figure > kAlike * (rows[i - 1].*figure);
  if (!lower) return StatementVerdict::fails;
  return rises == 0 ? StatementVerdict::holds : StatementVerdict::partly;
}

// Nearer charges, smaller error: the series is walked from its far end.
StudyStatement closer(const Study& study, Figure figure, const std::string& name) {
  Rows rows = studySeries(study, StudyAxis::place, ChargePlacement::offset);
  StudyStatement s{
      "Charges nearer to the surface give a smaller " + name, StatementVerdict::unknown, {}};
  if (rows.size() < 2) return s;
  s.figures = "distance: " + name + ": " + listed(rows, StudyAxis::place, figure);
  const std::size_t best = leastOf(rows, figure);
  s.figures += fmt::format("; least at {:.4g}, {:.2g} spacings of the charges", rows[best].at,
                           rows[best].at / spacingOf(study, rows[best]));
  std::reverse(rows.begin(), rows.end());
  s.verdict = falls(rows, figure);
  if (s.verdict == StatementVerdict::fails && best + 1 < rows.size())
    s.verdict = StatementVerdict::partly;  // it falls at first, and rises again
  return s;
}

StudyStatement tooNear(const Study& study) {
  const Rows rows = studySeries(study, StudyAxis::place, ChargePlacement::offset);
  StudyStatement s{"Charges too near to the surface are unstable", StatementVerdict::unknown, {}};
  if (rows.size() < 2) return s;
  const StudyRow &nearest = rows.front(), &best = rows[leastOf(rows, &StudyRow::rms)];
  s.figures = fmt::format(
      "at {:.4g} ({:.2g} spacings) the error at fresh points is {:.3g} times the least, {:.3g} "
      "times that at the collocation points; weights {:.2g}, condition {:.2g} there, {:.2g} and "
      "{:.2g} at the best distance, {:.4g}",
      nearest.at, nearest.at / spacingOf(study, nearest), nearest.rms / best.rms,
      nearest.rms / nearest.collocationRms, nearest.weights, nearest.condition, best.weights,
      best.condition, best.at);
  const bool rises = nearest.rms > kRisen * best.rms,
             misleads = nearest.rms > kMisleads * nearest.collocationRms;
  s.verdict = rises && misleads ? StatementVerdict::holds
              : rises           ? StatementVerdict::partly
                                : StatementVerdict::fails;
  return s;
}

StudyStatement sphere(const Study& study) {
  const Rows spheres = studySeries(study, StudyAxis::place, ChargePlacement::sphere),
             offsets = studySeries(study, StudyAxis::place, ChargePlacement::offset);
  StudyStatement s{"Charges on a sphere are worse than on an offset of the surface",
                   StatementVerdict::unknown,
                   {}};
  if (spheres.empty() || offsets.empty()) return s;
  const StudyRow &best = spheres[leastOf(spheres, &StudyRow::rms)],
                 &other = offsets[leastOf(offsets, &StudyRow::rms)];
  double worst = 0;
  for (const StudyRow& row : offsets) worst = std::max(worst, row.rms);
  s.figures = fmt::format(
      "the best sphere, {:.3g} half diagonals, has {:.2g} (rms), the best offset, {:.4g}, {:.2g}: "
      "{:.3g} times; the worst offset {:.2g}",
      best.at, best.rms, other.at, other.rms, best.rms / other.rms, worst);
  s.verdict = best.rms > kAlike * other.rms ? StatementVerdict::holds : StatementVerdict::fails;
  return s;
}

StudyStatement more(const Study& study, StudyAxis axis, Figure figure, const std::string& text) {
  const Rows rows = studySeries(study, axis, ChargePlacement::offset);
  StudyStatement s{text, falls(rows, figure), {}};
  if (rows.size() < 2) return s;
  s.figures = std::string(axis == StudyAxis::sources ? "charges" : "points a charge") + ": " +
              listed(rows, axis, figure);
  return s;
}

std::string figuresOf(const StudyRow& row) {
  return fmt::format("99% within {:.2g} of the diagonal, rms {:.2g}, {:.2g}% folded, {:.2g} s",
                     row.p99, row.rms, 100 * row.folded, row.seconds);
}

// The best distance for each number of charges of the grid.
std::string distancesAdvice(const Study& study, const Rows& rows) {
  Rows best;
  for (const StudyRow& row : rows) {
    if (row.placement != ChargePlacement::offset) continue;
    const auto same = std::find_if(best.begin(), best.end(),
                                   [&](const StudyRow& b) { return b.sources == row.sources; });
    if (same == best.end())
      best.push_back(row);
    else if (row.p99 < same->p99)
      *same = row;
  }
  if (best.empty()) return {};
  std::sort(best.begin(), best.end(),
            [](const StudyRow& a, const StudyRow& b) { return a.sources < b.sources; });
  std::string text = "The best distance for each number of charges:";
  for (std::size_t i = 0; i < best.size(); ++i)
    text += fmt::format("{} {:.4g} for {} ({:.2g} spacings)", i ? "," : "", best[i].at,
                        best[i].sources, best[i].at / spacingOf(study, best[i]));
  return text + ".";
}

std::string pointsAdvice(const Study& study) {
  const Rows rows = studySeries(study, StudyAxis::collocation, ChargePlacement::offset);
  if (rows.size() < 2) return {};
  const double least = rows[leastOf(rows, &StudyRow::rms)].rms;
  for (const StudyRow& row : rows)
    if (row.rms <= 1.1 * least)
      return fmt::format(
          "Boundary points a charge: {:.3g} are enough; more lower the error by at most a tenth.",
          row.collocation);
  return {};
}

std::string misleadingAdvice(const Rows& rows) {
  std::size_t count = 0;
  const StudyRow* worst = nullptr;
  for (const StudyRow& row : rows) {
    const double ratio = row.rms / row.collocationRms;
    if (!(ratio > kMisleads)) continue;
    ++count;
    if (!worst || ratio > worst->rms / worst->collocationRms) worst = &row;
  }
  if (!worst)
    return "The C-Error can be trusted: in no run is the error between the collocation points more "
           "than twice the error at them.";
  return fmt::format(
      "The C-Error misleads in {} of {} runs: between the collocation points the error is more "
      "than twice the error at them, most with {}: {:.3g} times.",
      count, rows.size(), describeRun(*worst), worst->rms / worst->collocationRms);
}

// Whether a list ends where the best is, so that the best may lie beyond.
std::string edgesAdvice(const Study& study, const StudyRow& best) {
  double nearest = best.at, farthest = best.at;
  std::size_t most = 0;
  for (const StudyRow& row : study.rows) {
    most = std::max(most, row.sources);
    if (row.placement != best.placement) continue;
    nearest = std::min(nearest, row.at);
    farthest = std::max(farthest, row.at);
  }
  std::vector<std::string> beyond;
  if (best.sources == most) beyond.push_back("more charges");
  if (nearest < farthest && best.at <= nearest)
    beyond.push_back(best.placement == ChargePlacement::sphere ? "smaller spheres"
                                                               : "nearer charges");
  if (nearest < farthest && best.at >= farthest)
    beyond.push_back(best.placement == ChargePlacement::sphere ? "larger spheres"
                                                               : "farther charges");
  if (beyond.empty()) return {};
  return fmt::format("The best is at the end of the list; {} may be better still.",
                     fmt::join(beyond, " and "));
}

}  // namespace

std::vector<StudyRow> studySeries(const Study& study, StudyAxis axis, ChargePlacement placement) {
  const StudyRun& base = placement == ChargePlacement::sphere ? study.baseSphere : study.base;
  Rows rows;
  for (const StudyRow& row : study.rows) {
    if (row.placement != placement || !row.failure.empty()) continue;
    StudyRun wanted = base;
    if (axis == StudyAxis::sources) wanted.sources = row.sources;
    if (axis == StudyAxis::collocation) wanted.collocation = row.collocation;
    if (axis == StudyAxis::place) wanted.at = row.at;
    if (sameRun(row, wanted)) rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(), [&](const StudyRow& a, const StudyRow& b) {
    return valueOf(a, axis) < valueOf(b, axis);
  });
  return rows;
}

std::string verdictText(StatementVerdict verdict) {
  switch (verdict) {
    case StatementVerdict::holds:
      return "holds";
    case StatementVerdict::partly:
      return "in part";
    case StatementVerdict::fails:
      return "does not hold";
    default:
      return "not measured";
  }
}

StudyFindings studyFindings(const Study& study) {
  StudyFindings found;
  Rows good;
  for (const StudyRow& row : study.rows)
    if (row.failure.empty()) good.push_back(row);
  if (!good.empty()) {
    const StudyRow best = good[leastOf(good, &StudyRow::p99)];
    found.best = found.cheapest = best;
    for (const StudyRow& row : good)
      if (row.p99 <= kNearlyBest * best.p99 && row.seconds < found.cheapest->seconds)
        found.cheapest = row;
    found.advice.push_back(
        fmt::format("Smallest error: {}: {}.", describeRun(best), figuresOf(best)));
    if (!sameRun(best, *found.cheapest))
      found.advice.push_back(fmt::format("Cheapest within {} times that: {}: {}.", kNearlyBest,
                                         describeRun(*found.cheapest), figuresOf(*found.cheapest)));
    for (const std::string& text : {distancesAdvice(study, good), pointsAdvice(study),
                                    misleadingAdvice(good), edgesAdvice(study, best)})
      if (!text.empty()) found.advice.push_back(text);
  }
  found.statements = {
      closer(study, &StudyRow::cError, "C-Error"),
      closer(study, &StudyRow::rms, "error at fresh points"),
      tooNear(study),
      sphere(study),
      more(study, StudyAxis::sources, &StudyRow::rms, "More charges give a smaller error"),
      more(study, StudyAxis::collocation, &StudyRow::rms,
           "More boundary points a charge give a smaller error")};
  return found;
}

std::string describeRun(const StudyRun& run) {
  const std::string place = run.placement == ChargePlacement::sphere
                                ? fmt::format("on a sphere of {:.4g} half diagonals", run.at)
                                : fmt::format("at {:.4g}", run.at);
  return fmt::format("{} charges {}, {:.3g} points each", run.sources, place, run.collocation);
}

std::string optionsOf(const StudyRun& run, const StudySettings& settings) {
  std::string text = fmt::format(
      "--charges {} --collocation {} {} {} --solver dense --interpolation {} --seed {}",
      run.sources, collocationOf(run),
      run.placement == ChargePlacement::sphere ? "--radius-ratio" : "--distance", run.at,
      settings.interpolation == Interpolation::smooth ? "smooth" : "linear", settings.seed);
  if (settings.method == Regularization::truncatedSvd) text += " --method tsvd";
  if (settings.regularization)
    text += fmt::format(" --regularization {}", *settings.regularization);
  return text;
}

}  // namespace innermap
