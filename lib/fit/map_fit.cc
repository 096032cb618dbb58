#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "innermap/core/error.h"
#include "innermap/fit/fit_map.h"

namespace innermap {
namespace {

constexpr double kPointsPerSource = 4, kPointsPerManySources = 3;

}  // namespace

std::string wordOf(SolveMethod method) {
  constexpr const char* kWords[] = {"adaptive", "iterative", "tikhonov", "tsvd", "steps"};
  return kWords[static_cast<int>(method)];
}

std::string wordOf(MapPlacement placement) {
  constexpr const char* kWords[] = {"adaptive", "shell", "sphere", "steps"};
  return kWords[static_cast<int>(placement)];
}

SettingChoice regularizationChoice(Regularization* method) {
  return choiceOf<Regularization>(
      method, {{wordOf(SolveMethod::tikhonov), Regularization::tikhonov},
               {wordOf(SolveMethod::truncatedSvd), Regularization::truncatedSvd}});
}

Setting toleranceSetting(SettingValue tolerance) {
  return Setting("tolerance", "T", std::move(tolerance),
                 "add charges where the error is until 99% of the boundary lies within T")
      .in("fraction of the target's diagonal")
      .from(kSmallestTolerance, 1);
}

std::vector<Setting> describeProof(Prove* prove, double* cells, const std::string& more) {
  return {Setting("prove", "WHAT",
                  choiceOf<Prove>(
                      prove, {{"off", Prove::off}, {"core", Prove::core}, {"full", Prove::full}}),
                  "core: where nothing folds, on whole cells, and how far the boundary is off at "
                  "most; full: also that no two points go to one, which takes longer; off: only "
                  "points are checked"),
          Setting("proof_cells", "N", cells,
                  fmt::format("cells that {{prove}} looks at a charge before it leaves the rest "
                              "undecided; at least {:g} with full",
                              ProofSettings().cellsPerCharge) +
                      more)
              .from(1, 1e6)
              .rare()};
}

std::size_t shellCollocation(const ShellSettings& shell) {
  if (shell.collocation > 0) return shell.collocation;
  const double perSource =
      shell.sources > kMostDenseSources ? kPointsPerManySources : kPointsPerSource;
  return static_cast<std::size_t>(std::max(perSource * static_cast<double>(shell.sources), 16.0));
}

std::vector<Setting> describe(ShellSettings& s) {
  return {Setting("distance", "D", &s.distance,
                  "distance of such a shell's charges from the surface (O-Distance)")
              .in("fraction of the source's diagonal")
              .from(1e-4, 2)
              .otherwise("chosen by held-out error")
              .rare(),
          Setting("radius_ratio", "R", &s.radiusRatio,
                  "place the charges on a sphere instead of a shell; its radius as a multiple of "
                  "half the diagonal (R-Ratio)")
              .above(1, 100)
              .rare(),
          Setting("solver", "NAME",
                  choiceOf<FitSolver>(&s.solver, {{"auto", FitSolver::automatic},
                                                  {"dense", FitSolver::dense},
                                                  {"iterative", FitSolver::iterative}}),
                  "solver for such a shell. dense: all charges at once, for up to some 3000; "
                  "iterative: for more; auto: by their number")
              .rare(),
          Setting("method", "NAME", regularizationChoice(&s.method),
                  "regularisation: Tikhonov's, or truncation of singular values (the paper's)")
              .rare(),
          Setting("regularization", "T", &s.regularization,
                  "threshold of singular values, or Tikhonov's lambda")
              .in("fraction of the largest singular value")
              .from(0, 1)
              .otherwise("chosen by held-out error")
              .rare()};
}

Setting maxSourcesSetting(std::size_t* most) {
  return Setting("max_charges", "N", most, "most charges that {tolerance} may use")
      .from(1000, kMaxCharges)
      .was("max_sources")
      .rare();
}

std::vector<Setting> describe(FitMapSettings& s) {
  std::vector<Setting> out{
      maxSourcesSetting(&s.maxSources),
      Setting("interpolation", "NAME",
              choiceOf<Interpolation>(&s.interpolation, {{"auto", Interpolation::automatic},
                                                         {"linear", Interpolation::linear},
                                                         {"smooth", Interpolation::smooth}}),
              "shape of the target between its vertices. linear: flat triangles; smooth: a smooth "
              "deformation that the vertices sample; auto: the one with the smaller error at "
              "held-out vertices")
          .rare(),
      Setting("one_to_one", "WHEN",
              choiceOf<OneToOne>(
                  &s.oneToOne,
                  {{"auto", OneToOne::automatic}, {"on", OneToOne::on}, {"off", OneToOne::off}}),
              fmt::format(
                  "go in steps through intermediate shapes if one harmonic map folds. auto: if it "
                  "folds over {:g}% of the inside or takes over {:g}% of it out of the target; on: "
                  "until nothing that is checked or proven folds; off: one harmonic map",
                  100 * kManyFolds, 100 * kManyOutside)),
      Setting("max_steps", "N", &s.maxSteps, "most steps").from(1, 256).rare()};
  for (Setting& setting : describeProof(&s.prove, &s.proofCells, " or {one_to_one} on"))
    out.push_back(std::move(setting));
  out.push_back(seedSetting(&s.seed));
  return out;
}

void requireInRange(const FitMapSettings& settings) {
  requireDescribed(settings);
  if (settings.shell && settings.oneToOne == OneToOne::on)
    throw SettingError("one_to_one",
                       "steps are fitted to a tolerance; leave out the number of charges");
  if (!settings.shell) {
    double tolerance = settings.tolerance;
    requireInRange({toleranceSetting(&tolerance)});
    return;
  }
  const ShellSettings& shell = *settings.shell;
  requireDescribed(shell);
  if (shell.distance && shell.radiusRatio)
    throw SettingError("distance", "excludes radius_ratio; give one of them");
  if (shell.collocation > 0 && shell.collocation < shell.sources + 4)
    throw SettingError("collocation",
                       fmt::format("must be at least {} for {} charges, not {}", shell.sources + 4,
                                   shell.sources, shell.collocation));
}

}  // namespace innermap
