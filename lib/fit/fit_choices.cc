#include <fmt/format.h>

#include <utility>

#include "innermap/core/error.h"
#include "innermap/fit/fit_map.h"

namespace innermap {

std::string FitChoices::placedBy() const {
  const std::pair<bool, const char*> all[] = {{sources.has_value(), "charges"},
                                              {collocation.has_value(), "collocation"},
                                              {shell.distance.has_value(), "distance"},
                                              {shell.radiusRatio.has_value(), "radius_ratio"},
                                              {shell.solver != FitSolver::automatic, "solver"},
                                              {shell.method != Regularization::tikhonov, "method"},
                                              {shell.regularization.has_value(), "regularization"}};
  for (const auto& [given, name] : all)
    if (given) return name;
  return "";
}

FitMapSettings FitChoices::settings(bool laidOn) const {
  FitMapSettings out = fit;
  if (const std::string name = placedBy(); !name.empty()) {
    if (tolerance)
      throw SettingError("tolerance", fmt::format("excludes {}; give one of them", name));
    out.shell = shell;
    out.shell->sources = sources.value_or(shell.sources);
    out.shell->collocation = collocation.value_or(0);
  }
  out.tolerance = tolerance.value_or(laidOn ? kLaidOnTolerance : fit.tolerance);
  requireInRange(out);
  return out;
}

std::vector<Setting> describe(FitChoices& c) {
  Setting tolerance =
      toleranceSetting(&c.tolerance)
          .otherwise(fmt::format("{:g}; {:g} if one mesh is first laid onto the other",
                                 c.fit.tolerance, kLaidOnTolerance));
  tolerance.help += "; not together with options that set a number of charges";
  std::vector<Setting> out{
      std::move(tolerance),
      Setting("charges", "N", &c.sources,
              "place this many charges on one shell, in place of {tolerance}")
          .from(1, kMaxCharges)
          .was("sources")
          .otherwise(fmt::format("{} if another option asks for such a shell", c.shell.sources)),
      Setting("collocation", "N", &c.collocation,
              "fit such a shell to this many boundary points, at least 4 more than charges")
          .from(8, 1e7)
          .otherwise("4 a charge; 3 a charge above 3000")
          .rare()};
  for (Setting& s : describe(c.fit)) out.push_back(std::move(s));
  for (Setting& s : describe(c.shell)) out.push_back(std::move(s));
  return out;
}

}  // namespace innermap
