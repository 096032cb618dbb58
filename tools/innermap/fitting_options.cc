#include "fitting_options.h"

#include <fmt/format.h>

#include <cmath>

#include "innermap/core/memory.h"
#include "job_cost.h"

namespace innermap::tool {
namespace {

// As --charges and --collocation: a multiple of the source's vertices.
std::optional<std::size_t> countOf(std::optional<double> ratio, std::size_t vertices,
                                   const char* option, const NumberRange& range) {
  if (!ratio) return {};
  const double count = std::round(*ratio * static_cast<double>(vertices));
  if (!range.holds(count))
    throw SettingError(
        option, fmt::format("gives {:.6g} points; {}", count, range.refusal("that", "points")));
  return static_cast<std::size_t>(count);
}

void requireOne(bool first, const std::string& a, bool second, const std::string& b) {
  if (first && second)
    throw UsageError(fmt::format("{} and {} exclude each other; give one of them", a, b));
}

}  // namespace

void addFittingOptions(Command& command, FittingOptions& o) {
  command.group("fit of the map");
  command.settings(describe(static_cast<FitChoices&>(o)));
  command.flag(
      "--best-effort", &o.bestEffort,
      "end with exit code 0 even if the tolerance is not met; the files are written either way");
  command
      .option("--charge-ratio", "R", &o.sourceRatio,
              "charges as a multiple of the source's vertices (sRatio), in place of --charges")
      .above(0)
      .atMost(100)
      .advanced()
      .was("--source-ratio");
  command
      .option("--collocation-ratio", "R", &o.collocationRatio,
              "boundary points as a multiple of the source's vertices (cRatio), in place of "
              "--collocation")
      .above(0)
      .atMost(1000)
      .advanced();
}

FitMapSettings fitMapSettings(const FittingOptions& options, std::size_t vertices, bool laidOn) {
  checkFittingOptions(options);
  FitChoices choices = options;
  if (!choices.sources)
    choices.sources = countOf(options.sourceRatio, vertices, "--charge-ratio", {1, kMaxCharges});
  if (!choices.collocation)
    choices.collocation =
        countOf(options.collocationRatio, vertices, "--collocation-ratio", {8, 1e7});
  return choices.settings(laidOn);
}

void checkFittingOptions(const FittingOptions& o) {
  const auto given = [](const auto& value) { return value.has_value(); };
  requireOne(given(o.sources), "--charges", given(o.sourceRatio), "--charge-ratio");
  requireOne(given(o.collocation), "--collocation", given(o.collocationRatio),
             "--collocation-ratio");
  requireOne(given(o.tolerance), "--tolerance", given(o.sourceRatio), "--charge-ratio");
  requireOne(given(o.tolerance), "--tolerance", given(o.collocationRatio), "--collocation-ratio");
  requireOne(given(o.tolerance), "--tolerance", !o.placedBy().empty(), optionName(o.placedBy()));
  FitChoices others = o;
  others.collocation.reset();  // is to fit the charges, which a mesh may tell
  others.settings(false);
}

std::string fittingPlan(const FitMapSettings& settings) {
  if (!settings.shell)
    return fmt::format("fit up to {} charges until 99% of the boundary lies within {:g}",
                       settings.maxSources, settings.tolerance);
  return fmt::format("fit {} charges to {} boundary points", settings.shell->sources,
                     shellCollocation(*settings.shell));
}

namespace {

// The more charges, the more rounds until they do.
constexpr double kRoundsPower = 1.4;
// Thousands, of so many thousand places: within a factor of two of gecko, homer, spot and a horse
// at tolerances from 1e-3 to 5e-5.
double likelyCharges(double places) { return 0.7 + 0.8 * places; }

// In thousands of charges. With --one-to-one on proofs come in between, when a fit is to go on.
std::vector<JobPhase> proofPhases(const FitMapSettings& settings, double charges) {
  if (settings.prove == Prove::off || settings.oneToOne == OneToOne::on) return {};
  JobSize size;
  size.charges = charges;
  std::vector<JobPhase> phases{stageOf("proving that nothing folds", size),
                               stageOf("bounding the error", size)};
  if (settings.prove == Prove::full) phases.push_back(stageOf("proving one-to-one", size));
  return phases;
}

std::vector<JobPhase> chargePhases(const FitMapSettings& settings, double places, bool laidOn) {
  JobSize size;
  if (settings.shell) {
    constexpr std::size_t kDense = 3000;
    size.charges = static_cast<double>(settings.shell->sources) / 1000;
    return {stageOf(
        settings.shell->sources <= kDense ? "fitting: a dense shell" : "fitting: a shell", size)};
  }
  size.items = std::pow(places, kRoundsPower);
  std::vector<JobPhase> phases = {stageOf("fitting", size),
                                  stageOf("meeting the tolerance", size, 1, "fitting")};
  if (settings.oneToOne == OneToOne::off) return phases;
  phases.push_back(stageOf("going in steps", size));
  phases.back().perhaps = !laidOn;
  phases.push_back(stageOf("going by smoothed shapes", size));
  phases.back().perhaps = true;
  return phases;
}

}  // namespace

std::vector<JobPhase> fittingPhases(const FitMapSettings& settings, double places, bool laidOn) {
  std::vector<JobPhase> phases = chargePhases(settings, places, laidOn);
  const double charges =
      settings.shell ? static_cast<double>(settings.shell->sources) / 1000 : likelyCharges(places);
  for (JobPhase& phase : proofPhases(settings, charges)) phases.push_back(std::move(phase));
  return phases;
}

}  // namespace innermap::tool
